#include "server/radar/sweep/sweep_column.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// A corner makes a cut when both sides of it keep at least this share of the column or of the building,
/// whichever is less: a strand sees one wall, and their number stays bounded.
constexpr std::int64_t kColumnShare = 16;
constexpr std::int64_t kBuildingShare = 64;

// In units of ask(): a turn of a silhouette, a plane with its horizon, a look at an obstacle, a cell with its
// samples.
constexpr int kATurn = 4;
constexpr int kAPlane = 100;
constexpr int kALook = 20;
constexpr int kACell = 20;

/// How often bearings in whose middle a building is only just hidden are halved to look for it.
constexpr int kHalvings = 4;

bool overlap(TickRange a, TickRange b) { return a.from < b.to && b.from < a.to; }

}  // namespace

SweepColumn::SweepColumn(const ScenePlan& plan, int azimuth_bin, double start_rad, double width_rad)
    : plan_(plan),
      azimuth_bin_(azimuth_bin),
      start_rad_(start_rad),
      tick_rad_(width_rad / static_cast<double>(kTicks)),
      ridge_(plan.scene(), plan.sector().antenna_m, plan.sector().world_bearing(start_rad + 0.5 * width_rad),
             0.5 * width_rad, plan.building_reach_m()) {}

PlaneShare SweepColumn::share_of(TickRange ticks, SinCos bearing) const {
  return {azimuth_bin_, offset_rad(ticks), static_cast<double>(ticks.size()) * tick_rad_, bearing};
}

void SweepColumn::start(const std::vector<Silhouette>& silhouettes, SegmentSampler& sampler) {
  find_obstacles(silhouettes);
  for (std::size_t k = 0; k < obstacles_.size(); ++k) add_obstacle(k, sampler);
  advance(kInfinity, sampler);
  for (const Strand& strand : active_) finish(strand, kInfinity);
  active_.clear();
  plan_base();
}

/// The buildings that overlap the column, by distance.
void SweepColumn::find_obstacles(const std::vector<Silhouette>& silhouettes) {
  for (const Silhouette& s : silhouettes) {
    ask(kATurn * 3);
    for (int turn = -1; turn <= 1; ++turn) {
      const double left_rad = start_rad_ - turn * 2 * kPi;
      if (s.to_rad < left_rad - kMargin_rad ||
          s.from_rad > left_rad + static_cast<double>(kTicks) * tick_rad_ + kMargin_rad)
        continue;
      const auto tick = [&](double bearing_rad) {
        const double at = (bearing_rad + turn * 2 * kPi - start_rad_) / tick_rad_;
        return static_cast<std::int64_t>(std::clamp(at, -1.0, static_cast<double>(kTicks) + 1));
      };
      Obstacle obstacle{};
      obstacle.building = s.building;
      obstacle.near_m = s.near_m;
      obstacle.far_m = s.far_m;
      obstacle.slope = s.top_slope;
      obstacle.ticks = {std::max<std::int64_t>(0, tick(s.from_rad)), std::min(kTicks, tick(s.to_rad))};
      if (!(tick(s.to_rad) >= 0 && obstacle.ticks.from < kTicks)) continue;
      obstacle.ticks.to = std::max(obstacle.ticks.to, obstacle.ticks.from + 1);
      const std::int64_t apart =
          std::max<std::int64_t>(1, std::min(kTicks / kColumnShare, obstacle.ticks.size() / kBuildingShare));
      obstacle.cuts.push_back(obstacle.ticks.from);
      for (const double corner : s.corners_rad) {
        const std::int64_t cut = tick(corner);
        if (cut - obstacle.cuts.back() >= apart && obstacle.ticks.to - cut >= apart)
          obstacle.cuts.push_back(cut);
      }
      obstacle.cuts.push_back(obstacle.ticks.to);
      obstacles_.push_back(std::move(obstacle));
    }
  }
  std::sort(obstacles_.begin(), obstacles_.end(), [](const Obstacle& a, const Obstacle& b) {
    if (a.near_m != b.near_m) return a.near_m < b.near_m;
    return a.building != b.building ? a.building < b.building : a.ticks.from < b.ticks.from;
  });
  double far_m = 0;
  double slope = -kInfinity;
  for (Obstacle& o : obstacles_) {
    o.all_far_m = far_m = std::max(far_m, o.far_m);
    o.all_slope = slope = std::max(slope, o.slope);
  }
}

