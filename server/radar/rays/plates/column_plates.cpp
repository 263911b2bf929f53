// Plates of the polar frustum. A column of pixels is one vertical plane and its rays come in rising
// elevation: what lies between two neighbouring rays is walked from both of their hits, and belongs to the
// lower or the upper pixel by its elevation. Where the surface breaks off, the walk from the nearer hit says
// at which elevation.
#include "server/radar/rays/plates/column_plates.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "server/radar/profile/local_sight.h"
#include "server/radar/simd/exact_math.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kRun = 4096;  // rows between two times that are asked
// In units of ask(): a short walk with its samples, and a building on a profile.
constexpr int kAPlate = 60;
constexpr int kABuilding = 10;
}  // namespace

ColumnPlates::ColumnPlates(const FramePlan& plan)
    : plan_(plan),
      rows_(static_cast<int>(plan.polar().ray.size())),
      surface_(plan.scene().world(), plan.sector().antenna_m) {
  for (const SinCos& edge : plan.polar().edge) {
    if (edge_slope_.size() % kRun == 0) ask(2 * kRun);
    edge_slope_.push_back(edge.cos > 0 ? edge.sin / edge.cos : edge.sin * kInfinity);
  }
}

ColumnPlates::Column& ColumnPlates::column(const RayBatch& rays, std::size_t k) {
  const int number =
      static_cast<int>(rays.pixel[k] % static_cast<std::uint32_t>(plan_.settings().pixel_columns));
  if (columns_.empty()) first_column_ = number;
  // The wedge's columns are neighbours, and its rows run back and forth.
  while (number < first_column_) {
    columns_.emplace_front();
    --first_column_;
  }
  const auto at = static_cast<std::size_t>(number - first_column_);
  while (columns_.size() <= at) columns_.emplace_back();
  Column& found = columns_[at];
  if (!found.begun) {
    found.begun = true;
    found.azimuth_bin = rays.azimuth_bin[k];
    const double offset = plan_.bins().azimuth_start_rad +
                          (number + 0.5) * plan_.sector().width_rad / plan_.settings().pixel_columns;
    const SinCos at_offset = sincos_turns(offset / (2 * std::numbers::pi));
    const glm::dvec3 ahead = plan_.sector().world_from_antenna(at_offset.sin, 0, at_offset.cos);
    found.sin_bearing = ahead.x;
    found.cos_bearing = ahead.z;
    const glm::dvec3& antenna = plan_.sector().antenna_m;
    ask(kABuilding * static_cast<std::int64_t>(plan_.buildings_in(found.azimuth_bin).size()));
    for (const std::uint32_t b : plan_.buildings_in(found.azimuth_bin))
      add_roof_spans(plan_.scene().world().buildings, b, antenna.x, antenna.z, ahead.x, ahead.z, found.roofs);
    found.roofs = disjoint_roofs(found.roofs);
    found.buildings = ColumnBuildings(plan_, found.azimuth_bin, ahead.x, ahead.z,
                                      plan_.sector().width_rad / plan_.settings().pixel_columns);
  }
  return found;
}

int ColumnPlates::spread(const RayBatch& rays, const HitBatch& hits, int first, SampleBatch& /*samples*/,
                         std::vector<Sample>& waiting) {
  for (; first < rays.n && waiting.size() < kBatch; ++first)
    take(rays, hits, static_cast<std::size_t>(first), waiting);
  return first;
}

void ColumnPlates::take(const RayBatch& rays, const HitBatch& hits, std::size_t k,
                        std::vector<Sample>& samples) {
  ask(kAPlate);
  Column& here = column(rays, k);
  surface_.aim(here.sin_bearing, here.cos_bearing, here.roofs);
  Pixel& next = next_;
  next.hit = false;
  next.plate.clear();
  next.row = rows_ - 1 -
             static_cast<int>(rays.pixel[k] / static_cast<std::uint32_t>(plan_.settings().pixel_columns));
  if (hits.is_hit(k)) {
    next.hit = true;
    next.nearest = sample_at_hit(plan_.bins(), rays, hits, k);
    const double range_m = next.nearest.slant_range_m;
    const double ground = std::sqrt(rays.dir_x[k] * rays.dir_x[k] + rays.dir_z[k] * rays.dir_z[k]);
    next.point = {range_m * ground, range_m * rays.dir_y[k], rays.dir_y[k] / ground};
  }
  const double edge = edge_slope_[static_cast<std::size_t>(next.row)];
  Pixel& last = here.last;
  const bool neighbours = last.row == next.row - 1;
  if (neighbours && last.hit && next.hit) {
    fill_between(here, last, next, edge);
    close(here, samples);
  } else {
    close_upwards(here, samples);
    if (next.hit) {
      visible_.clear();
      walk_in(surface_, next.point, edge, 0, visible_);
      for (const SurfaceSegment& segment : visible_) next.plate.add(plan_.bins(), segment);
    }
  }
  std::swap(last, next);
}

