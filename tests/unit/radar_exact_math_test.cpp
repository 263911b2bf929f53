#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/simd/exact_math.h"

namespace obliq {
namespace {

constexpr long double kTwoPi = 2 * std::numbers::pi_v<long double>;

TEST(ExactMath, SineAndCosineOfTurnsAreWithin3e16) {
  for (int k = -200000; k <= 200000; ++k) {
    const double turns = k * 7.3e-6 + 1e-9;
    const SinCos got = sincos_turns(turns);
    EXPECT_NEAR(got.sin, static_cast<double>(std::sin(kTwoPi * static_cast<long double>(turns))), 3e-16)
        << turns;
    EXPECT_NEAR(got.cos, static_cast<double>(std::cos(kTwoPi * static_cast<long double>(turns))), 3e-16)
        << turns;
  }
}

TEST(ExactMath, QuarterTurnsAreExact) {
  EXPECT_EQ(sincos_turns(0.25).sin, 1.0);
  EXPECT_EQ(sincos_turns(0.25).cos, -0.0);
  EXPECT_EQ(sincos_turns(-0.5).cos, -1.0);
  EXPECT_EQ(sincos_turns(1e15).cos, 1.0);
}

TEST(ExactMath, ExponentialOfNegativesIsWithin4e16Relative) {
  for (double x = 0; x > -699; x -= 0.00371) {
    const auto expected = static_cast<double>(std::exp(static_cast<long double>(x)));
    EXPECT_NEAR(exp_of_negative(x) / expected, 1, 4.5e-16) << x;
  }
  EXPECT_EQ(exp_of_negative(-701), 0);
  EXPECT_EQ(exp_of_negative(-HUGE_VAL), 0);
  EXPECT_EQ(exp_of_negative(std::nan("")), 0);
}

TEST(ExactMath, LogarithmIsWithin1e15OfTheLongDoubleOne) {
  for (double x = 1e-9; x <= 1; x *= 1.00037) {
    const auto expected = static_cast<double>(std::log(static_cast<long double>(x)));
    EXPECT_NEAR(log_of_positive(x), expected, 1e-15 + 4e-16 * std::abs(expected)) << x;
  }
  EXPECT_EQ(log_of_positive(1.0), 0);
}

}  // namespace
}  // namespace obliq
