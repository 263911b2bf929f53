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

/// What echoes of a row become of which the antenna, as it turns, sees gains[i] i pulses before, i from 0 to
/// c: the sum over i of (-1)^i C(c, i) gains[i] z^i, z = exp(-j 2 pi f / PRF), as a polynomial in u = 1 - z.
/// Its coefficients hold the gains' own differences, so that nothing large is subtracted from its like.
std::vector<double> canceller_in_u(const std::vector<double>& gains);

/// u of the turns that the echo's phase makes between two pulses.
std::complex<double> canceller_u(double turns);

/// A polynomial of canceller_in_u at u, of unit noise gain.
std::complex<double> cancelled(const std::vector<double>& in_u, std::complex<double> u);

}  // namespace obliq
