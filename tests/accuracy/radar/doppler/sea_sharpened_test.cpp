// The sea behind a beam sharpened by Doppler: its spectrum is wider than a cell, and its mean beside that of
// the ground. Against sums over the pulses of a train and over the beam.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <vector>

#include "server/radar/doppler/sea_motion.h"
#include "server/radar/doppler/spread_response.h"
#include "server/radar/simd/kernels.h"
#include "tests/support/doppler_scenes.h"
#include "tests/support/same_bits.h"

namespace obliq::test::sea_sharpened_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWavelength_m = 0.299792458 / 9.4;
constexpr double kFlight_m_s = 150, kPsi_deg = 60;
constexpr int kMiddle = 200;

double hamming(int n, int of) { return 0.54 + 0.46 * std::cos(2 * kPi * ((n + 0.5) / of - 0.5)); }

/// What a train makes of a Gaussian spectrum u cells beside its filter, of one frequency's power in it: sum
/// over pulses of w w rho exp(j phase).
double passed(double u, double deviation_cells, int pulses) {
  double sum = 0, weights = 0;
  for (int n = 0; n < pulses; ++n) weights += hamming(n, pulses);
  for (int n = 0; n < pulses; ++n)
    for (int m = 0; m < pulses; ++m) {
      const double lag = static_cast<double>(n - m) / pulses;
      sum += hamming(n, pulses) * hamming(m, pulses) *
             std::exp(-2 * std::pow(kPi * deviation_cells * lag, 2)) * std::cos(2 * kPi * u * lag);
    }
  return sum / (weights * weights);
}

/// Level sea around 6 km from 1,000 m, looked at 60 degrees off the flight.
class SeaSharpened : public testing::Test {
 protected:
  SeaSharpened() {
    scene_.pose().settings.bearing_deg = 0;
    fly(scene_, kFlight_m_s, kPsi_deg);
    settings_ = doppler_radar(RadarMode::dbs, 400);
    settings_.pulse.prf_hz = 1000;
    settings_.doppler.pulses = 64;
    settings_.sea.state = 3;
    settings_.sea.shape = 0;
  }
  static double sum(const Frame& frame, int azimuth) { return azimuth_power(frame.bins, azimuth); }
  Frame map() const {
    RadarSettings s = settings_;
    s.mode = RadarMode::map;
    return scene_.bare(s);
  }
  double train_s() const { return settings_.doppler.pulses / settings_.pulse.prf_hz; }
  double deviation_cells() const {
    return 2 * SeaMotion(settings_).deviation_m_s / kWavelength_m * train_s();
  }
  /// Of the power that the real beam has in its middle: over its azimuths, in Doppler beside its own.
  double wanted() const {
    const double cos_e = std::sqrt(1 - 1.0 / 36), psi = kPsi_deg * kPi / 180;
    const double wind = settings_.atmosphere.wind_from_deg * kPi / 180;
    const double downwind_m_s = SeaMotion(settings_).downwind_m_s;
    double shown = 0, all = 0;
    for (double off = -0.07; off <= 0.07; off += 2e-4) {
      // One way gain is two-way voltage: half of it 1.5 degrees off.
      const double gain = std::exp(-4 * std::numbers::ln2 * std::pow(off * cos_e / (3 * kPi / 180), 2));
      // Azimuths go round to the right, the flight lies to the left; the sea closes in from upwind.
      const double closing =
          kFlight_m_s * (std::cos(psi + off) - std::cos(psi)) + downwind_m_s * std::cos(wind - off);
      const double cells = 2 * closing * cos_e / kWavelength_m * train_s();
      shown += gain * gain * passed(cells, deviation_cells(), settings_.doppler.pulses);
      all += gain * gain;
    }
    return shown / all;
  }

  TargetScene scene_{level_world(), kAntenna_m, sea_materials()};
  RadarSettings settings_;
};

TEST_F(SeaSharpened, HasThePowerOfItsSpectrum) {
  for (const double state : {0.1, 1.0, 3.0, 6.0})
    for (const double wind_m_s : {0.0, 12.0})
      for (const double from_deg : {0.0, 180.0}) {
        if (wind_m_s == 0 && from_deg > 0) continue;
        settings_.sea.state = state;
        settings_.atmosphere.wind_m_s = wind_m_s;
        settings_.atmosphere.wind_from_deg = from_deg;
        const double found = db(sum(scene_.bare(settings_), kMiddle) / sum(map(), kMiddle));
        std::printf("    state %.1f, wind %.0f from %.0f, %.2f cells: %.3f, wanted %.3f dB\n", state,
                    wind_m_s, from_deg, deviation_cells(), found, db(wanted()));
        EXPECT_NEAR(found, db(wanted()), 0.02);
      }
}

