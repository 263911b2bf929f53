#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "server/radar/beam/pattern_cuts.h"
#include "server/radar/beam/patterns.h"
#include "terrain/base/errors.h"
#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

constexpr double kRad = std::numbers::pi / 180;

RadarSettings beam(BeamPattern pattern, double width_deg) {
  RadarSettings s;
  s.beam.pattern = pattern;
  s.beam.width_deg = width_deg;
  return s;
}

double db(double gain) { return 10 * std::log10(gain); }

TEST(AzimuthPattern, IsOneOnTheBoresightAndHalfAtHalfAWidth) {
  for (const auto kind :
       {BeamPattern::gaussian, BeamPattern::uniform, BeamPattern::cosine, BeamPattern::taylor}) {
    const AzimuthPattern pattern(beam(kind, 3));
    EXPECT_DOUBLE_EQ(pattern.power_gain(0), 1);
    for (const double side : {-1.5, 1.5}) EXPECT_NEAR(pattern.power_gain(side * kRad), 0.5, 1e-12);
  }
}

TEST(AzimuthPattern, OfUniformAndCosineAperturesHasTheTextbooksBeamwidths) {
  // Balanis 2016, table 12.1: sinc^2 is half at 0.44294, the half cosine's pattern at 0.59451 of lambda / D.
  EXPECT_NEAR(Taper::uniform().half_power_width(), 0.88589, 1e-5);
  EXPECT_NEAR(Taper::half_cosine().half_power_width(), 1.1890, 1e-4);
}

/// The highest level beyond `from` widths, dB.
double highest_beyond(const AzimuthPattern& pattern, double width_rad, double from) {
  double highest = 0;
  for (double at = from; at < 4; at += 1e-4) highest = std::max(highest, pattern.power_gain(at * width_rad));
  return db(highest);
}

TEST(AzimuthPattern, HasTheSidelobesOfItsAperture) {
  const double width = 2 * kRad;
  // One way; both ways twice as many decibels: uniform -26.52 dB. Nulls at 1.1288, 1.2616 and about 1.35
  // widths.
  EXPECT_NEAR(highest_beyond(AzimuthPattern(beam(BeamPattern::uniform, 2)), width, 1.1288), -13.26, 0.005);
  EXPECT_NEAR(highest_beyond(AzimuthPattern(beam(BeamPattern::cosine, 2)), width, 1.2616), -23.00, 0.005);
  RadarSettings taylor = beam(BeamPattern::taylor, 2);
  taylor.beam.extent_deg = 8;  // by itself it ends before its sidelobes
  EXPECT_NEAR(highest_beyond(AzimuthPattern(taylor), width, 1.35), -30.31, 0.01);
  EXPECT_LT(AzimuthPattern(beam(BeamPattern::uniform, 2)).power_gain(width / 0.88589), 1e-10);
}

TEST(AzimuthPattern, SeesAsMuchGroundAsProbertAndJonesSay) {
  const double width = 3 * kRad;
  EXPECT_NEAR(AzimuthPattern(beam(BeamPattern::gaussian, 3)).equivalent_width_rad(),
              width * std::sqrt(std::numbers::pi / (8 * std::numbers::ln2)), 1e-6 * width);
  // Integral of sinc^4 is 2/3; what lies beyond four widths is 1e-4 of it.
  EXPECT_NEAR(AzimuthPattern(beam(BeamPattern::uniform, 3)).equivalent_width_rad(),
              width * (2.0 / 3) / 0.88589, 1e-4 * width);
}

TEST(AzimuthPattern, EndsAtItsExtent) {
  RadarSettings s = beam(BeamPattern::uniform, 3);
  EXPECT_NEAR(AzimuthPattern(s).extent_rad(), 12 * kRad, 1e-9);
  // A Gaussian is 30 dB down at sqrt(3 ln 10 / 4 ln 2) = 1.5785 widths.
  EXPECT_NEAR(AzimuthPattern(beam(BeamPattern::gaussian, 3)).extent_rad(), 3 * 1.5785 * kRad, 0.01 * kRad);
  s.beam.extent_deg = 5;
  const AzimuthPattern pattern(s);
  EXPECT_GT(pattern.power_gain(4.99 * kRad), 0);
  EXPECT_EQ(pattern.power_gain(5.01 * kRad), 0);
}

TEST(AzimuthPattern, ThatIsOffSeesItsOwnBearingAlone) {
  const AzimuthPattern pattern{RadarSettings{}};
  EXPECT_EQ(pattern.power_gain(0), 1);
  EXPECT_EQ(pattern.power_gain(1e-9), 0);
  EXPECT_EQ(pattern.extent_rad(), 0);
}

RadarSettings fan(ElevationPattern kind) {
  RadarSettings s;
  s.beam.elevation = kind;
  s.beam.elevation_width_deg = 4;
  s.beam.cosecant_to_deg = 30;
  return s;
}

