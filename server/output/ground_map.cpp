#include "server/output/ground_map.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"
#include "terrain/height_grid.h"

namespace obliq {

namespace {

/// Pixels between exactly projected points; between them world coordinates are interpolated bilinearly. Over
/// 1 km the plane's curvature leaves (1 km)^2 / 8 R = 2 cm.
constexpr int kLattice = 16;
/// The antenna is on the map where that makes its area at most so much larger.
constexpr double kMostGrowth = 1.5;

/// Between east and north, and a map's right and ahead.
struct Turn {
  explicit Turn(double up_rad) : sine(std::sin(up_rad)), cosine(std::cos(up_rad)) {}
  MapProjection::Place place(double right, double ahead) const {
    return {right * cosine + ahead * sine, ahead * cosine - right * sine};
  }
  double sine, cosine;
};

struct Bounds {
  double left = HUGE_VAL, right = -HUGE_VAL, bottom = HUGE_VAL, top = -HUGE_VAL;

  void add(const MapProjection::Place& place, const Turn& turn) {
    const double x = place.east_m * turn.cosine - place.north_m * turn.sine;
    const double y = place.east_m * turn.sine + place.north_m * turn.cosine;
    left = std::min(left, x);
    right = std::max(right, x);
    bottom = std::min(bottom, y);
    top = std::max(top, y);
  }
  double area() const { return (right - left) * (top - bottom); }
  double extent() const { return std::max(right - left, top - bottom); }
};

/// Of the sector's corners, of its arcs every two degrees and where they point up, down, left or right.
Bounds sector_bounds(const MapProjection& projection, double up_rad) {
  const MapSector& sector = projection.sector();
  const Turn turn(up_rad);
  Bounds bounds;
  // A swath that does not reach down to the ground is drawn as if the antenna stood on it.
  const bool in_the_air = sector.r_max_m <= projection.antenna_above_m();
  const auto add = [&](double bearing) {
    for (const double r : {sector.r_min_m, sector.r_max_m})
      bounds.add(in_the_air ? MapProjection::Place{r * std::sin(bearing), r * std::cos(bearing)}
                            : projection.place(bearing, r),
                 turn);
  };
  const int steps = static_cast<int>(std::ceil(sector.width_rad / (kPi / 90)));
  for (int i = 0; i <= steps; ++i) add(sector.start_rad + sector.width_rad * i / steps);
  for (double quarter = std::ceil((sector.start_rad - up_rad) / (kPi / 2));
       up_rad + quarter * kPi / 2 <= sector.start_rad + sector.width_rad; ++quarter)
    add(up_rad + quarter * kPi / 2);
  return bounds;
}

/// The bin of a world offset from the antenna. Neighbours in a row of pixels are mostly in the same azimuth
/// bin or the next one, which two products tell; an arc tangent for each pixel would take most of a picture's
/// time.
class BinFinder {
 public:
  BinFinder(const MapProjection& projection, int n_azimuth, int n_range)
      : n_azimuth_(n_azimuth),
        n_range_(n_range),
        sector_(projection.sector()),
        start_rad_(sector_.start_rad + projection.north_rad()),
        width_rad_(sector_.width_rad / n_azimuth),
        ranges_per_m_(n_range / (sector_.r_max_m - sector_.r_min_m)) {
    for (int k = 0; k <= n_azimuth; ++k)
      edges_.push_back({std::sin(start_rad_ + k * width_rad_), std::cos(start_rad_ + k * width_rad_)});
  }

  std::uint32_t find(const glm::dvec3& p) {
    const double r = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    if (!(r >= sector_.r_min_m && r < sector_.r_max_m)) return GroundMap::kOutside;
    if (is_beside(p)) return GroundMap::kOutside;
    const auto azimuth = find_azimuth(p);
    if (azimuth < 0) return GroundMap::kOutside;
    const auto range = std::min(n_range_ - 1, static_cast<int>((r - sector_.r_min_m) * ranges_per_m_));
    return static_cast<std::uint32_t>(azimuth) * static_cast<std::uint32_t>(n_range_) +
           static_cast<std::uint32_t>(range);
  }

