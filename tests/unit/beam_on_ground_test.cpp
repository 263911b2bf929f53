// A beam's width on ground at any elevation, against closed forms.
#include "server/radar/beam/beam_on_ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/beam/antenna_gain.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRad = kPi / 180;

RadarSettings gaussian(double width_deg, double extent_deg = 0) {
  RadarSettings s;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = width_deg;
  s.beam.extent_deg = extent_deg;
  return s;
}

/// Of a Gaussian beam narrow against what it sees: theta3 sqrt(pi / (8 ln 2)) / cos(e).
double narrow_rad(double width_deg, double cosine) {
  return width_deg * kRad * std::sqrt(kPi / (8 * std::numbers::ln2)) / cosine;
}

TEST(CosineSteps, AreTwoPercentApartAndTheNearestIsTaken) {
  EXPECT_EQ(cosine_steps::nearest(0), 0);
  EXPECT_EQ(cosine_steps::nearest(-1), cosine_steps::kCount - 1);
  EXPECT_NEAR(cosine_steps::cosine(cosine_steps::kCount - 1), 0.05, 0.0005);
  for (const double degrees : {0.5, 10.0, 30.0, 60.0, 80.0, 87.0}) {
    const double taken = cosine_steps::cosine(cosine_steps::nearest(-std::sin(degrees * kRad)));
    EXPECT_LE(std::abs(std::log(taken / std::cos(degrees * kRad))), 0.5 * std::log(1.02) * 1.001) << degrees;
  }
}

TEST(BeamOnGround, IsAsWideAsTheInverseOfTheCosineWhileItIsNarrow) {
  const AzimuthPattern pattern(gaussian(0.5, 3));
  const BeamOnGround beam(pattern, 0, 0.1 * kRad);
  for (const double cosine : {1.0, 0.7, 0.3}) {
    EXPECT_NEAR(beam.width_rad(cosine) / narrow_rad(0.5, cosine), 1, 1e-3) << cosine;
    EXPECT_NEAR(beam.gain(std::asin(std::sin(0.25 * kRad) / cosine), cosine), 0.5, 1e-12);
  }
}

TEST(BeamOnGround, HoldsHalfTheCircleStraightBelow) {
  const AzimuthPattern pattern(gaussian(3));
  const BeamOnGround beam(pattern, 0, 0.1 * kRad);
  EXPECT_NEAR(beam.width_rad(1e-6), kPi, 1e-6);
  EXPECT_EQ(beam.gain(170 * kRad, 0.01), 0) << "behind";
  EXPECT_NEAR(beam.extent_rad(0.01), kPi / 2, 1e-12);
}

TEST(BeamOnGround, OfATurningAntennaIsTheMeanOverTheTurn) {
  // Two Gaussians' widths add in squares, that of the turn's box is turn^2 / 12; g^2 of a mean is flatter.
  const AzimuthPattern pattern(gaussian(2, 12));
  const BeamOnGround beam(pattern, 0.6 * kRad, 0.1 * kRad);
  EXPECT_NEAR(beam.gain(0, 1), (2 * std::exp(-4 * std::numbers::ln2 * 0.15 * 0.15) + 4) / 6, 1e-12);
}

TEST(BeamWidths, AreThoseOfTheBeamBetweenTheirSteps) {
  for (const double width_deg : {1.0, 10.0}) {
    const AzimuthPattern pattern(gaussian(width_deg));
    const BeamOnGround beam(pattern, 0, 0.1 * kRad);
    const BeamWidths widths(beam, 0.01);
    for (double cosine = 1; cosine > 0.011; cosine *= 0.963)
      EXPECT_NEAR(widths.at(cosine) / beam.width_rad(cosine), 1, 1e-4) << width_deg << ", " << cosine;
    EXPECT_NEAR(widths.at(0) / beam.width_rad(0.01), 1, 0.03);
  }
}

// Level ground from straight below on: the integral of the width over the sine of elevation is
// narrow_rad(1) pi / 2, as of dx / sqrt(1 - x^2).
TEST(AntennaGain, OfASharpFrameHasTheBeamsWidthDownToStraightBelow) {
  RadarSettings s = gaussian(0.3);
  const AzimuthPattern pattern(s);
  const BeamWidths widths(BeamOnGround(pattern, 0, 0.1 * kRad), 0.005);
  AntennaGain::View view;
  view.greatest_sine = 0;
  const AntennaGain gain(s, view, &widths);
  ASSERT_TRUE(gain.has_widths());
  constexpr int kParts = 1 << 20;
  double sum = 0;
  for (int k = 0; k < kParts; ++k) {
    const double g = gain.power_gain(-(k + 0.5) / kParts, 0, 0, 1);
    sum += g * g / kParts;
  }
  EXPECT_NEAR(sum / (narrow_rad(0.3, 1) * kPi / 2), 1, 0.005);
}

}  // namespace
}  // namespace obliq
