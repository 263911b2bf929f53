// Modes that look at Doppler over level ground and of single targets, against closed forms (Skolnik 2008,
// chapter 2; the numbers were worked out by sums of their own).
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>
#include <numbers>
#include <vector>

#include "server/radar/doppler/canceller.h"
#include "server/radar/doppler/doppler_response.h"
#include "tests/support/doppler_scenes.h"
#include "tests/support/same_bits.h"

namespace obliq::test::doppler_test {
namespace {

RadarSettings radar(RadarMode mode) {
  RadarSettings s = doppler_radar(mode, 400);
  s.power_w = 1000;
  s.gain_db = 30;
  return s;
}

class OverLevelGround : public testing::Test {
 protected:
  OverLevelGround() { scene_.pose().settings.bearing_deg = 0; }

  void fly(double v_m_s, double psi_deg, double up_m_s = 0) { test::fly(scene_, v_m_s, psi_deg, up_m_s); }
  /// Mean power of the middle azimuth over those of the map.
  double over_map(const RadarSettings& s, int azimuth = 200) const {
    RadarSettings map = s;
    map.mode = RadarMode::map;
    return sum(scene_.bare(s), azimuth) / sum(scene_.bare(map), azimuth);
  }
  static double sum(const Frame& frame, int azimuth) { return azimuth_power(frame.bins, azimuth); }

