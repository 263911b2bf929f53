#include "server/radar/visibility/returns.h"

#include <cmath>
#include <utility>

#include "server/radar/profile/line_of_sight.h"
#include "server/radar/profile/stretch_count.h"
#include "server/radar/simd/ground/ground_echoes.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

/// In an azimuth bin: as many as the sweep has as a rule; of cameras one, which costs a fifth of a frame.
int planes_of(const ScenePlan& plan) { return plan.settings().frustum == FrustumKind::sweep ? 2 : 1; }

constexpr double kGap_m = GroundStretches::kGap_m;

// In units of ask().
constexpr int kABuilding = 10;
constexpr int kACell = 10;
constexpr int kCells = 64;  // between two times that are asked

/// Hands what is seen to the count.
struct Sink {
  struct Point {
    double d = HUGE_VAL;
    double h = HUGE_VAL;
    double range() const { return std::sqrt(d * d + h * h); }
  };
  StretchCount& count;
  Point end{};

  void visible(const VisibleSegment& s) {
    const auto at = [&](double t) { return Point{s.ground_range_m(t), s.height_m(t)}; };
    const Point from = at(s.t0);
    if (std::abs(from.d - end.d) > kGap_m || std::abs(from.h - end.h) > kGap_m) count.leave();
    count.enter_at(from.range());
    // Range falls and rises again at the foot of the perpendicular from the antenna.
    const double along = s.d_m * s.rate_d + s.h_m * s.rate_h;
    const double turn = -along / (s.rate_d * s.rate_d + s.rate_h * s.rate_h);
    if (turn > s.t0 && turn < s.t1) count.go_to(at(turn).range());
    end = at(s.t1);
    count.go_to(end.range());
  }
  bool full() const { return false; }
};

}  // namespace

void count_returns(const ScenePlan& plan, int azimuth_bin, std::uint8_t* most) {
  const World& world = plan.scene().world();
  const glm::dvec3& antenna = plan.sector().antenna_m;
  const int planes = planes_of(plan);
  for (int plane = 0; plane < planes; ++plane) {
    const SinCos bearing =
        plan.sector().world_bearing(plan.bins().azimuth_edge_rad(azimuth_bin + (plane + 0.5) / planes));
    std::vector<RoofSpan> spans;
    for (const std::uint32_t building : plan.buildings_in(azimuth_bin)) {
      ask(kABuilding);
      add_roof_spans(world.buildings, building, antenna.x, antenna.z, bearing.sin, bearing.cos, spans);
    }
    LineOfSight sight(world, antenna, bearing, 0, plan.sector().r_max_m, {}, std::move(spans));
    StretchCount count(plan.bins());
    Sink sink{count};
    while (!sight.done()) {
      ask(kACell * kCells);
      sight.advance(sight.at_m() + kCells * world.grid.cell_m, sink);
    }
    count.raise(most);
  }
}

}  // namespace obliq
