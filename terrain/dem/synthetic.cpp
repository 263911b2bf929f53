#include "terrain/dem/synthetic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>
#include <string>

#include "terrain/base/errors.h"
#include "terrain/base/hash.h"
#include "terrain/base/parallel.h"
#include "terrain/base/units.h"
#include "terrain/frames.h"
#include "terrain/world_spec.h"

namespace obliq {
namespace {

/// From a world frame's (x, z) to those of another origin, the anchor of made-up ground, along the ellipsoid:
/// so that the ground stays where it is on the earth when the scene's origin moves. Without an anchor, or
/// with the frame's own origin, the identity, bit for bit. Immutable.
class AnchorMap {
 public:
  AnchorMap(const WorldFrame& frame, const std::optional<LonLat>& anchor);

  glm::dvec2 exact(const glm::dvec2& p) const;

  /// Points of one z, interpolated between exact ones every kStep_m of the frame: off by less than a
  /// millimetre with origins 300 km apart (second derivative distance / R^2, times kStep_m^2 / 8). The same
  /// point gets the same bits whatever is asked before. For one thread.
  class Row {
   public:
    glm::dvec2 at(double x_m);

   private:
    friend class AnchorMap;
    Row(const AnchorMap& map, double z_m);
    glm::dvec2 column(double i) const;

    const AnchorMap& map_;
    double z_m_;
    double first_ = 0;  ///< number of the left exact column
    bool known_ = false;
    glm::dvec2 left_{0.0};
    glm::dvec2 right_{0.0};
  };
  Row row(double z_m) const { return {*this, z_m}; }

 private:
  static constexpr double kStep_m = 256;

  const WorldFrame& frame_;
  std::optional<WorldFrame> anchor_;
};

AnchorMap::AnchorMap(const WorldFrame& frame, const std::optional<LonLat>& anchor) : frame_(frame) {
  if (!anchor) return;
  const double latitude_rad = anchor->latitude_deg * kDegree_rad;
  const double longitude_rad = anchor->longitude_deg * kDegree_rad;
  if (latitude_rad == frame.origin_latitude_rad() && longitude_rad == frame.origin_longitude_rad()) return;
  anchor_.emplace(latitude_rad, longitude_rad, frame.radius_factor());
}

glm::dvec2 AnchorMap::exact(const glm::dvec2& p) const {
  if (!anchor_) return p;
  Geodetic place = frame_.geodetic_from_world({glm::dvec3(p.x, frame_.datum_y_m(p.x, p.y), p.y)});
  place.height_m = 0;
  const WorldPoint there = anchor_->world_from_geodetic(place);
  return {there.m.x, there.m.z};
}

AnchorMap::Row::Row(const AnchorMap& map, double z_m) : map_(map), z_m_(z_m) {}

glm::dvec2 AnchorMap::Row::column(double i) const {
  const double j = std::floor(z_m_ / kStep_m);
  const double t = z_m_ / kStep_m - j;
  const glm::dvec2 low = map_.exact({i * kStep_m, j * kStep_m});
  return low + t * (map_.exact({i * kStep_m, (j + 1) * kStep_m}) - low);
}

glm::dvec2 AnchorMap::Row::at(double x_m) {
  if (!map_.anchor_) return {x_m, z_m_};
  const double i = std::floor(x_m / kStep_m);
  if (!known_ || i != first_) {
    left_ = known_ && i == first_ + 1 ? right_ : column(i);
    right_ = column(i + 1);
    first_ = i;
    known_ = true;
  }
  return left_ + (x_m / kStep_m - i) * (right_ - left_);
}

/// A wall's faces are found on nodes; rounding of sin and cos at 100 km is far below this.
constexpr double kFaceSlack_m = 1e-6;

/// Wavelengths of the hills, from mountain ranges to what the finest usual grid still shows.
constexpr double kLongestWave_m = 16384;
constexpr int kOctaves = 9;

/// Quintic fade: second derivative zero at both ends, so no creases at the lattice (Perlin, "Improving
/// noise", 2002).
double fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

/// Smooth noise in [0, 1] that takes hashed values at whole numbers. It remembers the corners of the cell
/// that was asked for last: neighbouring posts mostly share it. For one thread.
class ValueNoise {
 public:
  explicit ValueNoise(std::uint64_t seed = 0) : seed_(seed) {}

  double at(double u, double v) {
    if (!(u - i_ >= 0 && u - i_ < 1 && v - j_ >= 0 && v - j_ < 1)) enter(std::floor(u), std::floor(v));
    const double s = fade(u - i_);
    const double t = fade(v - j_);
    const double low = corners_[0] + s * (corners_[1] - corners_[0]);
    const double high = corners_[2] + s * (corners_[3] - corners_[2]);
    return low + t * (high - low);
  }