  TargetScene scene_{level_world()};
};

TEST_F(OverLevelGround, MtiOfAStillAntennaLeavesNothing) {
  for (const int delays : {1, 2, 3}) {
    RadarSettings s = radar(RadarMode::mti);
    s.doppler.canceller = delays;
    for (const bool lock : {false, true}) {
      s.doppler.clutter_lock = lock;
      const Frame frame = scene_.bare(s);
      for (const double power_w : frame.bins.power_w) ASSERT_EQ(power_w, 0);
      for (const auto& iq : frame.bins.iq) ASSERT_EQ(std::abs(iq), 0);
    }
  }
}

TEST_F(OverLevelGround, MtiOfATurningAntennaImprovesAsTheBeamsPulsesSay) {
  const struct {
    double pulses, single_db, twice_db;
  } kWanted[] = {{10, 18.61, 34.25}, {20, 24.61, 46.22}, {40, 30.62, 58.24}, {83.3, 36.99, 70.98}};
  // On the ground the beam is 1 / cos e wider, at 6 km and 1 km up 0.12 dB of a single canceller; and it is
  // as wide as what it turns by in a bin.
  const double wider_db = -db(1 - std::pow(1000.0 / 6000, 2));
  for (const auto& wanted : kWanted)
    for (const int delays : {1, 2}) {
      RadarSettings s = radar(RadarMode::mti);
      s.scan_mode = ScanMode::sector;
      s.scan_rate_deg_s = 36;
      s.pulse.prf_hz = wanted.pulses * s.scan_rate_deg_s / s.beam.width_deg;
      s.doppler.canceller = delays;
      const double found = -db(over_map(s));
      EXPECT_NEAR(found - delays * wider_db, delays == 1 ? wanted.single_db : wanted.twice_db, 0.15);
      std::printf("    %.1f pulses, %d: %.2f dB\n", wanted.pulses, delays, found);
    }
}

TEST_F(OverLevelGround, MtiOfAFlyingAntennaImprovesAsItsClutterIsWide) {
  const struct {
    double psi_deg, prf_hz, single_db, twice_db;
  } kWanted[] = {{90, 2000, 9.90, 17.09}, {30, 2000, 15.75, 28.54}, {90, 5000, 17.67, 32.37}};
  for (const auto& wanted : kWanted)
    for (const int delays : {1, 2}) {
      fly(150, wanted.psi_deg);
      RadarSettings s = radar(RadarMode::mti);
      s.pulse.prf_hz = wanted.prf_hz;
      s.doppler.canceller = delays;
      s.doppler.clutter_lock = true;
      const double found = -db(over_map(s));
      EXPECT_NEAR(found, delays == 1 ? wanted.single_db : wanted.twice_db, 0.3);
      std::printf("    psi %.0f, PRF %.0f, %d: %.2f dB\n", wanted.psi_deg, wanted.prf_hz, delays, found);
    }
}

TEST_F(OverLevelGround, DbsHasThePowerOfItsCells) {
  const struct {
    double psi_deg, none_db, hamming_db;
  } kWanted[] = {{15, -8.112, -6.636}, {30, -10.858, -9.425}, {60, -13.192, -11.793}};
  for (const auto& wanted : kWanted)
    for (const DopplerWindow window : {DopplerWindow::none, DopplerWindow::hamming}) {
      fly(150, wanted.psi_deg);
      RadarSettings s = radar(RadarMode::dbs);
      s.pulse.prf_hz = 1000;
      s.doppler.pulses = 64;
      s.doppler.window = window;
      const double found = db(over_map(s));
      EXPECT_NEAR(found, window == DopplerWindow::none ? wanted.none_db : wanted.hamming_db, 0.1);
      std::printf("    psi %.0f, %s: %.3f dB\n", wanted.psi_deg,
                  window == DopplerWindow::none ? "none" : "hamming", found);
    }
}

// B + 3 rows a beamwidth stand for the ground between them.
TEST_F(OverLevelGround, DbsWithTheRowsOfItsRuleIsThatOfManyMore) {
  for (const double psi_deg : {90.0, 40.0}) {
    fly(150, psi_deg);
    RadarSettings s = radar(RadarMode::dbs);
    s.sector_deg = 20;
    s.doppler.pulses = 64;
    const double cells = 31.52 * std::sin(psi_deg * kDegree_rad);
    s.azimuth_bins = static_cast<int>(std::ceil(20 / 3.0 * (cells + 3)));
    RadarSettings fine = s;
    fine.azimuth_bins *= 5;
    const double rule = over_map(s, s.azimuth_bins / 2), many = over_map(fine, fine.azimuth_bins / 2);
    EXPECT_NEAR(rule / many, 1, 2e-3) << psi_deg;
    std::printf("    psi %.0f, %d rows and %d: %.5f\n", psi_deg, s.azimuth_bins, fine.azimuth_bins,
                rule / many);
  }
}

TEST_F(OverLevelGround, DbsWithoutVelocityIsTheRealBeam) {
  RadarSettings s = radar(RadarMode::dbs);
  RadarSettings map = s;
  map.mode = RadarMode::map;
  const Frame still = scene_.bare(s), real = scene_.bare(map);
  for (std::size_t k = 0; k < real.bins.power_w.size(); ++k) {
    ASSERT_NEAR(still.bins.power_w[k] / real.bins.power_w[k], 1, 1e-6);
    ASSERT_LE(std::abs(still.bins.iq[k] - real.bins.iq[k]), 2e-6F * std::sqrt(real.bins.power_w[k]) * 10);
  }
}

// Woods to the left of the middle, brighter rock to the right, in one beam. What is left is the woods'.
TEST_F(OverLevelGround, MtiLabelsWhatTheWindMoves) {
  for (const bool woods_first : {true, false}) {
    std::vector<Material> materials = two_materials();
    const std::size_t woods = woods_first ? 0 : 1;
    for (Material& material : materials) material.model = ScatteringModel::constant_gamma;
    materials[woods].wind = true;
    materials[woods].gamma = 0.05;
    materials[1 - woods].gamma = 0.1;
    TargetScene edge(shore(woods_first ? 0 : 1), kAntenna_m, materials);
    edge.pose().settings.bearing_deg = 0;
    for (const bool turns : {false, true}) {
      RadarSettings s = radar(RadarMode::mti);
      s.atmosphere.wind_m_s = 5;
      if (turns) s.scan_mode = ScanMode::sector;
      if (turns) s.scan_rate_deg_s = 0.01;
      RenderOptions options;
      options.labels = true;
      const auto label_of = [&](RadarMode mode) {
        s.mode = mode;
        const Frame frame = render(edge.shared(), snapshot(s), edge.pose(), {0, s.azimuth_bins}, options);
        return frame.bins.labels.material[static_cast<std::size_t>(200 * frame.bins.n_range + 30)];
      };
      EXPECT_EQ(label_of(RadarMode::map), 1 - woods);
      EXPECT_EQ(label_of(RadarMode::mti), woods) << turns;
    }
  }
}

TEST_F(OverLevelGround, MtiLeavesWhatMovesInTheWind) {
  const struct {
    double wind_m_s, frequency_ghz, single_db, twice_db;
  } kWanted[] = {{5, 9.4, 26.87, 45.29}, {10, 9.4, 23.79, 40.61}, {5, 3, 40.39, 68.68}};
  std::vector<Material> materials = two_materials();
  materials[0].wind = true;
  const TargetScene woods(level_world(), kAntenna_m, materials);
  // Nothing else is there: what moves is a share of all.
  materials[1].used = false;
  const TargetScene woods_alone(level_world(), kAntenna_m, materials);
  for (const auto& wanted : kWanted)
    for (const int delays : {1, 2}) {
      RadarSettings s = radar(RadarMode::mti);
      s.frequency_ghz = wanted.frequency_ghz;
      s.atmosphere.wind_m_s = wanted.wind_m_s;
      s.doppler.canceller = delays;
      RadarSettings map = s;
      map.mode = RadarMode::map;
      const Frame moving = woods.bare(s);
      const double found = db(sum(woods.bare(map), 200) / sum(moving, 200));
      EXPECT_NEAR(sum(woods_alone.bare(s), 200) / sum(moving, 200), 1, 1e-6);
      EXPECT_NEAR(found, delays == 1 ? wanted.single_db : wanted.twice_db, 0.05);
      // What is left in I&Q has the power that is left.
      double iq = 0, power = 0;
      for (std::size_t k = 0; k < moving.bins.iq.size(); ++k) {
        iq += std::norm(std::complex<double>(moving.bins.iq[k]));
        power += moving.bins.power_w[k];
      }
      EXPECT_NEAR(iq / power, 1, 0.1);
      std::printf("    %.0f m/s, %.1f GHz, %d: %.2f dB\n", wanted.wind_m_s, wanted.frequency_ghz, delays,
                  found);
      // With a notch that follows, of an antenna that stands: the same by the other sums.
      RadarSettings turning = s;
      turning.scan_mode = ScanMode::sector;
      turning.scan_rate_deg_s = 0.01;
      EXPECT_NEAR(db(sum(woods.bare(turning), 200) / sum(moving, 200)), 0, 0.05);
    }
}

TEST_F(OverLevelGround, ModesHaveTheSameBitsForAnyThreadsAndInAnyParts) {
  fly(120, 50, -3);
  for (const RadarMode mode : {RadarMode::mti, RadarMode::dbs})
    for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::independent})
      for (const bool lock : {false, true}) {
        RadarSettings s = radar(mode);
        s.speckle = speckle;
        s.doppler.clutter_lock = lock;
        s.pulse.kind = PulseKind::compressed;
        const auto render_with = [&](int threads, AzimuthRange azimuths) {
          RenderOptions options;
          options.threads = threads;
          options.draw = 7;
          return render(scene_.shared(), snapshot(s), scene_.pose(), azimuths, options);
        };
        const Frame whole = render_with(1, {0, s.azimuth_bins});
        expect_same_bits(whole.bins, render_with(2, {0, s.azimuth_bins}).bins);
        expect_same_bits(whole.bins, render_with(8, {0, s.azimuth_bins}).bins);
        const Frame part = render_with(2, {80, 24});
        BinBlock again = whole.bins;
        copy_azimuths(part.bins, again);
        expect_same_bits(whole.bins, again);  // a dwell's bits are those of the whole frame
        // What neighbours share of a draw is drawn once: they are not independent of each other.
        double power = 0, iq = 0;
        for (std::size_t k = 0; k < whole.bins.iq.size(); ++k) {
          iq += std::norm(std::complex<double>(whole.bins.iq[k]));
          power += whole.bins.power_w[k];
        }
        EXPECT_NEAR(iq / power, 1, 0.12);
      }
}

