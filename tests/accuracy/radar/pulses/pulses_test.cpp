// Trains of pulses over ground, against closed forms (Skolnik 2008, chapter 2) and sums of their own.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <cstring>
#include <functional>
#include <numbers>
#include <vector>

#include "server/radar/beam/echo_rows.h"
#include "server/radar/receiver/receiver.h"
#include "tests/support/train_scenes.h"

namespace obliq::test::pulses_test {
namespace {

constexpr double kPi = std::numbers::pi;

World hills() {
  return made_world(13000, 50, [](double x, double z) {
    return 120 + 100 * std::sin(x / 900) * std::cos(z / 700) + 20 * std::sin(x / 230 + z / 310);
  });
}

/// Mean improvement of a canceller over a train's samples: noise gain times clutter attenuation.
double improvement_db(const std::vector<PulseTrain>& trains, int delays) {
  const double weights[3][3] = {{1, 0, 0}, {1, -1, 0}, {1, -2, 1}};
  const double noise_gain[3] = {1, 2, 6};
  double before = 0, after = 0;
  for (const PulseTrain& train : trains)
    for (int n = 0; n + delays < train.n_pulses; ++n)
      for (int m = 0; m < train.n_range; ++m) {
        std::complex<double> sum = 0;
        for (int k = 0; k <= delays; ++k) sum += weights[delays][k] * sample(train, n + k, m);
        before += std::norm(sample(train, n, m));
        after += std::norm(sum);
      }
  return db(noise_gain[delays] * before / after);
}

std::vector<PulseTrain> draws(const TargetScene& scene, RadarSettings s, int n, double rate_deg_s = 0) {
  s.speckle = SpeckleKind::independent;
  std::vector<PulseTrain> trains;
  for (int k = 0; k < n; ++k)
    trains.push_back(
        train_of(scene, s, {.rate_deg_s = rate_deg_s, .draw = static_cast<std::uint64_t>(k) + 1}));
  return trains;
}

TEST(Pulses, OfAStillAntennaAreTheMapsEcho) {
  const TargetScene scene(hills());
  RadarSettings s = train_settings();
  s.pulse.kind = PulseKind::compressed;
  s.doppler.pulses = 33;
  const PulseTrain train = train_of(scene, s);
  ASSERT_EQ(train.n_pulses, 33);
  ASSERT_EQ(train.n_range, 64);
  RadarSettings map = s;
  map.mode = RadarMode::map;
  // As many rows a beamwidth as a train has.
  const Frame frame = scene.bare(s);
  double power = 0, off = 0;
  for (int m = 0; m < train.n_range; ++m) {
    std::complex<double> sum = 0;
    for (int n = 0; n < train.n_pulses; ++n) {
      sum += sample(train, n, m);
      EXPECT_EQ(sample(train, n, m), sample(train, 0, m));
    }
    const std::complex<double> wanted(frame.bins.iq[static_cast<std::size_t>(52 * 64 + m)]);
    power += std::norm(wanted);
    off += std::norm(sum / 33.0 - wanted);
  }
  EXPECT_GT(power, 0);
  EXPECT_LT(off, 1e-10 * power);
}

TEST(Pulses, OfATurningBeamAreThoseOfStillOnesThatPointThere) {
  const TargetScene scene(hills());
  RadarSettings s = train_settings();
  s.doppler.pulses = 16;
  s.pulse.prf_hz = 240;
  const PulseTrain turning = train_of(scene, s, {.rate_deg_s = 24});
  // 0.2 degrees a bin, 0.1 a pulse: pulse 8.5 is in the middle of bin 52, pulse 10.5 in that of 53.
  for (const auto& [pulse, bin] : {std::pair(7, 52), std::pair(8, 52)}) {
    const PulseTrain still = train_of(scene, s, {.azimuths = {bin, 1}});
    double power = 0, off = 0;
    for (int m = 0; m < still.n_range; ++m) {
      power += std::norm(sample(still, 0, m));
      off += std::norm(sample(turning, pulse, m) - sample(still, 0, m));
    }
    // They are 0.05 degrees beside it.
    EXPECT_LT(off, 2e-3 * power);
    EXPECT_GT(off, 1e-6 * power);
  }
  EXPECT_NEAR(turning.boresight_start_deg, -7.5 * 0.1, 1e-9);
  EXPECT_EQ(turning.boresight_rate_deg_s, 24);
}

TEST(Pulses, BehindACancellerImproveAsTheBeamsTurnSays) {
  const TargetScene scene(level_world());
  const double wider_db = -db(1 - std::pow(1000.0 / 6000, 2));
  const struct {
    double pulses, single_db, twice_db;
  } kWanted[] = {{10, 18.61, 34.25}, {20, 24.61, 46.22}, {40, 30.62, 58.24}, {83.3, 36.99, 70.98}};
  for (const auto& wanted : kWanted) {
    RadarSettings s = train_settings();
    s.range_bins = 256;
    s.doppler.pulses = 16;
    s.pulse.prf_hz = wanted.pulses * 12;
    const auto trains = draws(scene, s, 40, 36);
    for (const int delays : {1, 2}) {
      const double found = improvement_db(trains, delays);
      EXPECT_NEAR(found - delays * wider_db, delays == 1 ? wanted.single_db : wanted.twice_db, 0.3);
      std::printf("    %.1f pulses, %d: %.2f dB\n", wanted.pulses, delays, found);
    }
  }
}

TEST(Pulses, OfAFlyingAntennaImproveAsItsClutterIsWide) {
  TargetScene scene(level_world());
  const struct {
    double psi_deg, prf_hz, single_db, twice_db;
  } kWanted[] = {{90, 2000, 9.90, 17.09}, {90, 5000, 17.67, 32.37}};
  for (const auto& wanted : kWanted) {
    fly(scene, 150, wanted.psi_deg);
    RadarSettings s = train_settings();
    s.doppler.pulses = 16;
    s.pulse.prf_hz = wanted.prf_hz;
    const auto trains = draws(scene, s, 40);
    for (const int delays : {1, 2}) {
      const double found = improvement_db(trains, delays);
      EXPECT_NEAR(found, delays == 1 ? wanted.single_db : wanted.twice_db, 0.3);
      std::printf("    psi %.0f, PRF %.0f, %d: %.2f dB\n", wanted.psi_deg, wanted.prf_hz, delays, found);
    }
  }
}

TEST(Pulses, MoveInTheWindAsBillingsleysLawSays) {
  std::vector<Material> materials = two_materials();
  materials[0].wind = true;
  const TargetScene woods(level_world(), kAntenna_m, materials);
  RadarSettings s = train_settings();
  s.doppler.pulses = 16;
  s.pulse.prf_hz = 1000;
  s.atmosphere.wind_m_s = 5;
  const auto trains = draws(woods, s, 60);
  const double single = improvement_db(trains, 1), twice = improvement_db(trains, 2);
  EXPECT_NEAR(single, 26.87, 0.3);
  EXPECT_NEAR(twice, 45.29, 0.3);
  // What is left is Gaussian: sums of rows.
  double contrast = 0;
  for (int m = 0; m < s.range_bins; ++m) {
    double second = 0, fourth = 0;
    for (const PulseTrain& train : trains)
      for (const int p : {1, 6, 11}) {
        const double left = std::norm(sample(train, p, m) - sample(train, p - 1, m));
        second += left;
        fourth += left * left;
      }
    const double n = 3.0 * static_cast<double>(trains.size());
    contrast += fourth / n / std::pow(second / n, 2) / s.range_bins;
  }
  EXPECT_NEAR(contrast, 2, 0.25);
  std::printf("    %.2f and %.2f dB, contrast %.2f\n", single, twice, contrast);
}

TEST(Pulses, HaveTheSpectrumOfTheirRows) {
  TargetScene scene(level_world());
  fly(scene, 150, 60);
  RadarSettings s = train_settings();
  s.doppler.pulses = 64;
  const auto trains = draws(scene, s, 60);
  // Level ground's Doppler cells without a window: sum over a fine ring of g^2 D^2, of its own.
  const double lambda = 299792458.0 / 9.4e9, cos_e = std::sqrt(1 - 1.0 / 36);
  const int n = 64;
  std::vector<double> wanted(static_cast<std::size_t>(n), 0.0), found(wanted);
  for (int k = -4000; k <= 4000; ++k) {
    const double az = k * 8.0 / 4000 * kDegree_rad;
    const double own = std::asin(std::sin(az) * cos_e);
    const double g = std::exp(-4 * std::log(2.0) * std::pow(own / (3 * kDegree_rad), 2));
    const double f = 2 * 150 / lambda * cos_e * std::cos(az + 60 * kDegree_rad);
    for (int cell = 0; cell < n; ++cell) {
      const double u = f / 1000 - cell / static_cast<double>(n);
      const double d = std::abs(std::sin(kPi * u)) < 1e-12 ? n : std::sin(kPi * u * n) / std::sin(kPi * u);
      wanted[static_cast<std::size_t>(cell)] += g * g * d * d;
    }
  }
  for (const PulseTrain& train : trains)
    for (int m = 24; m < 40; ++m)
      for (int cell = 0; cell < n; ++cell) {
        std::complex<double> sum = 0;
        for (int p = 0; p < n; ++p) sum += sample(train, p, m) * std::polar(1.0, -2 * kPi * p * cell / n);
        found[static_cast<std::size_t>(cell)] += std::norm(sum);
      }
  double all_wanted = 0, all_found = 0, strongest = 0;
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    all_wanted += wanted[c];
    all_found += found[c];
    strongest = std::max(strongest, wanted[c]);
  }
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    if (wanted[c] < 1e-3 * strongest) continue;
    EXPECT_NEAR(found[c] / all_found / (wanted[c] / all_wanted), 1, 0.2) << c;
  }
}

