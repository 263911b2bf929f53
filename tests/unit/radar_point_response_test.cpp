#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/beam/point_response.h"

namespace obliq {
namespace {

constexpr double kSpeedOfLight_m_s = 299792458.0;

RadarSettings compressed(PulseWindow window, double bandwidth_mhz = 10) {
  RadarSettings s;
  s.pulse_kind = PulseKind::compressed;
  s.pulse_window = window;
  s.pulse_bandwidth_mhz = bandwidth_mhz;
  return s;
}

RadarSettings rectangular(double length_us) {
  RadarSettings s;
  s.pulse_kind = PulseKind::rectangular;
  s.pulse_length_us = length_us;
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
}  // namespace obliq