TEST_F(OverLevelGround, HardCasesAreFiniteAndTheSameAgain) {
  const struct {
    const char* name;
    double v_m_s, psi_deg, up_m_s;
    std::function<void(RadarSettings&)> change;
  } kCases[] = {
      {"standing", 0, 0, 0, [](RadarSettings&) {}},
      {"straight down", 0, 0, -300, [](RadarSettings&) {}},
      {"towards the middle", 150, 0, 0, [](RadarSettings&) {}},
      {"away from it", 150, 180, 0, [](RadarSettings&) {}},
      {"all round", 150, 45, 0, [](RadarSettings& s) { s.sector_deg = 360; }},
      {"all round, a wide beam", 150, 45, 0,
       [](RadarSettings& s) {
         s.sector_deg = 360;
         s.azimuth_bins = 400;
         s.doppler.pulses = 8;
         s.beam.width_deg = 90;
         s.beam.extent_deg = 180;
       }},
      {"PRF at half the ridge", 150, 90, 0, [](RadarSettings& s) { s.pulse.prf_hz = 246.262; }},
      {"PRF of 1 MHz", 150, 90, 0, [](RadarSettings& s) { s.pulse.prf_hz = 1e6; }},
      {"two pulses", 150, 90, 0, [](RadarSettings& s) { s.doppler.pulses = 2; }},
      {"20 km/s", 20e3, 90, 0, [](RadarSettings& s) { s.pulse.prf_hz = 1e6; }},
      {"from straight below on", 150, 60, 0, [](RadarSettings& s) { s.r_min_m = 0; }},
      {"Blackman and Harris", 150, 60, 0,
       [](RadarSettings& s) { s.doppler.window = DopplerWindow::blackman_harris; }},
      {"Taylor", 150, 60, 0, [](RadarSettings& s) { s.doppler.window = DopplerWindow::taylor; }},
      {"wind of a storm", 150, 60, 0, [](RadarSettings& s) { s.atmosphere.wind_m_s = 60; }},
  };
  for (const auto& hard : kCases)
    for (const RadarMode mode : {RadarMode::mti, RadarMode::dbs})
      for (const ScanMode scan : {ScanMode::frame, ScanMode::sector}) {
        fly(hard.v_m_s, hard.psi_deg, hard.up_m_s);
        RadarSettings s = radar(mode);
        s.scan_mode = scan;
        s.doppler.clutter_lock = true;
        s.doppler.canceller = 3;
        s.speckle = SpeckleKind::automatic;
        hard.change(s);
        const Frame frame = scene_.bare(s);
        for (std::size_t k = 0; k < frame.bins.iq.size(); ++k) {
          ASSERT_TRUE(std::isfinite(frame.bins.power_w[k]) && frame.bins.power_w[k] >= 0) << hard.name;
          ASSERT_TRUE(std::isfinite(std::norm(frame.bins.iq[k]))) << hard.name;
        }
        expect_same_bits(frame.bins, scene_.bare(s).bins);
      }
}

TEST_F(OverLevelGround, WithoutVelocityAModeIsThatOfAnAntennaThatStands) {
  // A pose without a velocity among others: no old one is kept.
  RadarSettings s = radar(RadarMode::dbs);
  const Frame still = scene_.bare(s);
  fly(150, 60);
  const Frame moving = scene_.bare(s);
  scene_.pose().settings.clear_velocity();
  expect_same_bits(still.bins, scene_.bare(s).bins);
  EXPECT_FALSE(same_bits(still.bins.power_w, moving.bins.power_w));
}

}  // namespace
}  // namespace obliq::test::doppler_test
