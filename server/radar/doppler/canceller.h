#pragma once
// A moving target indicator's canceller of c delays: x(t) - x(t - 1/PRF), c times over.
#include <array>
#include <complex>
#include <vector>

namespace obliq {

constexpr int kMostDelays = 3;

/// Of 0 to c: C(c, k).
double binomial(int n, int k);

/// Power that noise gains: C(2c, c). The canceller is divided by its root, so that noise keeps its level.
double canceller_noise_gain(int delays);

/// By lag in pulse intervals, 0 first: what the canceller leaves of echoes of mean power 1, over its noise
/// gain, is the sum of these times the echoes' correlations.
using ByLag = std::array<double, kMostDelays + 1>;
ByLag canceller_autocorrelation(int delays);

/// What a canceller makes of echoes that its antenna, as it turns, sees with gains[i] i pulses before, i from
/// 0 to c, as at the middle of its pulses: the sum over i of (-1)^i C(c, i) gains[i] exp(j 2 pi (c/2 - i) f /
/// PRF). Pulses as far before the middle as behind it go together. With s and c of pi f / PRF and y = 4 s^2
/// it is
///   even (even[0] + even[1] y) + j odd (odd[0] + odd[1] y); even = 1, odd = 2 s c of two delays, else c and
///   s.
/// even[0] is the gains' own difference, of order c, and odd[0] one of order c - 1 but for a single delay,
/// which has no y: nothing large is subtracted from its like.
struct CancellerTerms {
  std::array<double, 2> even{}, odd{};
};
CancellerTerms canceller_terms(const std::vector<double>& gains);

/// That sum, of unit noise gain.
std::complex<double> cancelled(const std::vector<double>& gains, double turns);

}  // namespace obliq
