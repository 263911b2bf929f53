#include "terrain/dem/synthetic.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "terrain/base/errors.h"
#include "terrain/base/hash.h"
#include "terrain/base/parallel.h"
#include "terrain/base/units.h"
#include "terrain/dem/anchor_map.h"

namespace obliq {
namespace {

/// A wall's faces are found on nodes; rounding of sin and cos at 100 km is far below this.
constexpr double kFaceSlack_m = 1e-6;

/// Wavelengths of the hills, from mountain ranges to what the finest usual grid still shows.
constexpr double kLongestWave_m = 16384;
constexpr int kOctaves = 9;

/// Quintic fade: second derivative zero at both ends, so no creases at the lattice (Perlin, "Improving
/// noise", 2002).
double fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

/// Smooth noise in [0, 1] that takes hashed values at whole numbers.
double value_noise(std::uint64_t seed, double u, double v) {
  const double fu = std::floor(u);
  const double fv = std::floor(v);
  const auto i = static_cast<std::int64_t>(fu);
  const auto j = static_cast<std::int64_t>(fv);
  const double s = fade(u - fu);
  const double t = fade(v - fv);
  const auto at = [&](std::int64_t a, std::int64_t b) { return unit_from_hash(hash_cell(seed, a, b)); };
  const double low = at(i, j) + s * (at(i + 1, j) - at(i, j));
  const double high = at(i, j + 1) + s * (at(i + 1, j + 1) - at(i, j + 1));
  return low + t * (high - low);
}

/// Sum of octaves, each half as long and half as high as the one before: in [0, 1].
double fractal(std::uint64_t seed, double x_m, double z_m) {
  double sum = 0;
  double weight = 1;
  double total = 0;
  double u = x_m / kLongestWave_m;
  double v = z_m / kLongestWave_m;
  for (int octave = 0; octave < kOctaves; ++octave) {
    sum += weight * value_noise(seed + static_cast<std::uint64_t>(octave), u, v);
    total += weight;
    weight /= 2;
    // Each octave is turned by a 3-4-5 angle, or the lattices' lines would coincide and show.
    const double turned = 2 * (0.8 * u - 0.6 * v);
    v = 2 * (0.6 * u + 0.8 * v);
    u = turned;
  }
  return sum / total;
}

void require(bool ok, const char* field, double found, const char* allowed) {
  if (!ok) throw InputError(FieldError{field, std::to_string(found), allowed}.text());
}

void check(SyntheticKind kind, const SyntheticSpec& s) {
  for (const auto& [field, value] :
       {std::pair{"[terrain] height_m", s.height_m}, std::pair{"[terrain] base_m", s.base_m}}) {
    require(std::abs(value) <= 1e5, field, value, "at most 100 km");
  }
  require(std::abs(s.slope) <= 10, "[terrain] slope", s.slope, "rise over run of at most 10");
  require(std::isfinite(s.bearing_deg), "[terrain] bearing_deg", s.bearing_deg, "degrees");
  require(std::isfinite(s.distance_m), "[terrain] distance_m", s.distance_m, "metres");
  const bool has_width =
      kind == SyntheticKind::ridge || kind == SyntheticKind::wall || kind == SyntheticKind::cone;
  require(!has_width || (s.width_m > 0 && std::isfinite(s.width_m)), "[terrain] width_m", s.width_m,
          "a positive number of metres");
}

}  // namespace

double synthetic_height_m(SyntheticKind kind, const SyntheticSpec& shape, double x_m, double z_m) {
  const double sin_b = std::sin(shape.bearing_deg * kDegree_rad);
  const double cos_b = std::cos(shape.bearing_deg * kDegree_rad);
  const double along_m = x_m * sin_b + z_m * cos_b;
  const double rise_m = shape.height_m - shape.base_m;
  switch (kind) {
    case SyntheticKind::ramp:
      return shape.base_m + shape.slope * along_m;
    case SyntheticKind::ridge: {
      const double off = std::abs(along_m - shape.distance_m) / (shape.width_m / 2);
      return shape.base_m + rise_m * std::max(0.0, 1 - off);
    }
    case SyntheticKind::wall: {
      const double behind_m = along_m - shape.distance_m;
      const bool on = behind_m >= -kFaceSlack_m && behind_m <= shape.width_m + kFaceSlack_m;
      return on ? shape.height_m : shape.base_m;
    }
    case SyntheticKind::cone: {
      const double away_m = std::hypot(x_m - shape.distance_m * sin_b, z_m - shape.distance_m * cos_b);
      return shape.base_m + rise_m * std::max(0.0, 1 - away_m / shape.width_m);
    }
    case SyntheticKind::hills: {
      const double n = fractal(shape.seed, x_m, z_m);
      // Averages of octaves crowd around 1/2; the smoothstep spreads them without leaving [0, 1].
      return shape.base_m + shape.height_m * n * n * (3 - 2 * n);
    }
    case SyntheticKind::flat:
    case SyntheticKind::none:
      break;
  }
  return shape.base_m;
}

SourceError synthetic_error(const HeightGrid& grid, SyntheticKind kind, const SyntheticSpec& shape,
                            const WorldFrame& frame) {
  SourceErrors errors(grid);
  const AnchorMap map(frame, shape.anchor);
  std::vector<WorldPoint> points;
  for (const glm::dvec2& p : errors.places(grid)) {
    const glm::dvec2 q = map.exact(p);
    points.push_back(
        {glm::dvec3(p.x, synthetic_height_m(kind, shape, q.x, q.y) + frame.datum_y_m(p.x, p.y), p.y)});
  }
  errors.compare(points, grid);
  return errors.summary(grid);
}

void fill_synthetic(HeightGrid& grid, SyntheticKind kind, const SyntheticSpec& shape,
                    const WorldFrame& frame) {
  check(kind, shape);
  const AnchorMap map(frame, shape.anchor);
  for_each_row(grid.nz, [&](int j) {
    auto row = map.row(grid.node_z_m(j));
    for (int i = 0; i < grid.nx; ++i) {
      const double x_m = grid.node_x_m(i);
      const double z_m = grid.node_z_m(j);
      // Tangent-plane y is ellipsoid_y, the lift takes (1 - 1/k) of it away: 1/k stays.
      const double datum_m = frame.datum_y_m(x_m, z_m);
      const glm::dvec2 at = row.at(x_m);
      grid.y_m[grid.index(i, j)] = static_cast<float>(synthetic_height_m(kind, shape, at.x, at.y) + datum_m);
    }
  });
}

}  // namespace obliq
