#include "server/radar/ray_samples.h"

#include <algorithm>
#include <cmath>

#include "server/radar/wedge_profile.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/ray_answer.h"

namespace obliq {

RaySamples::RaySamples(const FramePlan& plan, AzimuthRange range, SampleTap* tap, WedgeProfile* profile)
    : plan_(plan), tap_(tap), source_(make_ray_source(plan, range)) {
  if (plan.settings().plates == PlateKind::nearest) return;
  if (!profile) own_profile_ = std::make_unique<WedgeProfile>(plan, range);
  spreader_ = make_plate_spreader(plan, range, profile ? *profile : *own_profile_);
}

RaySamples::~RaySamples() = default;

bool RaySamples::next(SampleBatch& samples, FrameStats& stats) {
  samples.n = 0;
  if (!spreader_) {
    if (!trace(stats)) return false;
    take_nearest(samples, stats);
    return true;
  }
  if (!finished_ && spread_.size() - unloaded_ < kBatch) {
    if (trace(stats)) {
      take_spread(stats);
    } else {
      spreader_->finish(spread_);
      finished_ = true;
    }
  }
  return unload(samples) || !finished_;
}

bool RaySamples::trace(FrameStats& stats) {
  if (!source_->next(rays_)) return false;
  stats.rays += static_cast<std::uint64_t>(rays_.n);
  plan_.scene().tracer().trace(plan_.sector().antenna_m, rays_.dir_x.data(), rays_.dir_y.data(),
                               rays_.dir_z.data(), rays_.n, rough_.data());
  return true;
}

/// What a ray meets first, in double.
std::optional<ExactHit> RaySamples::exact_hit(std::size_t k, FrameStats& stats) {
  const Sector& sector = plan_.sector();
  const glm::dvec3 direction(rays_.dir_x[k], rays_.dir_y[k], rays_.dir_z[k]);
  const RayAnswer answer = answer_ray(plan_.scene(), sector.antenna_m, direction, rough_[k]);
  stats.repaired += answer.repaired ? 1 : 0;
  stats.rejected += answer.unanswered ? 1 : 0;
  const std::optional<ExactHit>& hit = answer.hit;
  if (!hit) return std::nullopt;
  ++stats.hits;
  if (tap_) {
    const double right = direction.x * sector.cos_bearing - direction.z * sector.sin_bearing;
    const double ahead = direction.x * sector.sin_bearing + direction.z * sector.cos_bearing;
    tap_->on_hit(rays_.pixel[k], std::atan2(right, ahead), *hit);
  }
  return hit;
}

void RaySamples::take_nearest(SampleBatch& samples, FrameStats& stats) {
  for (int ray = 0; ray < rays_.n; ++ray) {
    const auto k = static_cast<std::size_t>(ray);
    const auto hit = exact_hit(k, stats);
    if (!hit) continue;
    const auto s = static_cast<std::size_t>(samples.n++);
    samples.azimuth_bin[s] = rays_.azimuth_bin[k];
    samples.slant_range_m[s] = hit->slant_range_m;
    samples.solid_angle_sr[s] = rays_.solid_angle_sr[k];
    samples.cos_incidence[s] = hit->cos_incidence;
    samples.azimuth_offset_rad[s] = plan_.bins().azimuth_edge_rad(rays_.azimuth_bin[k] + 0.5);
    samples.sin_elevation[s] = rays_.dir_y[k];
    samples.x_m[s] = hit->position_m.x;
    samples.z_m[s] = hit->position_m.z;
    samples.face[s] = hit->face;
    samples.material[s] = hit->material;
  }
}

void RaySamples::take_spread(FrameStats& stats) {
  for (int ray = 0; ray < rays_.n; ++ray) {
    const auto k = static_cast<std::size_t>(ray);
    const auto hit = exact_hit(k, stats);
    spreader_->take(rays_, k, hit ? &*hit : nullptr, spread_);
  }
}

/// Moves waiting samples into the batch; false when none was left.
bool RaySamples::unload(SampleBatch& samples) {
  const std::size_t n = std::min<std::size_t>(kBatch, spread_.size() - unloaded_);
  for (std::size_t s = 0; s < n; ++s) {
    const Sample& from = spread_[unloaded_ + s];
    samples.azimuth_bin[s] = from.azimuth_bin;
    samples.slant_range_m[s] = from.slant_range_m;
    samples.solid_angle_sr[s] = from.solid_angle_sr;
    samples.cos_incidence[s] = from.cos_incidence;
    samples.azimuth_offset_rad[s] = from.azimuth_offset_rad;
    samples.sin_elevation[s] = from.sin_elevation;
    samples.x_m[s] = from.x_m;
    samples.z_m[s] = from.z_m;
    samples.face[s] = from.face;
    samples.material[s] = from.material;
  }
  samples.n = static_cast<int>(n);
  unloaded_ += n;
  if (unloaded_ == spread_.size()) {
    spread_.clear();
    unloaded_ = 0;
  }
  return n > 0;
}

}  // namespace obliq
