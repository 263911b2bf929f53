#include "server/radar/visibility/returns.h"

#include <algorithm>
#include <cmath>

#include "server/radar/profile/line_of_sight.h"
#include "server/radar/simd/ground_echoes.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

constexpr int kPlanes = 2;

// In units of ask().
constexpr int kABuilding = 10;
constexpr int kACell = 10;
constexpr int kCells = 64;  // between two times that are asked

/// Follows the visible surface of one plane outwards, and counts how often it comes into each range bin.
class Stretches {
 public:
  explicit Stretches(const BinGrid& bins) : bins_(bins), count_(static_cast<std::size_t>(bins.n_range)) {}

  void visible(const VisibleSegment& s) {
    const Point from{s.ground_range_m(s.t0), s.height_m(s.t0)};
    const Point to{s.ground_range_m(s.t1), s.height_m(s.t1)};
    if (std::abs(from.d - end_.d) > GroundStretches::kGap_m ||
        std::abs(from.h - end_.h) > GroundStretches::kGap_m)
      bin_ = kNone;
    enter(bin_at(from.range()));
    // Range falls and rises again at the foot of the perpendicular from the antenna.
    const double along = s.d_m * s.rate_d + s.h_m * s.rate_h;
    const double turn = -along / (s.rate_d * s.rate_d + s.rate_h * s.rate_h);
    if (turn > s.t0 && turn < s.t1) go_to(Point{s.ground_range_m(turn), s.height_m(turn)}.range());
    go_to(to.range());
    end_ = to;
  }
  bool full() const { return false; }

  const std::vector<std::uint8_t>& count() const { return count_; }

 private:
  static constexpr int kNone = -2;
  struct Point {
    double d = HUGE_VAL;
    double h = HUGE_VAL;
    double range() const { return std::sqrt(d * d + h * h); }
  };

  /// -1: nearer than the swath, n_range: beyond it.
  int bin_at(double range_m) const {
    const double at = std::floor((range_m - bins_.r_min_m) / bins_.range_spacing_m);
    return static_cast<int>(std::clamp(at, -1.0, static_cast<double>(bins_.n_range)));
  }
  /// Passes all ranges on the way to one.
  void go_to(double range_m) {
    for (const int last = bin_at(range_m); bin_ != last;) enter(bin_ < last ? bin_ + 1 : bin_ - 1);
  }
  void enter(int bin) {
    if (bin == bin_) return;
    bin_ = bin;
    if (bin < 0 || bin >= bins_.n_range) return;
    std::uint8_t& count = count_[static_cast<std::size_t>(bin)];
    if (count < 255) ++count;
  }

  const BinGrid& bins_;
  std::vector<std::uint8_t> count_;
  Point end_;
  int bin_ = kNone;  // that the surface is in
};

}  // namespace

std::vector<std::uint8_t> count_returns(const ScenePlan& plan, int azimuth_bin) {
  const World& world = plan.scene().world();
  const glm::dvec3& antenna = plan.sector().antenna_m;
  std::vector<std::uint8_t> most(static_cast<std::size_t>(plan.bins().n_range));
  for (int plane = 0; plane < kPlanes; ++plane) {
    const SinCos bearing =
        plan.sector().world_bearing(plan.bins().azimuth_edge_rad(azimuth_bin + (plane + 0.5) / kPlanes));
    std::vector<RoofSpan> spans;
    for (const std::uint32_t building : plan.buildings_in(azimuth_bin)) {
      ask(kABuilding);
      add_roof_spans(world.buildings, building, antenna.x, antenna.z, bearing.sin, bearing.cos, spans);
    }
    LineOfSight sight(world, antenna, bearing, 0, plan.sector().r_max_m, {}, std::move(spans));
    Stretches stretches(plan.bins());
    while (!sight.done()) {
      ask(kACell * kCells);
      sight.advance(sight.at_m() + kCells * world.grid.cell_m, stretches);
    }
    for (std::size_t bin = 0; bin < most.size(); ++bin)
      most[bin] = std::max(most[bin], stretches.count()[bin]);
  }
  return most;
}

}  // namespace obliq