TEST(Pulses, OfNoiseAreWhite) {
  TargetScene scene(level_world());
  RadarSettings s = train_settings();
  s.power_w = 0;
  s.receiver.noise = true;
  s.range_bins = 1024;
  s.doppler.pulses = 32;
  const Receiver receiver(s, "one", 5);
  const PulseTrain train = train_of(scene, s, {.receiver = &receiver});
  double power = 0;
  std::complex<double> beside = 0, later = 0;
  for (int p = 0; p < 32; ++p)
    for (int m = 0; m < 1024; ++m) {
      power += std::norm(sample(train, p, m));
      if (p > 0) beside += sample(train, p, m) * std::conj(sample(train, p - 1, m));
      if (p > 6) later += sample(train, p, m) * std::conj(sample(train, p - 7, m));
    }
  const double n = 32 * 1024.0;
  EXPECT_NEAR(power / n / receiver.noise_power_w(), 1, 4 / std::sqrt(n));
  EXPECT_LT(std::abs(beside) / power, 4 / std::sqrt(n));
  EXPECT_LT(std::abs(later) / power, 4 / std::sqrt(n));
  EXPECT_TRUE(same_train(train, train_of(scene, s, {.receiver = &receiver})));
  const Receiver next(s, "one", 6);
  EXPECT_FALSE(same_train(train, train_of(scene, s, {.receiver = &next})));
}

