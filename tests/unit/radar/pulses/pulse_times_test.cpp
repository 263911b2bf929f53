// When pulses are sent, and which echoes come back in whose time.
#include "server/radar/pulses/pulse_times.h"

#include <gtest/gtest.h>

#include <numeric>

namespace obliq::test::pulse_times_test {
namespace {

constexpr double kHalfLight_m_s = 299792458.0 / 2;

RadarSettings settings(int pulses, double prf_hz, std::vector<double> stagger = {}) {
  RadarSettings s;
  s.mode = RadarMode::pulses;
  s.doppler.pulses = pulses;
  s.pulse.prf_hz = prf_hz;
  s.pulse.stagger = std::move(stagger);
  return s;
}

TEST(PulseTimes, LieAboutTheMiddleOfTheTrain) {
  const PulseTimes even(settings(5, 1000));
  for (int n = 0; n < 5; ++n) EXPECT_DOUBLE_EQ(even.at_s(n), (n - 2) * 1e-3);
  const PulseTimes staggered(settings(6, 1000, {1, 1.5}));
  EXPECT_DOUBLE_EQ(staggered.length_s(), (1 + 1.5 + 1 + 1.5 + 1) * 1e-3);
  EXPECT_DOUBLE_EQ(staggered.at_s(0), -staggered.at_s(5));
  for (int n = 0; n < 5; ++n)
    EXPECT_NEAR(staggered.at_s(n + 1) - staggered.at_s(n), n % 2 == 0 ? 1e-3 : 1.5e-3, 1e-15);
  EXPECT_EQ(staggered.n_like(0), 3);
  EXPECT_EQ(staggered.n_like(1), 3);
  EXPECT_EQ(PulseTimes(settings(7, 1000, {1, 1, 2})).n_like(0), 3);
  EXPECT_EQ(PulseTimes(settings(7, 1000, {1, 1, 2})).n_like(2), 2);
}

TEST(PulseTrips, FoldByTheIntervalsBeforeAPulse) {
  const PulseTimes even(settings(8, 12500));
  EXPECT_NEAR(range_of_delay_m(80e-6), 11991.69832, 1e-5);
  EXPECT_EQ(pulse_trips(even, 1000, 5000).size(), 1u);
  const auto trips = pulse_trips(even, 1000, 40000);
  ASSERT_EQ(trips.size(), 4u) << "at most so many";
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(trips[k].shift_m, static_cast<double>(k) * 11991.69832, 1e-4);
    EXPECT_EQ(trips[k].pulses, std::vector<int>{0});
  }
  EXPECT_EQ(pulse_trips(even, 1000, 12991).size(), 1u);
  EXPECT_EQ(pulse_trips(even, 1000, 12992).size(), 2u);

  // Before pulse 0 lies the pattern's last interval, before pulse 1 its first.
  const PulseTimes staggered(settings(8, 10000, {1, 1.5}));
  const auto of_two = pulse_trips(staggered, 1000, 30000);
  const double unit_m = kHalfLight_m_s * 1e-4;
  ASSERT_EQ(of_two.size(), 3u);
  EXPECT_EQ(of_two[0].pulses, (std::vector<int>{0, 1}));
  EXPECT_NEAR(of_two[1].shift_m, 1.5 * unit_m, 1e-6);
  EXPECT_EQ(of_two[1].pulses, std::vector<int>{0});
  EXPECT_NEAR(of_two[2].shift_m, unit_m, 1e-6);
  EXPECT_EQ(of_two[2].pulses, std::vector<int>{1});
}

TEST(PulseTrips, OfMoreIntervalsThanPulsesAreThoseOfThePulses) {
  const PulseTimes few(settings(2, 10000, {1, 1.25, 1.5, 0.5}));
  for (const PulseTrip& trip : pulse_trips(few, 100, 1e6))
    for (const int pulse : trip.pulses) EXPECT_LT(pulse, 2);
}

}  // namespace
}  // namespace obliq::test::pulse_times_test
