// A beam's width on ground at any elevation, against closed forms.
#include "server/radar/beam/patterns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/beam/antenna_gain.h"
#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/pattern_cuts.h"
#include "server/radar/beam/point_response.h"
#include "terrain/base/errors.h"
#include "tests/unit/terrain_files.h"

namespace obliq::patterns_test {
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

constexpr double kPi = std::numbers::pi;

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
  ASSERT_TRUE(gain.keeps_elevation());
  constexpr int kParts = 1 << 20;
  double sum = 0;
  for (int k = 0; k < kParts; ++k) {
    const double g = gain.power_gain(-(k + 0.5) / kParts, 0, 0, 1);
    sum += g * g / kParts;
  }
  EXPECT_NEAR(sum / (narrow_rad(0.3, 1) * kPi / 2), 1, 0.005);
}

constexpr double kSpeedOfLight_m_s = 299792458.0;

RadarSettings compressed(PulseWindow window, double bandwidth_mhz = 10) {
  RadarSettings s;
  s.pulse.kind = PulseKind::compressed;
  s.pulse.window = window;
  s.pulse.bandwidth_mhz = bandwidth_mhz;
  return s;
}

RadarSettings rectangular(double length_us) {
  RadarSettings s;
  s.pulse.kind = PulseKind::rectangular;
  s.pulse.length_us = length_us;
  return s;
}

double sum_of_squares(const std::vector<double>& h) {
  double sum = 0;
  for (const double x : h) sum += x * x;
  return sum;
}

/// Published figures of a window: peak sidelobe, width in c / 2B, loss.
struct Published {
  PulseWindow window;
  double first_null, sidelobe_db, sidelobe_tolerance_db, width, loss_db;
};

TEST(PointResponse, HasTheSidelobesWidthAndLossOfItsWindow) {
  // Harris 1978, table 1; Taylor 4/30: scipy.signal.windows.taylor, and MathWorks' loss of 0.69 dB.
  for (const Published& p : {Published{PulseWindow::none, 1.0, -13.26, 0.005, 0.88589, 0},
                             Published{PulseWindow::hamming, 2.0, -42.68, 0.01, 1.3030, 1.344},
                             Published{PulseWindow::hann, 2.0, -31.47, 0.01, 1.4406, 1.761},
                             Published{PulseWindow::taylor, 1.6, -30.31, 0.01, 1.1247, 0.689}}) {
    const PointResponse response(compressed(p.window));
    const double resolution = kSpeedOfLight_m_s / 2 / 10e6;
    EXPECT_DOUBLE_EQ(response.resolution_m(), resolution);
    EXPECT_DOUBLE_EQ(response.at(0), 1);
    double sidelobe = 0;
    for (double u = p.first_null; u < 30; u += 1e-3)
      sidelobe = std::max(sidelobe, std::abs(response.at(u * resolution)));
    EXPECT_NEAR(20 * std::log10(sidelobe), p.sidelobe_db, p.sidelobe_tolerance_db);
    EXPECT_NEAR(response.at(p.width / 2 * resolution), std::numbers::sqrt2 / 2, 1e-4);
    EXPECT_NEAR(response.window_loss_db(), p.loss_db, 5e-4);
  }
}

TEST(Taper, TransformsAsScipysWindowsDo) {
  // scipy 1.17.1: windows.taylor(16384, nbar, sll, norm=False), general_hamming(16384, 0.54), hann, cosine,
  // each summed with cos(2 pi u x); the windows are samples, hence 1e-4.
  constexpr double kAt[] = {0.25, 0.7, 1.3, 2.5, 5.2};
  const auto expect = [&](const Taper& taper, const double(&values)[5]) {
    for (int k = 0; k < 5; ++k) EXPECT_NEAR(taper.transform(kAt[k]), values[k], 1e-4) << kAt[k];
  };
  expect(Taper::taylor(4, 30), {0.935925967, 0.576478797, 0.0811156292, 0.0287021679, -0.0125436293});
  expect(Taper::taylor(6, 40), {0.947371208, 0.64417414, 0.176218716, 0.00579391281, -0.00496432976});
  expect(Taper::hamming(), {0.95144539, 0.668975346, 0.215209806, -0.00179645482, -0.00415339195});
  expect(Taper::hann(), {0.960337403, 0.72133923, 0.287088182, -0.024252179, 0.00138173346});
  expect(Taper::half_cosine(), {0.942809041, 0.612276303, 0.10204605, 0, 0.00754961609});
}

TEST(PointResponse, SumsLevelGroundOverABinAsLongAsItsResolution) {
  // Sum of h^2 by Parseval: mean W^2 over (mean W)^2; Taylor 4/30 as scipy's.
  for (const auto& [window, sum] :
       {std::pair{PulseWindow::hamming, 1.3628}, {PulseWindow::hann, 1.5}, {PulseWindow::taylor, 1.1719}}) {
    const PointResponse response(compressed(window));
    for (const int finer : {1, 2, 8}) {
      const double bin_m = response.resolution_m() / finer;
      EXPECT_NEAR(sum_of_squares(response.kernel(bin_m, 256)) / finer, sum, 1e-3);
    }
    EXPECT_NEAR(response.equivalent_length_m() / response.resolution_m(), sum, 1e-3);
  }
}

TEST(PointResponse, OfARectangularPulseIsATriangleWithThePowerOfItsWholeShape) {
  const PointResponse response(rectangular(1));
  const double half = kSpeedOfLight_m_s / 2 * 1e-6;
  EXPECT_NEAR(response.at(half / 4), 0.75, 1e-12);
  EXPECT_EQ(response.at(-1.1 * half), 0);
  for (const int n : {1, 2, 5, 32}) {
    const std::vector<double> h = response.kernel(half / n, 40);
    EXPECT_NEAR(sum_of_squares(h) * half / n, half * 2 / 3, 1e-9 * half);
    EXPECT_NEAR(10 * std::log10(h[40] * h[40]), -10 * std::log10(1 + 1 / (2.0 * n * n)), 1e-9);
  }
}

TEST(PointResponse, KernelIsSymmetricAndTheResponseAtWholeBins) {
  const PointResponse response(compressed(PulseWindow::hamming));
  const std::vector<double> h = response.kernel(7.5, 16);
  ASSERT_EQ(h.size(), 33U);
  for (int j = -16; j <= 16; ++j) {
    EXPECT_EQ(h[static_cast<std::size_t>(16 + j)], h[static_cast<std::size_t>(16 - j)]);
    EXPECT_NEAR(h[static_cast<std::size_t>(16 + j)], response.at(j * 7.5), 1e-15);
  }
}

TEST(PointResponse, TakesTheBandwidthThatARangeBinResolvesWhereNoneIsGiven) {
  RadarSettings s = compressed(PulseWindow::hann, 0);
  s.r_min_m = 1000;
  s.r_max_m = 3000;
  s.range_bins = 100;
  EXPECT_DOUBLE_EQ(PointResponse(s).resolution_m(), 20);
}

TEST(PointResponse, ThatIsOffLeavesBinsAlone) {
  const PointResponse response{RadarSettings{}};
  EXPECT_EQ(response.kernel(30, 16), std::vector<double>{1});
  EXPECT_EQ(response.at(0), 1);
  EXPECT_EQ(response.at(1e-9), 0);
  EXPECT_EQ(response.window_loss_db(), 0);
}

}  // namespace
}  // namespace obliq::patterns_test