 private:
  void enter(double i, double j) {
    i_ = i;
    j_ = j;
    const auto a = static_cast<std::int64_t>(i);
    const auto b = static_cast<std::int64_t>(j);
    const auto value = [&](int right, int up) { return unit_from_hash(hash_cell(seed_, a + right, b + up)); };
    corners_ = {value(0, 0), value(1, 0), value(0, 1), value(1, 1)};
  }

  std::uint64_t seed_;
  double i_ = std::numeric_limits<double>::quiet_NaN();  // the cell's lower corner
  double j_ = i_;
  std::array<double, 4> corners_{};
};

/// Sum of octaves, each half as long and half as high as the one before: in [0, 1]. For one thread.
class Fractal {
 public:
  explicit Fractal(std::uint64_t seed) {
    for (ValueNoise& octave : octaves_) octave = ValueNoise(seed++);
  }

  double at(double x_m, double z_m) {
    double sum = 0;
    double weight = 1;
    double total = 0;
    double u = x_m / kLongestWave_m;
    double v = z_m / kLongestWave_m;
    for (ValueNoise& octave : octaves_) {
      sum += weight * octave.at(u, v);
      total += weight;
      weight /= 2;
      // Each octave is turned by a 3-4-5 angle, or the lattices' lines would coincide and show.
      const double turned = 2 * (0.8 * u - 0.6 * v);
      v = 2 * (0.6 * u + 0.8 * v);
      u = turned;
    }
    return sum / total;
  }

 private:
  std::array<ValueNoise, kOctaves> octaves_;
};

/// Height of synthetic ground above the datum surface at world (x, z), metres: a function of the place alone,
/// so that the ground is the same whatever part of it is loaded. For one thread.
///
/// ramp: slope times the distance along the bearing. ridge: a triangular crest line across the bearing.
/// wall: a block across the bearing whose near face stands at distance_m and whose far face width_m beyond.
/// cone: apex at the bearing and distance. hills: between base_m and base_m + height_m everywhere.
class SyntheticGround {
 public:
  SyntheticGround(SyntheticKind kind, const SyntheticSpec& spec)
      : kind_(kind),
        spec_(spec),
        sin_b_(std::sin(spec.bearing_deg * kDegree_rad)),
        cos_b_(std::cos(spec.bearing_deg * kDegree_rad)),
        hills_(spec.seed) {}

  double height_m(double x_m, double z_m) {
    const double along_m = x_m * sin_b_ + z_m * cos_b_;
    const double rise_m = spec_.height_m - spec_.base_m;
    switch (kind_) {
      case SyntheticKind::ramp:
        return spec_.base_m + spec_.slope * along_m;
      case SyntheticKind::ridge: {
        const double off = std::abs(along_m - spec_.distance_m) / (spec_.width_m / 2);
        return spec_.base_m + rise_m * std::max(0.0, 1 - off);
      }
      case SyntheticKind::wall: {
        const double behind_m = along_m - spec_.distance_m;
        const bool on = behind_m >= -kFaceSlack_m && behind_m <= spec_.width_m + kFaceSlack_m;
        return on ? spec_.height_m : spec_.base_m;
      }
      case SyntheticKind::cone: {
        const double away_m = std::hypot(x_m - spec_.distance_m * sin_b_, z_m - spec_.distance_m * cos_b_);
        return spec_.base_m + rise_m * std::max(0.0, 1 - away_m / spec_.width_m);
      }
      case SyntheticKind::hills: {
        const double n = hills_.at(x_m, z_m);
        // Averages of octaves crowd around 1/2; the smoothstep spreads them without leaving [0, 1].
        return spec_.base_m + spec_.height_m * n * n * (3 - 2 * n);
      }
      case SyntheticKind::flat:
      case SyntheticKind::none:
        break;
    }
    return spec_.base_m;
  }

 private:
  SyntheticKind kind_;
  const SyntheticSpec& spec_;
  double sin_b_, cos_b_;
  Fractal hills_;
};

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

SourceError synthetic_error(const HeightGrid& grid, SyntheticKind kind, const SyntheticSpec& shape,
                            const WorldFrame& frame) {
  SourceErrors errors(grid);
  const AnchorMap map(frame, shape.anchor);
  SyntheticGround ground(kind, shape);
  std::vector<WorldPoint> points;
  for (const glm::dvec2& p : errors.places(grid)) {
    const glm::dvec2 q = map.exact(p);
    points.push_back({glm::dvec3(p.x, ground.height_m(q.x, q.y) + frame.datum_y_m(p.x, p.y), p.y)});
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
    SyntheticGround ground(kind, shape);
    for (int i = 0; i < grid.nx; ++i) {
      const double x_m = grid.node_x_m(i);
      const double z_m = grid.node_z_m(j);
      // Tangent-plane y is ellipsoid_y, the lift takes (1 - 1/k) of it away: 1/k stays.
      const double datum_m = frame.datum_y_m(x_m, z_m);
      const glm::dvec2 at = row.at(x_m);
      grid.y_m[grid.index(i, j)] = static_cast<float>(ground.height_m(at.x, at.y) + datum_m);
    }
  });
}

}  // namespace obliq
