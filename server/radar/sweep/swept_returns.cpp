#include "server/radar/sweep/swept_returns.h"

#include <algorithm>
#include <cmath>

#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

constexpr double kFarBelow = -1e9;
constexpr double kNowhere = -1e9;

// In units of ask().
constexpr int kARoof = 10;
constexpr int kAStretch = 4;

double range_at(double distance_m, double height_m) {
  return std::sqrt(distance_m * distance_m + height_m * height_m);
}

}  // namespace

SweptReturns::SweptReturns(const ScenePlan& plan, int planes)
    : plan_(plan),
      runs_(GroundEchoes::kRuns, Run(plan.bins())),
      buildings_(static_cast<std::size_t>(planes * kWedgeAzimuthBins)),
      most_(static_cast<std::size_t>(kWedgeAzimuthBins * plan.bins().n_range)) {}

void SweptReturns::start(std::size_t run, int plane, int profile, SinCos bearing) {
  Run& begun = runs_[run];
  begun.begun = true;
  begun.next = 0;
  begun.ground = {1, kFarBelow};
  begun.roof_slope = kFarBelow;
  begun.ground_end_m = begun.roof_end_m = kNowhere;
  begun.count.restart();
  std::vector<RoofSpan>& roofs = begun.roofs;
  roofs.clear();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  for (const std::uint32_t building : buildings(plane, profile)) {
    ask(kARoof);
    add_roof_spans(plan_.scene().world().buildings, building, antenna.x, antenna.z, bearing.sin, bearing.cos,
                   roofs);
  }
  if (!roofs.empty()) roofs = disjoint_roofs(roofs);
}

bool SweptReturns::any_roofs() const {
  return std::ranges::any_of(runs_, [](const Run& run) { return run.begun && !run.roofs.empty(); });
}

void SweptReturns::add(const GroundStretches& stretches) {
  ask(kAStretch * stretches.n);
  for (int k = 0; k < stretches.n; ++k) {
    Run& run = runs_[stretches.run(k)];
    const auto bin = static_cast<int>(stretches.bin(k));
    double from_m = static_cast<double>(stretches.from_m[k]);
    const double end_m = static_cast<double>(stretches.end_m[k]);
    if (from_m - run.ground_end_m > static_cast<double>(GroundStretches::kGap_m)) run.count.leave();
    run.ground_end_m = end_m;
    if (run.roofs.empty()) {
      run.count.enter(bin);
      continue;
    }
    Point from{from_m, static_cast<double>(stretches.from_h_m[k])};
    const Point end{end_m, static_cast<double>(stretches.end_h_m[k])};
    while (run.next < run.roofs.size() && run.roofs[run.next].near_m < end.d) {
      const RoofSpan& roof = run.roofs[run.next++];
      const bool on_ground = roof.near_m >= from.d;
      if (on_ground) {
        const double part = (roof.near_m - from.d) / (end.d - from.d);
        const Point foot{roof.near_m, from.h + part * (end.h - from.h)};
        see_ground(run, bin, from, foot);
        from = foot;
      }
      see_building(run, roof, on_ground);
    }
    see_ground(run, bin, from, end);
  }
}

void SweptReturns::see_ground(Run& run, int bin, const Point& from, const Point& end) {
  run.ground = end;
  if (!(end.d > from.d)) return;
  if (from.h < run.roof_slope * from.d) run.count.leave();
  if (end.h > run.roof_slope * end.d) run.count.enter(bin);
}

/// on_ground: the ground at its foot is seen, as far as nearer roofs leave it.
void SweptReturns::see_building(Run& run, const RoofSpan& roof, bool on_ground) const {
  if (!(roof.near_m < roof.far_m)) return;
  const double height_m = roof.roof_y_m - plan_.sector().antenna_m.y;
  const double near_m = roof.near_m;
  // Ground nearer than the swath does not come.
  const double base_m = static_cast<double>(plan_.scene().world().buildings.list[roof.building].base_y_m) -
                        plan_.sector().antenna_m.y;
  const double ground_slope = run.ground.h / run.ground.d;
  const double low = std::max({ground_slope, run.roof_slope, near_m > 0 ? base_m / near_m : kFarBelow});
  const double top = near_m > 0 ? height_m / near_m : height_m < 0 ? kFarBelow : -kFarBelow;
  const double back = height_m / roof.far_m;
  const bool on_roof = near_m - run.roof_end_m < kTouching_m;
  if (!on_roof && !(on_ground && ground_slope >= run.roof_slope)) run.count.leave();
  const bool wall = near_m > 0 && roof.wall != kNoFace && top > low;
  if (wall) {
    run.count.enter_at(range_at(near_m, low * near_m));
    if (low < 0 && top > 0) run.count.go_to(near_m);
    run.count.go_to(range_at(near_m, height_m));
  }
  const double from = std::max(low, top);
  const bool seen = height_m < 0 && back > from;
  if (seen) {
    const double from_m = std::max(near_m, height_m / from);
    if (!wall && !on_roof) run.count.leave();
    if (!wall) run.count.enter_at(range_at(from_m, height_m));
    run.count.go_to(range_at(roof.far_m, height_m));
  }
  run.roof_end_m = seen ? roof.far_m : kNowhere;
  run.roof_slope = std::max({run.roof_slope, top, back});
}

void SweptReturns::end_planes() {
  const int n_range = plan_.bins().n_range;
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    Run& run = runs_[k];
    if (!run.begun) continue;
    run.begun = false;
    ask(n_range);
    while (run.next < run.roofs.size()) see_building(run, run.roofs[run.next++], false);
    run.count.raise(most_.data() + k % kWedgeAzimuthBins * static_cast<std::size_t>(n_range));
  }
}

void SweptReturns::write(BinBlock& block) const {
  block.labels.returns.assign(most_.begin(),
                              most_.begin() + static_cast<std::ptrdiff_t>(block.n_azimuth) * block.n_range);
}

}  // namespace obliq
