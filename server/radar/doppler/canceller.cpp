#include "server/radar/doppler/canceller.h"

#include <cmath>

#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {

double binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

double canceller_noise_gain(int delays) { return binomial(2 * delays, delays); }

ByLag canceller_autocorrelation(int delays) {
  ByLag by_lag{1};
  for (int k = 1; k <= delays; ++k)
    by_lag[static_cast<std::size_t>(k)] =
        (k % 2 == 0 ? 2 : -2) * binomial(2 * delays, delays - k) / canceller_noise_gain(delays);
  return by_lag;
}

CancellerTerms canceller_terms(const std::vector<double>& g) {
  switch (g.size()) {
    case 2:
      return {{g[0] - g[1], 0}, {g[0] + g[1], 0}};
    case 3:
      return {{(g[0] - g[1]) - (g[1] - g[2]), -(g[0] + g[2]) / 2}, {g[0] - g[2], 0}};
    default:
      // cos 3x = cos x (1 - 4 sin^2 x), sin 3x = sin x (3 - 4 sin^2 x).
      return {{(g[0] - g[3]) - 3 * (g[1] - g[2]), g[3] - g[0]},
              {3 * ((g[0] - g[1]) - (g[2] - g[3])), -(g[0] + g[3])}};
  }
}

std::complex<double> cancelled(const std::vector<double>& gains, double turns) {
  const int delays = static_cast<int>(gains.size()) - 1;
  const CancellerTerms terms = canceller_terms(gains);
  const SinCos half = sincos_turns(turns / 2);
  const double y = 4 * half.sin * half.sin;
  const double even = delays == 2 ? 1 : half.cos;
  const double odd = delays == 2 ? 2 * half.sin * half.cos : half.sin;
  return std::complex<double>{even * (terms.even[0] + terms.even[1] * y),
                              odd * (terms.odd[0] + terms.odd[1] * y)} /
         std::sqrt(canceller_noise_gain(delays));
}

}  // namespace obliq
