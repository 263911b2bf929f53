#include "server/radar/receiver/looks_law.h"

#include <algorithm>
#include <bit>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>

namespace obliq {
namespace {

/// The table's cells divide each octave of |u + steady|^2 into 32: a straight line over a cell is off by at
/// most (1/32)^2 / 8 of the mean, times s^2 T''/T, which is below 1.
constexpr double kLeast = 0x1p-30;
constexpr double kMost = 0x1p6;  // beyond it one number in 1e24
constexpr int kCellBits = 5;
constexpr int kFractionBits = 52;  // of IEEE 754's binary64
constexpr int kBitsInCell = kFractionBits - kCellBits;
constexpr std::uint64_t kCell = std::uint64_t{1} << kBitsInCell;  // of a number's bits

std::uint64_t first_bits() { return std::bit_cast<std::uint64_t>(kLeast); }

/// Of many looks the means are nearly Gaussian. Of all functions of u with a Gaussian law those of |u| alone
/// are correlated less than |u|^2, by up to 0.065: their series in the correlation of u has only even powers,
/// with too much in the high ones. A steady part beside u adds odd ones. Its size is found by trial.
double steady_part(int looks) { return 0.3 * (1 - 2.0 / looks); }

/// P(|u + steady|^2 < s), or > s: that of a non-central chi-square law of two degrees of freedom, a sum of
/// Gamma laws with the weights of Poisson's (Johnson, Kotz and Balakrishnan 1995, eq. 29.2).
double distribution(double s, double steady, bool above) {
  constexpr int kTerms = 16;  // Poisson's mean is at most 0.09: the rest is below 1e-29
  const double mean = steady * steady;
  double weight = std::exp(-mean);
  double sum = 0;
  for (int k = 0; k < kTerms; ++k) {
    sum += weight * (above ? boost::math::gamma_q(k + 1.0, s) : boost::math::gamma_p(k + 1.0, s));
    weight *= mean / (k + 1);
    if (weight == 0) break;
  }
  return sum;
}

}  // namespace

LooksLaw::LooksLaw(int looks) : steady_(steady_part(looks)) {
  const double n = looks;
  const std::uint64_t cells = (std::bit_cast<std::uint64_t>(kMost) - first_bits()) >> kBitsInCell;
  for (std::uint64_t k = 0; k <= cells; ++k) {
    const double s = std::bit_cast<double>(first_bits() + (k << kBitsInCell));
    const double below = distribution(s, steady_, false);
    const double x = below < 0.5 ? boost::math::gamma_p_inv(n, below)
                                 : boost::math::gamma_q_inv(n, distribution(s, steady_, true));
    means_.push_back(static_cast<float>(x / n));
  }
}

std::shared_ptr<const LooksLaw> LooksLaw::of(int looks) {
  static std::mutex mutex;
  static std::map<int, std::shared_ptr<const LooksLaw>> laws;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const LooksLaw>& law = laws[looks];
  if (!law) law = std::make_shared<const LooksLaw>(looks);
  return law;
}

double LooksLaw::mean(double re, double im) const {
  const double along = re + steady_;
  const double s = std::clamp(along * along + im * im, kLeast, kMost * (1 - 0x1p-52));
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(s) - first_bits();
  const auto cell = static_cast<std::size_t>(bits >> kBitsInCell);
  const std::uint64_t within = bits & (kCell - 1);
  const double share = static_cast<double>(within) / static_cast<double>(kCell);
  const double from = static_cast<double>(means_[cell]);
  return from + share * (static_cast<double>(means_[cell + 1]) - from);
}

}  // namespace obliq
