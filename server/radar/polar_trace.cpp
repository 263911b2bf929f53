#include "server/radar/polar_trace.h"

#include <algorithm>

#include "server/radar/polar_columns.h"
#include "server/scene/ray_answer.h"

namespace obliq {

PolarTrace::PolarTrace(const FramePlan& plan, AzimuthRange range)
    : plan_(plan), range_(range), rays_(plan.swept_rays()) {}

void PolarTrace::march() {
  marched_ = true;
  std::vector<SinCos> bearings;
  for (const PolarColumn& column : polar_columns(plan_, range_)) {
    if (bearings.empty()) first_column_ = column.index;
    const glm::dvec3 ahead = plan_.sector().world_from_antenna(column.offset.sin, 0, column.offset.cos);
    bearings.push_back({ahead.x, ahead.z});
  }
  const std::vector<std::uint32_t> buildings = plan_.buildings_in(range_);
  slant_range_m_.resize(bearings.size() * rays_.rays());
  surface_.resize(slant_range_m_.size());
  for (std::size_t first = 0; first < bearings.size(); first += SweptRays::kMostPlanes) {
    const std::size_t n = std::min<std::size_t>(SweptRays::kMostPlanes, bearings.size() - first);
    const std::size_t at = first * rays_.rays();
    rays_.answer(std::span(bearings).subspan(first, n), buildings,
                 std::span(slant_range_m_).subspan(at, n * rays_.rays()),
                 std::span(surface_).subspan(at, n * rays_.rays()));
  }
}

void PolarTrace::trace(const RayBatch& rays, RoughHit* hits) {
  if (!marched_) march();
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
    const std::size_t at = (pixel - first_of_row - static_cast<std::uint32_t>(first_column_)) * rows + row;
    const std::uint32_t surface = surface_[at];
    hits[k] = surface == SweptRays::kUnder ? walk(rays, k) : RoughHit{};
    if (surface == SweptRays::kUnder || surface == SweptRays::kNothing) continue;
    hits[k].distance_m = static_cast<float>(slant_range_m_[at]);
    hits[k].kind = surface < SweptRays::kFace ? RoughHit::Kind::ground : RoughHit::Kind::building;
    if (surface >= SweptRays::kFace) hits[k].triangle = triangle_of(surface - SweptRays::kFace);
  }
}

/// What a ray meets on its own walk.
RoughHit PolarTrace::walk(const RayBatch& rays, std::size_t k) const {
  const auto found = first_hit(plan_.scene(), plan_.sector().antenna_m,
                               glm::dvec3(rays.dir_x[k], rays.dir_y[k], rays.dir_z[k]));
  RoughHit hit;
  if (!found) return hit;
  hit.distance_m = static_cast<float>(found->slant_range_m);
  hit.kind = found->face == kNoFace ? RoughHit::Kind::ground : RoughHit::Kind::building;
  if (found->face != kNoFace) hit.triangle = triangle_of(found->face);
  return hit;
}

/// One of a face's triangles.
std::uint32_t PolarTrace::triangle_of(std::uint32_t face) const {
  const Buildings& all = plan_.scene().world().buildings;
  const Building& building = all.list[all.faces[face].building];
  const auto first = all.triangle_face.begin() + building.first_triangle;
  return static_cast<std::uint32_t>(std::find(first, first + building.n_triangles, face) -
                                    all.triangle_face.begin());
}

}  // namespace obliq