// A train of few pulses sees all of the sea in few cells, which repeat.
TEST_F(SeaSharpened, HasItWhereTheSpectrumIsAsWideAsThePrf) {
  settings_.doppler.pulses = 4;
  settings_.pulse.prf_hz = 150;
  settings_.sea.state = 6;
  EXPECT_NEAR(db(sum(scene_.bare(settings_), kMiddle) / sum(map(), kMiddle)), db(wanted()), 0.02);
}

TEST_F(SeaSharpened, HasSpeckleOfTheFiltersGrain) {
  for (const double state : {0.1, 3.0, 6.0}) {
    settings_.sea.state = state;
    const Frame frame = scene_.bare(settings_);
    const int n = frame.bins.n_range;
    double mean = 0, square = 0, bins = 0;
    const double cell_bins =
        kWavelength_m /
        (2 * kFlight_m_s * train_s() * std::sin(kPsi_deg * kPi / 180) * std::sqrt(1 - 1.0 / 36)) /
        (40.0 / 400 * kPi / 180);
    const auto away = static_cast<int>(std::lround(1.5 * cell_bins));
    std::complex<double> like = 0;
    const auto voltage = [&](int a, int m) {
      const auto k = static_cast<std::size_t>(a * n + m);
      return std::complex<double>(frame.bins.iq[k]) / std::sqrt(frame.bins.power_w[k]);
    };
    for (int a = 40; a + away < 360; ++a)
      for (int m = 0; m < n; ++m, ++bins) {
        mean += std::norm(voltage(a, m));
        square += std::norm(voltage(a, m)) * std::norm(voltage(a, m));
        like += voltage(a + away, m) * std::conj(voltage(a, m));
      }
    // Of a train of white noise under these weights.
    const double u = away / cell_bins;
    double alike = 0, weights = 0;
    for (int p = 0; p < 64; ++p) {
      const double w2 = std::pow(hamming(p, 64), 2);
      alike += w2 * std::cos(2 * kPi * u * ((p + 0.5) / 64 - 0.5));
      weights += w2;
    }
    std::printf("    state %.1f: mean %.3f, contrast %.3f; %.2f cells away alike %.3f, the filter's %.3f\n",
                state, mean / bins, square * bins / (mean * mean), u, std::abs(like) / mean, alike / weights);
    EXPECT_NEAR(mean / bins, 1, 0.03);
    EXPECT_NEAR(square * bins / (mean * mean), 2, 0.12);
    // The beam and the sector's width come in; voltages that kept their phase would be alike to 0.9 and more.
    EXPECT_NEAR(std::abs(like) / mean, alike / weights, 0.08);
  }
}

TEST(SpreadResponse, IsThatOfOneFrequencyWithoutSpread) {
  RadarSettings s;
  s.mode = RadarMode::dbs;
  for (const int pulses : {2, 16, 63}) {
    s.doppler.pulses = pulses;
    const DopplerResponse one(s);
    const SpreadResponse none(s.doppler, 0, 30), some(s.doppler, 1.7, 30);
    for (double u = -2.0 * pulses; u < 2.0 * pulses; u += 0.37) {
      const double in_phase = none.in_phase().at(u), ahead = none.ahead().at(u);
      EXPECT_NEAR(in_phase * in_phase + ahead * ahead, one.at(u) * one.at(u), 2e-3) << pulses << ' ' << u;
      const double power = std::pow(some.in_phase().at(u), 2) + std::pow(some.ahead().at(u), 2);
      EXPECT_NEAR(power, passed(u, 1.7, pulses), 2e-3) << pulses << ' ' << u;
    }
  }
}

TEST_F(SeaSharpened, LeavesTheLandBesideItAsItIs) {
  std::vector<Material> materials = sea_materials();
  materials[1].model = ScatteringModel::constant_gamma;
  TargetScene coast(shore(0), kAntenna_m, materials);
  coast.pose().settings.bearing_deg = 0;
  fly(coast, kFlight_m_s, kPsi_deg);
  RadarSettings still = settings_;
  still.sea.state = 0;
  const Frame moving = coast.bare(settings_), dark = coast.bare(still);
  // Sixteen degrees beside the shore, beyond the beam's skirts.
  for (int a = 300; a < 400; ++a) EXPECT_NEAR(sum(moving, a) / sum(dark, a), 1, 1e-6) << a;
  RenderOptions options;
  options.labels = true;
  const BinBlock labels =
      render(coast.shared(), snapshot(settings_), coast.pose(), {0, settings_.azimuth_bins}, options).bins;
  EXPECT_EQ(labels.labels.material[static_cast<std::size_t>(40 * labels.n_range + 30)], 0);
  EXPECT_EQ(labels.labels.material[static_cast<std::size_t>(360 * labels.n_range + 30)], 1);
}

