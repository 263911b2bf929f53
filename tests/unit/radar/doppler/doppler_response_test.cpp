// The response of Doppler filters: published widths and losses of their windows, and the table against sums
// over pulses.
#include "server/radar/doppler/doppler_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/doppler/canceller.h"

namespace obliq::doppler_response_test {
namespace {

RadarSettings filter(DopplerWindow window, int pulses) {
  RadarSettings s;
  s.mode = RadarMode::dbs;
  s.doppler.window = window;
  s.doppler.pulses = pulses;
  return s;
}

double half_power_cells(const DopplerResponse& response) {
  double low = 0, high = 3;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (std::pow(response.at(middle), 2) > 0.5 ? low : high) = middle;
  }
  return low + high;
}

// Harris 1978, table I, for 64 weights at the middles of 64 parts.
TEST(DopplerResponse, HasTheLossAndTheWidthOfItsWindow) {
  const struct {
    DopplerWindow window;
    double loss_db, width_cells;
  } kWanted[] = {{DopplerWindow::none, 0, 0.8860},
                 {DopplerWindow::hamming, 1.3444, 1.3029},
                 {DopplerWindow::blackman_harris, 3.0197, 1.8994}};
  for (const auto& wanted : kWanted) {
    const RadarSettings s = filter(wanted.window, 64);
    EXPECT_NEAR(10 * std::log10(64 * doppler_noise_factor(s)), wanted.loss_db, 1e-3);
    EXPECT_NEAR(half_power_cells(DopplerResponse(s)), wanted.width_cells, 1e-3);
  }
}

// Weights of the windows by their own formulas, at the middles of as many parts.
double weight(DopplerWindow window, double x) {
  const double c = 2 * std::numbers::pi * x;
  switch (window) {
    case DopplerWindow::hamming:
      return 0.54 + 0.46 * std::cos(c);
    case DopplerWindow::hann:
      return 0.5 + 0.5 * std::cos(c);
    case DopplerWindow::blackman_harris:
      return 0.35875 + 0.48829 * std::cos(c) + 0.14128 * std::cos(2 * c) + 0.01168 * std::cos(3 * c);
    default:
      return 1;
  }
}

TEST(DopplerResponse, IsTheSumOverItsPulses) {
  for (const int n : {2, 3, 16, 63, 64})
    for (const DopplerWindow window :
         {DopplerWindow::none, DopplerWindow::hamming, DopplerWindow::hann, DopplerWindow::blackman_harris}) {
      if (n < 4 && window == DopplerWindow::blackman_harris) continue;  // its third term is an alias
      const DopplerResponse response(filter(window, n));
      for (double u = -2.3 * n; u < 2.3 * n; u += 0.17) {
        double sum = 0, weights = 0;
        for (int k = 0; k < n; ++k) {
          const double w = weight(window, (k + 0.5) / n - 0.5);
          sum += w * std::cos(2 * std::numbers::pi * u * (k - (n - 1) / 2.0) / n);
          weights += w;
        }
        EXPECT_NEAR(response.at(u), sum / weights, 2e-4) << n << " " << u;
      }
    }
}

TEST(DopplerResponse, OfASyntheticApertureEndsWithItsTable) {
  RadarSettings s = filter(DopplerWindow::none, 64);
  s.mode = RadarMode::sar;
  const DopplerResponse response(s);
  for (double u = 0.05; u < 23; u += 0.1)
    EXPECT_NEAR(response.at(u), std::sin(std::numbers::pi * u) / (std::numbers::pi * u), 2e-4);
  EXPECT_EQ(response.at(24), 0);
  EXPECT_EQ(response.at(1e9), 0);
}

// By the sum itself, as at the middle of the pulses.
TEST(Canceller, IsTheDifferenceOfItsPulses) {
  const std::vector<double> gains{0.9, 0.7, 0.4, 0.35};
  for (int delays = 1; delays <= 3; ++delays)
    for (const double turns : {0.0, 1e-4, 0.1, 0.25, 0.5, 0.9}) {
      const std::vector<double> some(gains.begin(), gains.begin() + delays + 1);
      std::complex<double> sum = 0;
      for (int i = 0; i <= delays; ++i)
        sum += (i % 2 == 0 ? 1 : -1) * binomial(delays, i) * some[static_cast<std::size_t>(i)] *
               std::polar(1.0, 2 * std::numbers::pi * turns * (delays / 2.0 - i));
      EXPECT_NEAR(std::abs(cancelled(some, turns) - sum / std::sqrt(canceller_noise_gain(delays))), 0, 1e-14);
    }
  EXPECT_EQ(canceller_noise_gain(1), 2);
  EXPECT_EQ(canceller_noise_gain(2), 6);
  EXPECT_EQ(canceller_noise_gain(3), 20);
}

}  // namespace
}  // namespace obliq::doppler_response_test