TEST(Pulses, FoldGroundFromBeyondTheirInterval) {
  // Nothing but a strip of ground 14 to 15 km away, and a little under the antenna.
  World world = made_world(20000, 100, [](double x, double z) {
    const bool known = (z > 13500 && z < 15500) || std::hypot(x, z) < 400;
    return known ? 0.0 : std::numeric_limits<double>::quiet_NaN();
  });
  const TargetScene scene(std::move(world), kAntenna_m);
  RadarSettings s = train_settings();
  s.r_min_m = 1200;
  s.r_max_m = 5200;
  s.pulse.prf_hz = 12500;
  const PulseTrain folded = train_of(scene, s);
  s.pulse.prf_hz = 2000;
  const PulseTrain long_interval = train_of(scene, s);
  RadarSettings there = s;
  there.r_min_m += 11991.69832;
  there.r_max_m += 11991.69832;
  const PulseTrain direct = train_of(scene, there);
  double power = 0, off = 0;
  for (std::size_t k = 0; k < folded.iq.size(); ++k) {
    power += std::norm(std::complex<double>(folded.iq[k]));
    off += std::norm(std::complex<double>(folded.iq[k] - direct.iq[k]));
    EXPECT_EQ(long_interval.iq[k], std::complex<float>(0));
  }
  EXPECT_GT(power, 0);
  EXPECT_LT(off, 1e-6 * power);
}

TEST(Pulses, OfAStaggerAreThoseOfTheirTimes) {
  TargetScene scene(hills());
  fly(scene, 120, 50, -4);
  RadarSettings s = train_settings();
  s.doppler.pulses = 9;
  s.pulse.stagger = {1, 1.25, 0.5, 1.25};
  const PulseTrain staggered = train_of(scene, s);
  EXPECT_EQ(staggered.period_ns, (std::vector<double>{1e6, 1.25e6, 5e5, 1.25e6}));
  // Every quarter of a millisecond, about the same middle: 8 ms, 33 pulses.
  RadarSettings dense = s;
  dense.pulse.stagger.clear();
  dense.pulse.prf_hz = 4000;
  dense.doppler.pulses = 33;
  const PulseTrain all = train_of(scene, dense);
  const int at[] = {0, 4, 9, 11, 16, 20, 25, 27, 32};
  double power = 0, off = 0;
  for (int p = 0; p < 9; ++p)
    for (int m = 0; m < 64; ++m) {
      power += std::norm(sample(staggered, p, m));
      off += std::norm(sample(staggered, p, m) - sample(all, at[p], m));
    }
  EXPECT_LT(off, 1e-9 * power);
}