/// A plane at the centre of some bearings that starts at from_m with the exact horizon of all that is nearer
/// on it: the ground, and the roofs of the first n obstacles.
LineOfSight SweepColumn::plane_at(TickRange ticks, double from_m, std::size_t n_obstacles) {
  ++planes_;
  const World& world = plan_.scene().world();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const SinCos bearing = plan_.sector().world_bearing(offset_rad(ticks));
  Horizon<double> horizon = ground_horizon(plan_.scene(), ridge_, antenna, bearing, from_m);
  const std::int64_t centre = ticks.from + ticks.size() / 2;
  spans_.clear();
  ask(kAPlane + static_cast<std::int64_t>(n_obstacles));
  for (std::size_t k = n_obstacles; k-- > 0;) {
    const Obstacle& o = obstacles_[k];
    // Seen from above, most roofs that end before the plane begins lie below the ground's horizon.
    if (o.all_far_m <= from_m && o.all_slope * horizon.d_m < horizon.h_m) break;
    if (!(centre >= o.ticks.from && centre <= o.ticks.to)) continue;
    if (o.far_m <= from_m && o.slope * horizon.d_m < horizon.h_m) continue;
    add_roof_spans(world.buildings, o.building, antenna.x, antenna.z, bearing.sin, bearing.cos, spans_);
  }
  for (const RoofSpan& span : spans_) {
    if (!(span.near_m < from_m)) continue;
    const double height = span.roof_y_m - antenna.y;
    horizon.raise(span.near_m, height, true);
    horizon.raise(std::min(span.far_m, from_m), height, true);
  }
  return LineOfSight(world, antenna, bearing, from_m, plan_.sector().r_max_m, horizon, spans_);
}

/// Whether an obstacle ahead of a plane stands above its horizon, or would if the horizon were lower by no
/// more than twice the width that the plane stands for: a ridge falls by that much within it where it is as
/// steep as ridges get. Leaves the obstacle's footprints in spans_.
SweepColumn::Look SweepColumn::look(const LineOfSight& plane, std::size_t obstacle, double width_rad) {
  const World& world = plan_.scene().world();
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  const std::uint32_t building = obstacles_[obstacle].building;
  spans_.clear();
  ask(kALook + static_cast<std::int64_t>(plane.spans().size()));
  std::copy_if(plane.spans().begin(), plane.spans().end(), std::back_inserter(spans_),
               [&](const RoofSpan& span) { return span.building == building; });
  if (spans_.empty())
    add_roof_spans(world.buildings, building, antenna.x, antenna.z, plane.bearing().sin, plane.bearing().cos,
                   spans_);
  Look result = Look::hidden;
  for (const RoofSpan& span : spans_) {
    if (plane.covers(span)) continue;
    Horizon<double> horizon = plane.horizon();
    plane.raise_by_roofs(horizon, span);
    const double height = span.roof_y_m - antenna.y;
    if (span.near_m <= 0 || !horizon.hides(span.near_m, height) || !horizon.hides(span.far_m, height))
      return Look::shows;
    const double lower = height + 2 * width_rad * span.far_m;
    if (!horizon.hides(span.near_m, lower) || !horizon.hides(span.far_m, lower)) result = Look::nearly;
  }
  return result;
}

/// A fresh strand over some bearings of an obstacle if it shows in their middle, or over parts of them.
void SweepColumn::consider(TickRange ticks, std::size_t obstacle, int halvings, std::vector<Strand>& fresh) {
  const double near_m = obstacles_[obstacle].near_m;
  LineOfSight plane = plane_at(ticks, near_m, obstacle + 1);
  const Look seen = look(plane, obstacle, static_cast<double>(ticks.size()) * tick_rad_);
  if (seen == Look::shows) {
    fresh.push_back({ticks, near_m, std::move(plane)});
  } else if (seen == Look::nearly && halvings > 0 && ticks.size() > 1) {
    const std::int64_t middle = ticks.from + ticks.size() / 2;
    consider({ticks.from, middle}, obstacle, halvings - 1, fresh);
    consider({middle, ticks.to}, obstacle, halvings - 1, fresh);
  }
}

