#include "server/radar/rays/ray_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/radar/simd/kernels.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "server/scene/ray_answer.h"
#include "terrain/base/asking.h"
#include "terrain/base/stage_clock.h"

namespace obliq {
namespace {

constexpr double kNoRange = std::numeric_limits<double>::quiet_NaN();
// In units of ask().
constexpr std::int64_t kAPixel = 2;
constexpr std::int64_t kARay = 10;
constexpr std::int64_t kAHit = 4;
constexpr std::int64_t kAnOddHit = 100;

}  // namespace

std::unique_ptr<PerspectiveRays> make_ray_source(const ScenePlan& plan, AzimuthRange range) {
  if (!plan.extent().any) return nullptr;
  return std::make_unique<PerspectiveRays>(plan, range);
}

RaySamples::RaySamples(const ScenePlan& plan, AzimuthRange range, HitObserver* observer,
                       WedgeVisibility* profile)
    : plan_(plan),
      observer_(observer),
      source_(make_ray_source(plan, range)),
      first_hits_(plan, range, observer != nullptr) {
  if (plan.settings().plates == PlateKind::nearest) return;
  if (!profile) own_profile_ = std::make_unique<WedgeVisibility>(plan, range);
  plates_ = std::make_unique<PixelPlates>(plan, range, profile ? *profile : *own_profile_);
}

RaySamples::~RaySamples() = default;

bool RaySamples::fill(SampleBatch& samples, FrameStats& stats) {
  samples.n = 0;
  if (!plates_) {
    if (!next_hits(stats)) return false;
    take_nearest(samples);
    return true;
  }
  if (waiting_.empty() && !finished_) spread(samples, stats);
  hand_out(samples);
  return samples.n > 0 || !finished_;
}

/// The next rays and their hits; false when no pixel was left.
bool RaySamples::next_hits(FrameStats& stats) {
  if (!generate(stats)) return false;
  trace();
  refine(stats);
  spread_rays_ = 0;
  return true;
}

bool RaySamples::generate(FrameStats& stats) {
  const StageProbe probe(Stage::rays);
  if (!source_ || !source_->generate(rays_)) return false;
  stats.rays += static_cast<std::uint64_t>(rays_.n);
  ask(kAPixel * PerspectiveRays::kMostPixels);
  return true;
}

void RaySamples::trace() {
  const StageProbe probe(Stage::trace);
  first_hits_.trace(rays_, rough_.data());
  ask(kARay * rays_.n);
}

void RaySamples::refine(FrameStats& stats) {
  const StageProbe probe(Stage::refine);
  refine_ground();
  const World& world = plan_.scene().world();
  std::int64_t odd = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(rays_.n); ++k) {
    if (is_settled_ground(k)) {
      ++stats.hits;
      hits_.face[k] = kNoFace;
      hits_.material[k] = world.material_of_cell(hits_.cell_x[k], hits_.cell_z[k]);
      hits_.raster_gamma[k] = world.raster_gamma_of_cell(hits_.cell_x[k], hits_.cell_z[k]);
    } else {
      refine_one(k, stats);
      ++odd;
    }
  }
  ask(kAHit * rays_.n + kAnOddHit * odd);
}

/// Most rays hit the ground: these at once.
void RaySamples::refine_ground() {
  double rough_m[kBatch];
  const auto n = static_cast<std::size_t>(rays_.n);
  for (std::size_t k = 0; k < n; ++k)
    rough_m[k] =
        rough_[k].kind == RoughHit::Kind::ground ? static_cast<double>(rough_[k].distance_m) : kNoRange;
  for (std::size_t k = n; k % 8 != 0; ++k) rough_m[k] = kNoRange;
  active_kernels().refine_ground_hits(
      {ground_view(plan_.scene().world().grid, plan_.sector().antenna_m), rays_.n, rays_.dir_x.data(),
       rays_.dir_y.data(), rays_.dir_z.data(), rough_m},
      hits_);
}

/// Whether refine_ground has found the hit, and the hit does not prove that the ray leaked through the mesh.
/// It has no normal, which an observer needs.
bool RaySamples::is_settled_ground(std::size_t k) const {
  if (observer_ || !hits_.is_hit(k)) return false;
  const Scene& scene = plan_.scene();
  if (!first_hits_.by_embree(k) || scene.building_index().empty()) return true;
  const double y_m = plan_.sector().antenna_m.y + hits_.slant_range_m[k] * rays_.dir_y[k];
  return !ground_is_buried(scene, {hits_.x_m[k], y_m, hits_.z_m[k]});
}

/// A ray that hits a building or nothing, has leaked, or meets the ground next to a silhouette.
void RaySamples::refine_one(std::size_t k, FrameStats& stats) {
  hits_.slant_range_m[k] = kNoRange;
  // A march never misses a surface; only Embree can.
  if (rough_[k].kind == RoughHit::Kind::none && !first_hits_.by_embree(k)) return;
  const Sector& sector = plan_.sector();
  const glm::dvec3 direction(rays_.dir_x[k], rays_.dir_y[k], rays_.dir_z[k]);
  const RayAnswer answer = answer_ray(plan_.scene(), sector.antenna_m, direction, rough_[k]);
  stats.repaired += answer.repaired ? 1 : 0;
  stats.rejected += answer.unanswered ? 1 : 0;
  if (!answer.hit) return;
  const ExactHit& hit = *answer.hit;
  ++stats.hits;
  hits_.slant_range_m[k] = hit.slant_range_m;
  hits_.cos_incidence[k] = hit.cos_incidence;
  hits_.x_m[k] = hit.position_m.x;
  hits_.z_m[k] = hit.position_m.z;
  hits_.face[k] = hit.face;
  hits_.material[k] = hit.material;
  hits_.raster_gamma[k] = hit.raster_gamma;
  if (!observer_) return;
  const double right = direction.x * sector.cos_bearing - direction.z * sector.sin_bearing;
  const double ahead = direction.x * sector.sin_bearing + direction.z * sector.cos_bearing;
  observer_->on_hit(rays_.pixel[k], std::atan2(right, ahead), hit);
}

void RaySamples::take_nearest(SampleBatch& samples) const {
  const StageProbe probe(Stage::refine);
  for (std::size_t k = 0; k < static_cast<std::size_t>(rays_.n); ++k)
    if (hits_.is_hit(k)) samples.push(sample_at_hit(plan_.bins(), rays_, hits_, k));
}

/// Spreads pixels until a batch of samples is there or waits: one of them may cover all range bins.
void RaySamples::spread(SampleBatch& samples, FrameStats& stats) {
  finished_ = spread_rays_ == rays_.n && !next_hits(stats);
  const StageProbe probe(Stage::plates);
  if (!finished_) spread_rays_ = plates_->spread(rays_, hits_, spread_rays_, samples, waiting_);
}

/// Moves waiting samples into the batch.
void RaySamples::hand_out(SampleBatch& samples) {
  const StageProbe probe(Stage::plates);
  while (handed_out_ < waiting_.size() && !samples.full()) samples.push(waiting_[handed_out_++]);
  if (handed_out_ < waiting_.size()) return;
  waiting_.clear();
  handed_out_ = 0;
}

}  // namespace obliq
