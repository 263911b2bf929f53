#include "server/radar/ray_samples.h"

#include <cmath>

#include "server/scene/embree_tracer.h"

namespace obliq {

RaySamples::RaySamples(const FramePlan& plan, AzimuthRange range, SampleTap* tap)
    : plan_(plan), tap_(tap), source_(make_ray_source(plan, range)) {}

bool RaySamples::next(SampleBatch& samples, FrameStats& stats) {
  samples.n = 0;
  if (!source_->next(rays_)) return false;
  stats.rays += static_cast<std::uint64_t>(rays_.n);
  plan_.scene().tracer().trace(plan_.sector().antenna_m, rays_.dir_x.data(), rays_.dir_y.data(),
                               rays_.dir_z.data(), rays_.n, rough_.data());
  refine(samples, stats);
  return true;
}

/// Re-intersects rough hits in double and turns them into samples.
void RaySamples::refine(SampleBatch& samples, FrameStats& stats) {
  const World& world = plan_.scene().world();
  const Sector& sector = plan_.sector();
  for (int ray = 0; ray < rays_.n; ++ray) {
    const auto k = static_cast<std::size_t>(ray);
    if (rough_[k].kind == RoughHit::Kind::none) continue;
    const glm::dvec3 direction(rays_.dir_x[k], rays_.dir_y[k], rays_.dir_z[k]);
    const auto hit = refine_hit(world, sector.antenna_m, direction, rough_[k]);
    if (!hit) {
      ++stats.rejected;
      continue;
    }
    ++stats.hits;
    const auto s = static_cast<std::size_t>(samples.n++);
    samples.azimuth_bin[s] = rays_.azimuth_bin[k];
    samples.slant_range_m[s] = hit->slant_range_m;
    samples.solid_angle_sr[s] = rays_.solid_angle_sr[k];
    samples.cos_incidence[s] = hit->cos_incidence;
    samples.azimuth_offset_rad[s] = plan_.bins().azimuth_edge_rad(rays_.azimuth_bin[k] + 0.5);
    samples.sin_elevation[s] = direction.y;
    samples.x_m[s] = hit->position_m.x;
    samples.z_m[s] = hit->position_m.z;
    samples.face[s] = hit->face;
    samples.material[s] = hit->material;
    if (tap_) {
      const double right = direction.x * sector.cos_bearing - direction.z * sector.sin_bearing;
      const double ahead = direction.x * sector.sin_bearing + direction.z * sector.cos_bearing;
      tap_->on_hit(rays_.pixel[k], std::atan2(right, ahead), *hit);
    }
  }
}

}  // namespace obliq
