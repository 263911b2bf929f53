#include "server/radar/taper.h"

#include <cmath>
#include <utility>

#include "terrain/base/units.h"

namespace obliq {
namespace {

/// The mean of n unit phasors, u turns apart in all, about their middle: sin(pi u) / (n sin(pi u / n)).
double dirichlet(double u, int n) {
  const double below = std::sin(kPi * u / n);
  if (std::abs(below) < 1e-9) return std::cos(kPi * u) / std::cos(kPi * u / n);
  return std::sin(kPi * u) / (n * below);
}

}  // namespace

double sinc(double u) {
  const double x = kPi * u;
  // The series' next term is x^4 / 120: below 1e-18.
  return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x;
}

Taper::Taper(std::vector<double> series, bool half_cosine)
    : series_(std::move(series)), half_cosine_(half_cosine) {
  // The main lobe falls steadily to its first null, which lies within nbar + 1 of the peak.
  double low = 0;
  double high = 0;
  while (std::pow(transform(high), 2) > 0.5) {
    low = high;
    high += 0.05;
  }
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (std::pow(transform(middle), 2) > 0.5 ? low : high) = middle;
  }
  width_ = low + high;
}

Taper Taper::half_cosine() { return Taper({}, true); }

Taper Taper::blackman_harris() {
  constexpr double kMean = 0.35875;
  return Taper({0.48829 / (2 * kMean), 0.14128 / (2 * kMean), 0.01168 / (2 * kMean)});
}

Taper Taper::taylor(int nbar, double sidelobe_db) {
  // Carrara, Goodman, Majewski 1995, appendix D.2.
  const double a = std::acosh(std::pow(10, sidelobe_db / 20)) / kPi;
  const double stretch2 = nbar * nbar / (a * a + (nbar - 0.5) * (nbar - 0.5));
  std::vector<double> series;
  for (int m = 1; m < nbar; ++m) {
    double above = 1;
    double below = 1;
    for (int n = 1; n < nbar; ++n) {
      above *= 1 - m * m / stretch2 / (a * a + (n - 0.5) * (n - 0.5));
      if (n != m) below *= 1 - static_cast<double>(m * m) / (n * n);
    }
    series.push_back((m % 2 == 1 ? 1 : -1) * above / (2 * below));
  }
  return Taper(std::move(series));
}

double Taper::transform(double u) const {
  if (half_cosine_) {
    // cos(pi u) / (1 - 4 u^2) as the mean of two shifted sinc functions, which has no gap at u = 1/2.
    return (sinc(u - 0.5) + sinc(u + 0.5)) * kPi / 4;
  }
  double sum = sinc(u);
  for (std::size_t m = 1; m <= series_.size(); ++m)
    sum += series_[m - 1] * (sinc(u - static_cast<double>(m)) + sinc(u + static_cast<double>(m)));
  return sum;
}

double Taper::noise_width() const {
  if (half_cosine_) return kPi * kPi / 8;
  double sum = 1;
  for (const double f : series_) sum += 2 * f * f;
  return sum;
}

double Taper::weight(double x) const {
  if (half_cosine_) return std::cos(kPi * x);
  double sum = 1;
  for (std::size_t m = 1; m <= series_.size(); ++m)
    sum += 2 * series_[m - 1] * std::cos(2 * kPi * static_cast<double>(m) * x);
  return sum;
}

double Taper::sampled(double u, int n) const {
  const auto sum = [&](double at) {
    if (half_cosine_) return dirichlet(at - 0.5, n) + dirichlet(at + 0.5, n);
    double total = dirichlet(at, n);
    for (std::size_t m = 1; m <= series_.size(); ++m)
      total += series_[m - 1] *
               (dirichlet(at - static_cast<double>(m), n) + dirichlet(at + static_cast<double>(m), n));
    return total;
  };
  return sum(u) / sum(0);
}

std::vector<double> Taper::sampled_weights(int n) const {
  std::vector<double> weights;
  double sum = 0;
  for (int k = 0; k < n; ++k) sum += weights.emplace_back(weight((k + 0.5) / n - 0.5));
  for (double& w : weights) w /= sum;
  return weights;
}

double Taper::sampled_noise_width(int n) const {
  double squares = 0;
  for (const double w : sampled_weights(n)) squares += w * w;
  return n * squares;
}

}  // namespace obliq