  /// The azimuth bin that was found last, where the search for the next begins.
  int last() const { return last_; }
  void begin_at(int azimuth) { last_ = azimuth; }

 private:
  struct Edge {
    double sine, cosine;
    /// Whether a place is clockwise of it, less than half a turn.
    bool before(const glm::dvec3& p) const { return p.x * cosine - p.z * sine >= 0; }
  };

  bool is_beside(const glm::dvec3& p) const {
    if (sector_.all_round()) return false;
    const bool left = !edges_.front().before(p);
    const bool right = edges_.back().before(p);
    return sector_.width_rad <= kPi ? left || right : left && right;
  }

  bool is_in(int azimuth, const glm::dvec3& p) const {
    const auto k = static_cast<std::size_t>(azimuth);
    return edges_[k].before(p) && !edges_[k + 1].before(p);
  }

  int find_azimuth(const glm::dvec3& p) {
    if (width_rad_ < kPi / 2) {
      for (const int near : {last_, last_ + 1, last_ - 1})
        if (near >= 0 && near < n_azimuth_ && is_in(near, p)) return last_ = near;
    }
    double turns = (std::atan2(p.x, p.z) - start_rad_) / (2 * kPi);
    turns -= std::floor(turns);
    const double azimuth = turns * 2 * kPi / width_rad_;
    if (!(azimuth < n_azimuth_)) return -1;
    return last_ = static_cast<int>(azimuth);
  }

  int n_azimuth_;
  int n_range_;
  MapSector sector_;
  double start_rad_;
  double width_rad_;
  double ranges_per_m_;
  std::vector<Edge> edges_;  ///< of the azimuth bins, in the world frame
  int last_ = 0;
};

/// Moves an offset along `up` onto the ground; false where there is none.
bool put_on_ground(const HeightGrid& ground, const glm::dvec3& antenna_m, const glm::dvec3& up,
                   glm::dvec3& p) {
  // The vertical leans by at most a few thousandths, so a height's error shrinks by that with each step.
  constexpr int kSteps = 3;
  for (int step = 0; step < kSteps; ++step) {
    const glm::dvec3 world = antenna_m + p;
    const double y_m = ground.height_at_m(world.x, world.z);
    if (std::isnan(y_m)) return false;
    p += (y_m - world.y) / up.y * up;
  }
  return true;
}

constexpr double kLeast = std::numeric_limits<double>::min();
constexpr double kDb_of_log = 10 / std::numbers::ln10;

}  // namespace

GroundMap map_to_ground(const MapProjection& projection, int n_azimuth, int n_range,
                        const GroundMapRequest& request) {
  Bounds bounds = sector_bounds(projection, request.up_rad);
  const Turn turn(request.up_rad);
  if (request.with_antenna) {
    Bounds larger = bounds;
    larger.add({0, 0}, turn);
    if (larger.area() <= kMostGrowth * bounds.area()) bounds = larger;
  }
  if (!(bounds.extent() > 0 && std::isfinite(bounds.extent())))
    throw InputError(
        "frame descriptor: found a sector that meets no ground at map_reference_height_m; "
        "allowed: one of which a map can be drawn");

  GroundMap map;
  map.up_rad = request.up_rad;
  map.pixel_m = std::max(request.least_pixel_m, bounds.extent() / request.side);
  const auto pixels = [&](double length_m) {
    // A hair less, so that a length of a whole number of pixels is no pixel longer.
    return std::clamp(static_cast<int>(std::ceil(length_m / map.pixel_m - 1e-6)), 1, request.side);
  };
  map.width = pixels(bounds.right - bounds.left);
  map.height = pixels(bounds.top - bounds.bottom);
  map.left_m = bounds.left;
  map.top_m = bounds.top;
  map.bin.resize(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));