TEST(ElevationGain, OfCosecantSquaredFallsAsOneOverSineSquaredBelowItsShoulder) {
  const double tilt = -1 * kRad;
  const ElevationGain gain(fan(ElevationPattern::cosecant), tilt);
  EXPECT_DOUBLE_EQ(gain.power_gain(tilt), 1);
  EXPECT_NEAR(gain.power_gain(-3 * kRad), 0.5, 1e-12);
  for (const double depression : {3.0, 5.0, 12.0, 29.9}) {
    const double ratio = std::sin(3 * kRad) / std::sin(depression * kRad);
    EXPECT_NEAR(gain.power_gain(-depression * kRad), 0.5 * ratio * ratio, 1e-12) << depression;
  }
  EXPECT_NEAR(gain.power_gain(1 * kRad), 0.5, 1e-12);
  // Half the width below its end it has lost another 3 dB.
  EXPECT_NEAR(gain.power_gain(-32 * kRad) / gain.power_gain(-30 * kRad), 0.5, 1e-12);
}

TEST(ElevationGain, OfAGaussianFollowsTheTiltAndOffIsOneEverywhere) {
  const ElevationGain gain(fan(ElevationPattern::gaussian), -5 * kRad);
  EXPECT_NEAR(gain.power_gain(-7 * kRad), 0.5, 1e-12);
  EXPECT_NEAR(gain.power_gain(-3 * kRad), 0.5, 1e-12);
  EXPECT_EQ(ElevationGain(fan(ElevationPattern::off), 0.3).power_gain(-1.2), 1);
}

TEST(PatternCuts, AreReadRelativeToTheirPeakAndInterpolatedInDecibels) {
  const test::Folder folder;
  const PatternCuts cuts =
      read_pattern_cuts(folder.text("horn.csv",
                                    "cut,angle_deg,gain_db\nazimuth,-2,10\nazimuth,0,20\r\nazimuth,4,0\n"
                                    "elevation,-10,-40\nelevation,0,0\nelevation,10,-60"));
  EXPECT_NEAR(db(cuts.azimuth.gain(0)), 0, 1e-12);
  EXPECT_NEAR(db(cuts.azimuth.gain(-1 * kRad)), -5, 1e-9);
  EXPECT_NEAR(db(cuts.azimuth.gain(3 * kRad)), -15, 1e-9);
  EXPECT_EQ(cuts.azimuth.gain(4.1 * kRad), 0);
  EXPECT_EQ(cuts.azimuth.gain(-2.1 * kRad), 0);
  EXPECT_NEAR(db(cuts.elevation.gain(10 * kRad)), -60, 1e-9);
}

/// What is said about a file of that content.
std::string complaint(const std::string& content) {
  const test::Folder folder;
  try {
    read_pattern_cuts(folder.text("bad.csv", content));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(PatternCuts, OfASpreadsheetMayBeginWithItsMark) {
  EXPECT_EQ(complaint("\xEF\xBB\xBF"
                      "cut,angle_deg,gain_db\nazimuth,-5,-30\nazimuth,0,0\nazimuth,5,-30\n"),
            "");
}

TEST(PatternCuts, ThatCannotBeAnAntennaAreRefusedWithTheirLine) {
  const std::string head = "cut,angle_deg,gain_db\n";
  for (const auto& [content, part] : std::initializer_list<std::pair<std::string, std::string>>{
           {"", "no rows"},
           {"angle,gain\n", "bad.csv:1"},
           {head, "no rows"},
           {head + "azimuth,0\n", ":2"},
           {head + "azimuth,0,0,0\n", ":2"},
           {head + "side,0,0\n", "azimuth or elevation"},
           {head + "azimuth,nan,0\n", "-180 to 180"},
           // Ratios, losses, a table that is cut off.
           {head + "azimuth,-5,0.001\nazimuth,0,1\nazimuth,5,0.001\n", "only 0.999 dB below its peak"},
           {head + "azimuth,-5,30\nazimuth,0,0\nazimuth,5,30\n", "30 dB below its peak at angle 0"},
           {head + "azimuth,-5,-30\nazimuth,0,0\nazimuth,5,-1\n", "only 1 dB below its peak where it ends"},
           {head + "azimuth,0,inf\n", "-300 to 100"},
           {head + "azimuth,0,1e999\n", "-300 to 100"},
           {head + "azimuth,3600,0\n", "-180 to 180"},
           {head + "azimuth,0,0x\n", "-300 to 100"},
           {head + "azimuth,1,0\nazimuth,0,0\n", "rise"},
           {head + "azimuth,-1,0\nazimuth,1,0\n", "at least 3"},
           {head + "azimuth,1,0\nazimuth,2,0\nazimuth,3,0\n", "angle 0"},
           {head + std::string(5000, 'x'), "characters"},
       }) {
    EXPECT_NE(complaint(content).find(part), std::string::npos) << content << "\n" << complaint(content);
    EXPECT_NE(complaint(content).find("allowed"), std::string::npos) << complaint(content);
  }
}

}  // namespace
}  // namespace obliq
