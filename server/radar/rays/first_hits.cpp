#include "server/radar/rays/first_hits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "server/radar/geometry/silhouettes.h"
#include "server/radar/rays/polar_rays.h"
#include "server/scene/ray_answer.h"
#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

// In units of ask(): a building's bounds, and a ray that goes its own way.
constexpr int kABuilding = 20;
constexpr int kAWalk = 2000;
constexpr auto kPlanes = static_cast<std::size_t>(ProfileRays::kMostProfiles);

}  // namespace

FirstHits::FirstHits(const FramePlan& plan, AzimuthRange range, bool beyond_swath) : plan_(plan) {
  if (plan.scene().rays() == RayMethod::embree || !plan.extent().any) return;
  if (plan.settings().frustum == FrustumKind::polar) {
    polar_.emplace(plan, range);
  } else {
    ground_.emplace(plan, range, beyond_swath);
  }
}

void FirstHits::trace(const RayBatch& rays, RoughHit* hits) {
  by_embree_.fill(false);
  if (polar_) return polar_->trace(rays, hits);
  std::span<const std::uint16_t> left(rays.packet_order.data(), static_cast<std::size_t>(rays.n));
  if (ground_) left = ground_->trace(rays, hits);
  if (left.empty()) return;
  for (const std::uint16_t k : left) by_embree_[k] = true;
  plan_.scene().tracer().trace(plan_.sector().antenna_m, rays.dir_x.data(), rays.dir_y.data(),
                               rays.dir_z.data(), static_cast<int>(left.size()), hits, left.data());
}

PolarFirstHits::PolarFirstHits(const FramePlan& plan, AzimuthRange range)
    : plan_(plan), range_(range), rays_(plan.swept_rays()) {}

void PolarFirstHits::begin() {
  for (const PolarColumn& column : polar_columns(plan_, range_)) {
    if (bearings_.empty()) first_column_ = column.index;
    bearings_.push_back(plan_.sector().world_bearing(column.offset));
  }
  groups_.resize((bearings_.size() + kPlanes - 1) / kPlanes);
  share_out_buildings();
  most_rows_ = std::min(rays_.rays(), std::max(kLeastRows, kMostKept / bearings_.size()));
  fill(slant_range_m_, groups_.size() * kPlanes * most_rows_, 0);
  fill(surface_, slant_range_m_.size(), 0);
}

/// Gives each group its buildings. In doubles until clamped: a narrow column makes numbers that fit no
/// integer.
void PolarFirstHits::share_out_buildings() {
  const Buildings& all = plan_.scene().world().buildings;
  const double width_rad = plan_.sector().width_rad / plan_.settings().pixel_columns;
  const double start_rad = plan_.bins().azimuth_start_rad + first_column_ * width_rad;
  const double last = static_cast<double>(groups_.size()) - 1;
  for (const std::uint32_t b : plan_.buildings_in(range_)) {
    ask(kABuilding);
    const BuildingBounds seen = bounds_of(all, plan_.sector(), b);
    for (int turn = -1; turn <= 1; ++turn) {
      const auto group_at = [&](double offset_rad) {
        return std::floor((offset_rad + turn * 2 * std::numbers::pi - start_rad) / width_rad / kPlanes);
      };
      const double from = group_at(seen.from_rad - kMargin_rad);
      const double to = group_at(seen.to_rad + kMargin_rad);
      if (!(from <= last && to >= 0)) continue;
      const auto end = static_cast<std::size_t>(std::min(last, to));
      ask(4 * (1 + static_cast<std::int64_t>(end - static_cast<std::size_t>(std::max(0.0, from)))));
      for (auto group = static_cast<std::size_t>(std::max(0.0, from)); group <= end; ++group) {
        std::vector<std::uint32_t>& list = groups_[group].buildings;
        if (list.empty() || list.back() != b) list.push_back(b);
      }
    }
  }
}

/// Finds the hits of a group's rays, of the run of rows that holds `row`.
void PolarFirstHits::march(std::size_t number, std::size_t row) {
  Group& group = groups_[number];
  const std::size_t first = row / most_rows_ * most_rows_;
  group.rows = {first, std::min(most_rows_, rays_.rays() - first)};
  const std::size_t column = number * kPlanes;
  const std::size_t n = std::min(kPlanes, bearings_.size() - column);
  const std::size_t at = column * most_rows_;
  rays_.answer(std::span(bearings_).subspan(column, n), group.buildings, group.rows,
               std::span(slant_range_m_).subspan(at, n * group.rows.count),
               std::span(surface_).subspan(at, n * group.rows.count));
}

void PolarFirstHits::trace(const RayBatch& rays, RoughHit* hits) {
  if (bearings_.empty() && rays.n > 0) begin();
  const auto columns = static_cast<std::uint32_t>(plan_.settings().pixel_columns);
  const std::size_t rows = rays_.rays();
  std::uint32_t first_of_row = 0;
  std::size_t row = rows - 1;
  for (std::size_t k = 0; k < static_cast<std::size_t>(rays.n); ++k) {
    // Texture rows run from the top down.
    const std::uint32_t pixel = rays.pixel[k];
    if (pixel - first_of_row >= columns) {
      row = rows - 1 - pixel / columns;
      first_of_row = pixel / columns * columns;
    }
    const std::size_t column = pixel - first_of_row - static_cast<std::uint32_t>(first_column_);
    const Group& group = groups_[column / kPlanes];
    if (row - group.rows.first >= group.rows.count) march(column / kPlanes, row);
    const std::size_t at = column / kPlanes * kPlanes * most_rows_ + column % kPlanes * group.rows.count +
                           row - group.rows.first;
    const std::uint32_t surface = surface_[at];
    hits[k] = surface == ProfileRays::kUnder ? walk(rays, k) : RoughHit{};
    if (surface == ProfileRays::kUnder || surface == ProfileRays::kNothing) continue;
    // As float, like Embree's: refinement then gives the same bits, whichever tracer took the ray.
    hits[k].distance_m = static_cast<float>(slant_range_m_[at]);
    hits[k].kind = surface < ProfileRays::kFace ? RoughHit::Kind::ground : RoughHit::Kind::building;
    if (surface >= ProfileRays::kFace) hits[k].face = surface - ProfileRays::kFace;
  }
}

/// First hit of a ray by a walk of its own.
RoughHit PolarFirstHits::walk(const RayBatch& rays, std::size_t k) const {
  ask(kAWalk);
  const auto found = first_hit(plan_.scene(), plan_.sector().antenna_m,
                               glm::dvec3(rays.dir_x[k], rays.dir_y[k], rays.dir_z[k]));
  RoughHit hit;
  if (!found) return hit;
  hit.distance_m = static_cast<float>(found->slant_range_m);
  hit.kind = found->face == kNoFace ? RoughHit::Kind::ground : RoughHit::Kind::building;
  hit.face = found->face;
  return hit;
}

}  // namespace obliq