  BinFinder finder(projection, n_azimuth, n_range);
  const auto place_of = [&](int column, int row) {
    return turn.place(map.left_m + (column + 0.5) * map.pixel_m, map.top_m - (row + 0.5) * map.pixel_m);
  };
  const int columns = map.width / kLattice + 2;
  std::vector<glm::dvec3> above, below;  // the lattice's rows on both sides of the pixels
  const auto lattice_row = [&](int row) {
    std::vector<glm::dvec3> points;
    for (int i = 0; i < columns; ++i) points.push_back(projection.offset(place_of(i * kLattice, row)));
    return points;
  };
  below = lattice_row(0);
  for (int row0 = 0; row0 < map.height; row0 += kLattice) {
    above = std::move(below);
    below = lattice_row(row0 + kLattice);
    for (int column0 = 0; column0 < map.width; column0 += kLattice) {
      const auto i = static_cast<std::size_t>(column0 / kLattice);
      glm::dvec3 up{0, 1, 0};
      if (request.ground) {
        constexpr double kRise_m = 1000;
        up = (projection.offset(place_of(column0, row0), kRise_m) - above[i]) / kRise_m;
      }
      int first_azimuth = finder.last();
      for (int row = row0; row < std::min(map.height, row0 + kLattice); ++row) {
        finder.begin_at(first_azimuth);  // of the pixel above
        const double v = static_cast<double>(row - row0) / kLattice;
        const glm::dvec3 left = (1 - v) * above[i] + v * below[i];
        const glm::dvec3 step = ((1 - v) * above[i + 1] + v * below[i + 1] - left) / double{kLattice};
        std::uint32_t* out = &map.bin[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width)];
        for (int column = column0; column < std::min(map.width, column0 + kLattice); ++column) {
          glm::dvec3 p = left + step * static_cast<double>(column - column0);
          if (request.ground && !put_on_ground(*request.ground, projection.antenna_m(), up, p)) {
            out[column] = finder.find(p) == GroundMap::kOutside ? GroundMap::kOutside : GroundMap::kNoGround;
          } else {
            out[column] = finder.find(p);
          }
          if (column == column0) first_azimuth = finder.last();
        }
      }
    }
  }
  return map;
}

bool can_be_drawn(const BinBlock& bins) {
  return !bins.iq.empty() || !bins.power_w.empty() || !bins.video8.empty() || !bins.video16.empty();
}

namespace {

/// Of a video's values, on the scale that the descriptor gives.
template <typename Level>
void add_video(const std::vector<Level>& video, const wire::FrameDescriptor& descriptor, BinLevels& levels) {
  const double steps = std::numeric_limits<Level>::max() - 1;
  const double span_db = descriptor.settings().video_span_db();
  for (std::size_t bin = 0; bin < std::min(video.size(), levels.db.size()); ++bin)
    if (video[bin] > 0)
      levels.db[bin] = static_cast<float>(descriptor.video_floor_db() + (video[bin] - 1) * span_db / steps);
}

}  // namespace

BinLevels bin_levels(const wire::FrameDescriptor& descriptor, const BinBlock& bins) {
  BinLevels levels;
  levels.of_video = bins.iq.empty() && bins.power_w.empty();
  levels.of_power = bins.iq.empty();
  levels.unit = levels.of_power ? descriptor.power_unit() : descriptor.unit();
  levels.db.assign(static_cast<std::size_t>(bins.n_azimuth) * static_cast<std::size_t>(bins.n_range),
                   BinLevels::kNoValue);
  if (!can_be_drawn(bins)) return levels;
  if (levels.of_video) {
    if (bins.video16.empty())
      add_video(bins.video8, descriptor, levels);
    else
      add_video(bins.video16, descriptor, levels);
    return levels;
  }
  const bool ideal = is_ideal(descriptor.settings());
  for (std::size_t bin = 0; bin < levels.db.size(); ++bin) {
    if (ideal && !bins.count.empty() && bins.count[bin] == 0) continue;
    const double power = levels.of_power ? bins.power_w[bin] : std::norm(std::complex<double>(bins.iq[bin]));
    if (power >= kLeast && std::isfinite(power))
      levels.db[bin] = static_cast<float>(kDb_of_log * log_of_positive(power));
  }
  return levels;
}

std::uint8_t state_of(const BinBlock& bins, const BinLevels& levels, std::size_t bin) {
  if (!bins.state.empty()) return bins.state[bin];
  return levels.db[bin] == BinLevels::kNoValue ? kUnknownState : static_cast<std::uint8_t>(BinState::sampled);
}

}  // namespace obliq