// Sea and land in each bin: two scatterers.
TEST_F(SeaSharpened, AddsUpWithLandByPower) {
  World world = level_world();
  const int nx = world.grid.nx - 1, nz = world.grid.nz - 1;
  for (int j = 0; j < nz; ++j)
    for (int i = 0; i < nx; ++i) world.surface_material.push_back(static_cast<std::uint8_t>((i + j) % 2));
  std::vector<Material> materials = sea_materials();
  materials[1].model = ScatteringModel::constant_gamma;
  settings_.range_bins = 12;
  settings_.sea.state = 0.1;
  // As bright as the sea.
  materials[1].gamma = 1e-5;
  const auto sums = [&](const RadarSettings& s, bool with_land) {
    std::vector<Material> of = materials;
    if (!with_land) of[1].gamma = 0;
    TargetScene coast(World(world), kAntenna_m, of);
    coast.pose().settings.bearing_deg = 0;
    fly(coast, kFlight_m_s, kPsi_deg);
    coast.pose().settings.roll_deg = 10;  // of an antenna that is not stabilised
    const Frame frame = coast.bare(s);
    double iq = 0, power = 0;
    for (std::size_t k = 0; k < frame.bins.iq.size(); ++k) {
      iq += std::norm(std::complex<double>(frame.bins.iq[k]));
      power += frame.bins.power_w[k];
    }
    return std::pair(iq / power, power);
  };
  const double sea_w = sums(settings_, false).second;
  materials[1].gamma *= sea_w / (sums(settings_, true).second - sea_w);
  for (const RadarMode mode : {RadarMode::dbs, RadarMode::mti})
    for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::independent}) {
      settings_.mode = mode;
      settings_.speckle = speckle;
      settings_.beam.stabilised = mode == RadarMode::mti || speckle == SpeckleKind::independent;
      double found = 0;
      for (settings_.speckle_seed = 1; settings_.speckle_seed <= 20; ++settings_.speckle_seed)
        found += sums(settings_, true).first / 20;
      std::printf("    |V|^2 over P %.3f\n", found);
      // Behind the canceller few bins have most of the power; rows of an antenna that leans share echoes, of
      // which the filter takes some apart.
      EXPECT_NEAR(found, 1, settings_.beam.stabilised && mode == RadarMode::dbs ? 0.05 : 0.15);
    }
}

// Lakes above and below the datum, of which the filter leaves a part.
TEST_F(SeaSharpened, HasTheHeightOfItsWater) {
  for (const double height_m : {400.0, -400.0}) {
    TargetScene lake(made_world(9000, 70, [&](double, double) { return height_m; }), 1000, sea_materials());
    lake.pose().settings.bearing_deg = 0;
    RenderOptions options;
    options.labels = true;
    for (const RadarMode mode : {RadarMode::map, RadarMode::dbs, RadarMode::mti}) {
      settings_.mode = mode;
      const BinBlock bins =
          render(lake.shared(), snapshot(settings_), lake.pose(), {0, settings_.azimuth_bins}, options).bins;
      for (int a = 20; a < 380; a += 20)
        EXPECT_NEAR(bins.labels.height_m[static_cast<std::size_t>(a * bins.n_range + 30)], height_m, 1) << a;
    }
  }
}

// The grain beside the flight, and straight ahead.
TEST_F(SeaSharpened, KeepsItsGrainInASectorAlongTheTrack) {
  fly(scene_, kFlight_m_s, 0);
  const Frame frame = scene_.bare(settings_);
  // 18 degrees off the track cells are 0.37 degrees wide.
  const int away = 6, n = frame.bins.n_range;
  std::complex<double> like = 0;
  double mean = 0;
  for (int a = 4; a < 44; ++a)
    for (int m = 0; m < n; ++m) {
      const auto voltage = [&](int azimuth) {
        const auto k = static_cast<std::size_t>(azimuth * n + m);
        return std::complex<double>(frame.bins.iq[k]) / std::sqrt(frame.bins.power_w[k]);
      };
      like += voltage(a + away) * std::conj(voltage(a));
      mean += std::norm(voltage(a));
    }
  std::printf("    alike %.3f\n", std::abs(like) / mean);
  EXPECT_LT(std::abs(like) / mean, 0.5);
}

TEST_F(SeaSharpened, HasTheSameBitsOnAnyNumberOfThreadsInAnyPartsAndWithAnyInstructionSet) {
  settings_.sea.shape = 1;
  settings_.atmosphere.wind_m_s = 8;
  const Frame one = same_frame_in_any_parts(scene_, settings_);
  for (const Kernels& kernels : all_kernels()) {
    use_kernels(kernels);
    const Frame other = scene_.bare(settings_);
    EXPECT_TRUE(same_bits(one.bins.power_w, other.bins.power_w)) << kernels.name;
    EXPECT_TRUE(same_bits(one.bins.iq, other.bins.iq)) << kernels.name;
  }
  use_kernels(all_kernels().back());
}

}  // namespace
}  // namespace obliq::test::sea_sharpened_test