TEST(Pulses, HaveTheSameBitsForAnyThreadsAndBesideOtherDwells) {
  TargetScene scene(hills());
  fly(scene, 150, 80, 2);
  for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::independent}) {
    RadarSettings s = train_settings();
    s.speckle = speckle;
    s.pulse.kind = PulseKind::compressed;
    s.doppler.pulses = 20;
    s.receiver.noise = true;
    const Receiver receiver(s, "one", 3);
    const TrainChoice choice{
        .rate_deg_s = 30, .azimuths = {48, 8}, .draw = 4, .threads = 1, .receiver = &receiver};
    const PulseTrain one = train_of(scene, s, choice);
    for (const int threads : {2, 8}) {
      TrainChoice more = choice;
      more.threads = threads;
      EXPECT_TRUE(same_train(one, train_of(scene, s, more)));
    }
    SharpStore store;
    TrainChoice shared = choice;
    shared.sharp = &store;
    shared.azimuths = {40, 8};
    const PulseTrain before = train_of(scene, s, shared);
    EXPECT_GT(store.bytes(), 0u);
    shared.azimuths = choice.azimuths;
    EXPECT_TRUE(same_train(one, train_of(scene, s, shared)));
    EXPECT_FALSE(same_train(one, before));
  }
}

TEST(Pulses, OfHardCasesAreFiniteAndTheSameAgain) {
  const struct {
    const char* name;
    double v_m_s, psi_deg, up_m_s, rate_deg_s;
    std::function<void(RadarSettings&)> change;
  } kCases[] = {
      {"standing", 0, 0, 0, 0, [](RadarSettings&) {}},
      {"straight down", 0, 0, -300, 0, [](RadarSettings&) {}},
      {"towards the middle", 150, 0, 0, 0, [](RadarSettings&) {}},
      {"away from it", 150, 180, 0, 0, [](RadarSettings&) {}},
      {"all round", 150, 45, 0, 100, [](RadarSettings& s) { s.sector_deg = 360; }},
      {"PRF of 1 MHz", 150, 90, 0, 0, [](RadarSettings& s) { s.pulse.prf_hz = 1e6; }},
      {"PRF of 1 Hz", 5, 90, 0, 3,
       [](RadarSettings& s) {
         s.pulse.prf_hz = 1;
         s.doppler.pulses = 3;
       }},
      {"two pulses", 150, 90, 0, 0, [](RadarSettings& s) { s.doppler.pulses = 2; }},
      {"20 km/s", 20e3, 90, 0, 0, [](RadarSettings& s) { s.pulse.prf_hz = 1e6; }},
      {"from straight below on", 150, 60, 0, -40, [](RadarSettings& s) { s.r_min_m = 0; }},
      {"sixteen intervals, three pulses", 150, 60, 0, 0,
       [](RadarSettings& s) {
         s.pulse.stagger.assign(16, 1.5);
         s.doppler.pulses = 3;
       }},
      {"wind of a storm", 150, 60, 0, 0, [](RadarSettings& s) { s.atmosphere.wind_m_s = 60; }},
      {"rolling", 150, 60, 0, 10, [](RadarSettings& s) { s.beam.stabilised = false; }},
      {"through half a circle", 0, 0, 0, 18000,
       [](RadarSettings& s) {
         s.pulse.prf_hz = 1000;
         s.doppler.pulses = 20;
       }},
  };
  for (const auto& hard : kCases) {
    TargetScene scene(hills());
    fly(scene, hard.v_m_s, hard.psi_deg, hard.up_m_s);
    scene.pose().settings.roll_deg = 20;
    RadarSettings s = train_settings();
    s.receiver.noise = true;
    s.speckle = SpeckleKind::independent;
    hard.change(s);
    const Receiver receiver(s, "one", 3);
    const TrainChoice choice{
        .targets = {scene.at(100, 5900, 0)}, .rate_deg_s = hard.rate_deg_s, .receiver = &receiver};
    const PulseTrain train = train_of(scene, s, choice);
    for (const auto& iq : train.iq) ASSERT_TRUE(std::isfinite(std::norm(iq))) << hard.name;
    EXPECT_TRUE(same_train(train, train_of(scene, s, choice))) << hard.name;
  }
}

}  // namespace
}  // namespace obliq::test::pulses_test
