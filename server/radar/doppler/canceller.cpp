#include "server/radar/doppler/canceller.h"

#include <cmath>

#include "server/radar/simd/exact_math.h"

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

std::vector<double> canceller_in_u(const std::vector<double>& gains) {
  // 1 - z E = (1 - E) + (1 - z) E, E the step to the pulse before: the power c of it by the binomial theorem.
  const int c = static_cast<int>(gains.size()) - 1;
  std::vector<double> in_u;
  for (int p = 0; p <= c; ++p) {
    double difference = 0;
    for (int q = 0; q <= c - p; ++q)
      difference += (q % 2 == 0 ? 1 : -1) * binomial(c - p, q) * gains[static_cast<std::size_t>(p + q)];
    in_u.push_back(binomial(c, p) * difference);
  }
  return in_u;
}

std::complex<double> canceller_u(double turns) {
  const SinCos half = sincos_turns(turns / 2);
  return {2 * half.sin * half.sin, 2 * half.sin * half.cos};
}

std::complex<double> cancelled(const std::vector<double>& in_u, std::complex<double> u) {
  std::complex<double> sum = in_u.back();
  for (std::size_t p = in_u.size() - 1; p-- > 0;) sum = sum * u + in_u[p];
  return sum / std::sqrt(canceller_noise_gain(static_cast<int>(in_u.size()) - 1));
}

}  // namespace obliq