/// Gives an obstacle strands where it shows: new ones, or parts of those that are already there.
void SweepColumn::add_obstacle(std::size_t index, SegmentSampler& sampler) {
  const Obstacle& o = obstacles_[index];
  advance(o.near_m, sampler);
  std::vector<Strand> fresh;
  for (std::size_t c = 0; c + 1 < o.cuts.size(); ++c) {
    const TickRange part{o.cuts[c], o.cuts[c + 1]};
    std::int64_t at = part.from;
    for (Strand& strand : active_) {
      if (!overlap(strand.ticks, part)) continue;
      const TickRange both{std::max(strand.ticks.from, part.from), std::min(strand.ticks.to, part.to)};
      if (at < both.from) consider({at, both.from}, index, kHalvings, fresh);
      if (both.from == strand.ticks.from && both.to == strand.ticks.to) {
        const double width_rad = static_cast<double>(both.size()) * tick_rad_;
        const Look seen = look(strand.plane, index, width_rad);
        if (seen == Look::shows) strand.plane.add(spans_);
        if (seen == Look::nearly) consider(both, index, kHalvings, fresh);
      } else {
        consider(both, index, kHalvings, fresh);
      }
      at = both.to;
    }
    if (at < part.to) consider({at, part.to}, index, kHalvings, fresh);
  }
  if (fresh.empty()) return;
  // What the fresh strands leave of the old ones goes on as strands with planes of their own.
  std::vector<Strand> kept;
  for (Strand& strand : active_) {
    const bool touched = std::any_of(fresh.begin(), fresh.end(),
                                     [&](const Strand& f) { return overlap(f.ticks, strand.ticks); });
    if (!touched) {
      kept.push_back(std::move(strand));
      continue;
    }
    march(strand, o.near_m, GroundWalk::Last::cut, sampler);
    finish(strand, o.near_m);
    std::int64_t at = strand.ticks.from;
    for (const Strand& f : fresh) {
      if (!overlap(f.ticks, strand.ticks)) continue;
      if (at < f.ticks.from) {
        const TickRange rest{at, f.ticks.from};
        kept.push_back({rest, o.near_m, plane_at(rest, o.near_m, index)});
      }
      at = f.ticks.to;
    }
    if (at < strand.ticks.to) {
      const TickRange rest{at, strand.ticks.to};
      kept.push_back({rest, o.near_m, plane_at(rest, o.near_m, index)});
    }
  }
  for (Strand& strand : fresh) kept.push_back(std::move(strand));
  std::sort(kept.begin(), kept.end(),
            [](const Strand& a, const Strand& b) { return a.ticks.from < b.ticks.from; });
  active_ = std::move(kept);
}

/// Marches every active strand up to the cell that holds a distance; those that come out of the shadow give
/// their bearings back.
void SweepColumn::advance(double to_m, SegmentSampler& sampler) {
  std::erase_if(active_, [&](Strand& strand) {
    march(strand, to_m, GroundWalk::Last::whole, sampler);
    if (!strand.plane.out_of_shadow()) return false;
    finish(strand, strand.plane.at_m());
    return true;
  });
}

void SweepColumn::march(Strand& strand, double to_m, GroundWalk::Last last, SegmentSampler& sampler) {
  const double from_m = strand.plane.at_m();
  struct Sink {
    SegmentSampler& sampler;
    const LineOfSight& plane;
    void visible(const VisibleSegment& segment) { sampler.visible(segment); }
    bool full() const { return plane.out_of_shadow(); }
  } sink{sampler, strand.plane};
  sampler.set(share_of(strand.ticks, strand.plane.bearing()));
  strand.plane.advance(to_m, sink, last);
  ask(kACell *
      static_cast<std::int64_t>(1 + (strand.plane.at_m() - from_m) / plan_.scene().world().grid.cell_m));
}

void SweepColumn::finish(const Strand& strand, double at_m) {
  if (at_m > strand.from_m) records_.push_back({strand.ticks, strand.from_m, at_m});
}

void SweepColumn::plan_base() {
  ++planes_;
  struct Change {
    double at_m;
    std::int64_t ticks;
  };
  std::vector<Change> changes;
  for (const StrandRecord& strand : records_) {
    changes.push_back({strand.from_m, -strand.ticks.size()});
    if (strand.to_m < kInfinity) changes.push_back({strand.to_m, strand.ticks.size()});
  }
  std::sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
    return a.at_m != b.at_m ? a.at_m < b.at_m : a.ticks < b.ticks;
  });
  base_.plane = share_of({0, kTicks}, plan_.sector().world_bearing(offset_rad({0, kTicks})));
  std::int64_t ticks = kTicks;
  for (const Change& change : changes) {
    base_.to_m.push_back(change.at_m);
    base_.width_rad.push_back(static_cast<double>(ticks) * tick_rad_);
    ticks += change.ticks;
  }
  base_.to_m.push_back(kInfinity);
  base_.width_rad.push_back(static_cast<double>(ticks) * tick_rad_);
}

}  // namespace obliq