/// What is visible between two neighbouring rays: in the column's own plane, or, where buildings stand, in a
/// plane for each stretch of the column between their corners.
void ColumnPlates::fill_between(const Column& column, Pixel& below, Pixel& above, double edge_slope) {
  column.buildings.sub_columns_between(below.point.slope, above.point.slope, plan_.bins().range_spacing_m,
                                       sub_columns_);
  if (sub_columns_.empty()) {
    walk_between(below.point, above.point, above.point.d_m, 1, edge_slope, below.plate, above.plate);
    return;
  }
  const Buildings& all = plan_.scene().world().buildings;
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  for (const SubColumn& sub_column : sub_columns_) {
    ask(kAPlate + kABuilding * static_cast<std::int64_t>(column.buildings.between().size()));
    sub_column_roofs_.clear();
    for (const std::uint32_t b : column.buildings.between())
      add_roof_spans(all, b, antenna.x, antenna.z, sub_column.sin_bearing, sub_column.cos_bearing,
                     sub_column_roofs_);
    sub_column_roofs_ = disjoint_roofs(sub_column_roofs_);
    surface_.aim(sub_column.sin_bearing, sub_column.cos_bearing, sub_column_roofs_);
    // The building may stand nearer than what the lower ray hit beside it.
    SightPoint from = below.point;
    if (column.buildings.nearest_between_m() < from.d_m) {
      from.d_m = column.buildings.nearest_between_m();
      from.h_m = from.slope * from.d_m;
    }
    // What the upper ray hit need not be there, so the walk may have to go beyond it.
    walk_between(from, above.point, kInfinity, sub_column.weight, edge_slope, below.plate, above.plate);
  }
  surface_.aim(column.sin_bearing, column.cos_bearing, column.roofs);
}

void ColumnPlates::walk_between(const SightPoint& from, const SightPoint& to, double to_d_m, double weight,
                                double edge_slope, Plate& below, Plate& above) {
  visible_.clear();
  const double seen_to = walk_out(surface_, from, to.slope, to_d_m, visible_);
  if (seen_to < to.slope) walk_in(surface_, to, seen_to, from.d_m, visible_);
  for (const SurfaceSegment& segment : visible_) share_out(segment, weight, edge_slope, below, above);
}

/// Splits a segment at the elevation between two pixels.
void ColumnPlates::share_out(const SurfaceSegment& segment, double weight, double edge_slope, Plate& below,
                             Plate& above) const {
  const double low = segment.near_slope;
  const double high = segment.far_slope;
  if (high <= edge_slope) {
    below.add(plan_.bins(), segment, weight);
  } else if (low >= edge_slope) {
    above.add(plan_.bins(), segment, weight);
  } else {
    below.add(plan_.bins(), segment.between_slopes(low, edge_slope), weight);
    above.add(plan_.bins(), segment.between_slopes(edge_slope, high), weight);
  }
}

/// No hit in the row above: the last pixel ends at its upper edge or where the surface breaks off.
void ColumnPlates::close_upwards(Column& column, std::vector<Sample>& samples) {
  if (column.last.hit) {
    visible_.clear();
    walk_out(surface_, column.last.point, edge_slope_[static_cast<std::size_t>(column.last.row) + 1],
             kInfinity, visible_);
    for (const SurfaceSegment& segment : visible_) column.last.plate.add(plan_.bins(), segment);
  }
  close(column, samples);
}

void ColumnPlates::close(Column& column, std::vector<Sample>& samples) {
  Pixel& pixel = column.last;
  if (!pixel.hit) return;
  emit_plate(plan_, pixel.plate, pixel.nearest, column.sin_bearing, column.cos_bearing, samples);
  pixel.hit = false;
}

void ColumnPlates::finish(std::vector<Sample>& samples) {
  for (Column& column : columns_) {
    if (!column.begun) continue;
    ask(kAPlate);
    surface_.aim(column.sin_bearing, column.cos_bearing, column.roofs);
    close_upwards(column, samples);
  }
}

}  // namespace obliq
