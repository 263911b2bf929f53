#include "server/explain/detection.h"

#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <cmath>

namespace obliq {

double detection_probability(int swerling, double snr, double false_alarm) {
  const double threshold = -std::log(false_alarm);  // of power over the noise's mean
  switch (swerling) {
    case 0:  // Marcum's Q: twice the power has two degrees of freedom
      return boost::math::cdf(boost::math::complement(
          boost::math::non_central_chi_squared_distribution<double>(2, 2 * snr), 2 * threshold));
    case 1:
    case 2:
      return std::exp(-threshold / (1 + snr));
    default: {
      const double half = snr / 2;
      return std::exp(-threshold / (1 + half)) * (1 + threshold * half / ((1 + half) * (1 + half)));
    }
  }
}

double detectable_snr_db(int swerling, double probability, double false_alarm) {
  double low_db = -60, high_db = 80;
  for (int k = 0; k < 60; ++k) {
    const double middle_db = (low_db + high_db) / 2;
    const double found = detection_probability(swerling, std::pow(10.0, middle_db / 10), false_alarm);
    (found < probability ? low_db : high_db) = middle_db;
  }
  return (low_db + high_db) / 2;
}

}  // namespace obliq
