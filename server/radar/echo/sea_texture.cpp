#include "server/radar/echo/sea_texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/radar/echo/sea_echo.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

double exp_of(double x) { return ratio_of_db(x / kNepersOfDecibel); }

/// ln Gamma(x), x > 0: Stirling's series ten further on, to 1e-12.
double log_gamma(double x) {
  double shift = 0;
  for (int k = 0; k < 10; ++k) shift += log_of_positive(x + k);
  const double y = x + 10, over = 1 / (y * y);
  const double series = (1.0 / 12 + over * (-1.0 / 360 + over * (1.0 / 1260 - over / 1680))) / y;
  return (y - 0.5) * log_of_positive(y) - y + 0.5 * log_of_positive(2 * std::numbers::pi) + series - shift;
}

/// The normal distribution's density and, for z <= 0, its share below z (Abramowitz and Stegun 26.2.11).
double normal_density(double z) { return exp_of(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }
double normal_below(double z) {
  double term = z, sum = z;
  for (int k = 1; std::fabs(term) > 1e-18 * std::fabs(sum); ++k) sum += term *= z * z / (2 * k + 1);
  return 0.5 + normal_density(z) * sum;
}

/// Share of a Gamma distribution of scale 1 below x, by its series (Abramowitz and Stegun 6.5.29).
double gamma_below(double shape, double x, double log_gamma_of_shape) {
  double term = 1 / shape, sum = term;
  for (int n = 1; term > 1e-17 * sum; ++n) sum += term *= x / (shape + n);
  return std::min(1.0, exp_of(shape * log_of_positive(x) - x - log_gamma_of_shape) * sum);
}

}  // namespace

void fill_texture(double shape, float* tau) {
  const double of_shape = log_gamma(shape);
  constexpr int kStepsAUnit = 32, kSteps = 2 * SeaTexture::kReach * kStepsAUnit;
  double values[kSteps + 2];
  double x = 0, mean = 0, weight = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double z = static_cast<double>(k) / kStepsAUnit - SeaTexture::kReach;
    const double below = normal_below(z);
    // Where the series begins the share is x^shape / Gamma(shape + 1), which is never too little: Newton's
    // method on its logarithm, which is concave in ln x, comes from below.
    const double least = exp_of(std::max(
        -690.0, (log_of_positive(std::max(below, 1e-300)) + of_shape + log_of_positive(shape)) / shape));
    x = std::max(x, least);
    for (int step = 0; step < 60; ++step) {
      const double share = gamma_below(shape, x, of_shape);
      const double density = exp_of(shape * log_of_positive(x) - x - of_shape);  // by ln x
      const double rise = (log_of_positive(below) - log_of_positive(share)) * share / density;
      if (!(rise > 1e-12)) break;
      x *= exp_of(std::min(rise, 1.0));
    }
    values[k] = x / shape;
    const double here = normal_density(z);
    mean += here * values[k];
    weight += here;
  }
  values[kSteps + 1] = values[kSteps];
  constexpr int kParts = SeaTexture::kStepsAUnit / kStepsAUnit;  // lines between the values
  for (int k = 0; k <= SeaTexture::kSteps; ++k) {
    const double low = values[k / kParts], high = values[k / kParts + 1];
    tau[k] = static_cast<float>((low + (high - low) * (k % kParts) / kParts) * weight / mean);
  }
}

std::shared_ptr<const SeaTexture> sea_texture(const ScenePlan& plan) {
  const RadarSettings& s = plan.settings();
  if (!(s.sea.shape > 0) || !has_sea(s, plan.scene().materials())) return nullptr;
  auto texture = std::make_shared<SeaTexture>();
  fill_texture(s.sea.shape, texture->tau);
  texture->nodes_per_m = static_cast<float>(1 / kTextureSide_m);
  // By north at the scene's origin, the same for all antennas: since 1970 it has drifted far, and a direction
  // that turns with the antenna's meridian would carry it away.
  const SinCos from = sincos_turns(s.atmosphere.wind_from_deg / 360);
  const double drifted_m =
      kDriftOfWind * s.atmosphere.wind_m_s * (static_cast<double>(plan.pose().settings.sim_time_ns) * 1e-9);
  const glm::dvec3& at = plan.sector().antenna_m;
  const auto place = [](double metres, std::uint32_t& node, float& part) {
    const double nodes = metres / kTextureSide_m;
    node = static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(nodes)));
    part = static_cast<float>(nodes - std::floor(nodes));
  };
  place(at.x + drifted_m * from.sin, texture->node_x, texture->part_x);
  place(at.z + drifted_m * from.cos, texture->node_z, texture->part_z);
  texture->seed = static_cast<std::uint32_t>(mix64(static_cast<std::uint64_t>(s.speckle_seed)));
  return texture;
}

double shape_of_cell(double shape, double along_m, double across_m) {
  SeaTexture texture{};
  fill_texture(shape, texture.tau);
  texture.nodes_per_m = static_cast<float>(1 / kTextureSide_m);
  auto pieces = std::make_unique<SeaPieces>();
  pieces->n = SeaPieces::kMost;
  double sum = 0, squares = 0;
  constexpr int kRows = 16;
  for (int row = 0; row < kRows; ++row) {
    for (int k = 0; k < SeaPieces::kMost; ++k) {
      const auto at = static_cast<std::size_t>(k);
      // Far enough apart to have nothing in common, at all places between nodes.
      const double x_m = (k - SeaPieces::kMost / 2) * (across_m + 97.3), z_m = (row + 1) * (along_m + 101.7);
      const double distance_m = std::sqrt(x_m * x_m + z_m * z_m);
      pieces->distance_m[at] = static_cast<float>(distance_m);
      pieces->sine[at] = static_cast<float>(x_m / distance_m);
      pieces->cosine[at] = static_cast<float>(z_m / distance_m);
      pieces->along_m[at] = static_cast<float>(along_m);
      pieces->across_m[at] = static_cast<float>(across_m);
    }
    active_kernels().sea_texture(texture, *pieces);
    for (const float tau : pieces->tau) {
      sum += static_cast<double>(tau);
      squares += static_cast<double>(tau) * static_cast<double>(tau);
    }
  }
  const double n = kRows * SeaPieces::kMost, mean = sum / n;
  return mean * mean / (squares / n - mean * mean);
}

}  // namespace obliq
