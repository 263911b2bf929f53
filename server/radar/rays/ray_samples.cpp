#include "server/radar/rays/ray_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/radar/rays/perspective_rays.h"
#include "server/radar/rays/plates/column_plates.h"
#include "server/radar/rays/plates/pixel_plates.h"
#include "server/radar/rays/polar_rays.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "server/scene/embree_tracer.h"
#include "server/scene/ray_answer.h"
#include "terrain/base/stage_clock.h"

namespace obliq {
namespace {

class NoRays : public RaySource {
 public:
  bool next(RayBatch& batch) override {
    batch.n = 0;
    return false;
  }
};

std::unique_ptr<PlateSpreader> make_plate_spreader(const FramePlan& plan, AzimuthRange range,
                                                   WedgeVisibility& profile) {
  if (plan.settings().frustum == FrustumKind::polar) return std::make_unique<ColumnPlates>(plan);
  return std::make_unique<PixelPlates>(plan, range, profile);
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
static_assert(GroundHits::kMost == kBatch);

/// Samples that are handed out and still kept: what waits behind them is moved seldom.
constexpr std::size_t kMostUnloaded = 8 * kBatch;

}  // namespace

std::unique_ptr<RaySource> make_ray_source(const FramePlan& plan, AzimuthRange range) {
  if (!plan.extent().any) return std::make_unique<NoRays>();
  if (plan.settings().frustum == FrustumKind::polar) return std::make_unique<PolarRays>(plan, range);
  return std::make_unique<PerspectiveRays>(plan, range);
}

RaySamples::RaySamples(const FramePlan& plan, AzimuthRange range, SampleTap* tap, WedgeVisibility* profile)
    : plan_(plan), tap_(tap), source_(make_ray_source(plan, range)), trace_(plan, range, tap != nullptr) {
  if (plan.settings().plates == PlateKind::nearest) return;
  if (!profile) own_profile_ = std::make_unique<WedgeVisibility>(plan, range);
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
    if (spread_rays_ == rays_.n && !next_rays(stats)) {
      const StageProbe probe(Stage::plates);
      spreader_->finish(spread_);
      finished_ = true;
    } else {
      spread_some();
    }
  }
  return unload(samples) || !finished_;
}

bool RaySamples::trace(FrameStats& stats) {
  {
    const StageProbe probe(Stage::rays);
    if (!source_->next(rays_)) return false;
  }
  const StageProbe probe(Stage::trace);
  stats.rays += static_cast<std::uint64_t>(rays_.n);
  trace_.trace(rays_, rough_.data());
  return true;
}

/// Answers at once what lies on the ground, most rays.
void RaySamples::meet_ground() {
  const auto n = static_cast<std::size_t>(rays_.n);
  for (std::size_t k = 0; k < n; ++k)
    rough_ground_m_[k] =
        rough_[k].kind == RoughHit::Kind::ground ? static_cast<double>(rough_[k].distance_m) : kNone;
  for (std::size_t k = n; k % 8 != 0; ++k) rough_ground_m_[k] = kNone;
  widest_kernels().refine_ground_hits(
      {ground_view(plan_.scene().world().grid, plan_.sector().antenna_m), rays_.n, rays_.dir_x.data(),
       rays_.dir_y.data(), rays_.dir_z.data(), rough_ground_m_.data()},
      ground_);
}

/// Whether meet_ground has the ray's answer, and it does not prove that the ray has leaked. It has no normal,
/// which textures alone ask for.
bool RaySamples::on_ground(std::size_t k) const {
  const double range_m = ground_.slant_range_m[k];
  if (tap_ || std::isnan(range_m)) return false;
  const Scene& scene = plan_.scene();
  if (!trace_.by_embree(k) || scene.building_index().empty()) return true;
  const double y_m = plan_.sector().antenna_m.y + range_m * rays_.dir_y[k];
  return !ground_is_buried(scene, {ground_.x_m[k], y_m, ground_.z_m[k]});
}

/// For rays on_ground.
ExactHit RaySamples::ground_hit(std::size_t k) const {
  ExactHit hit;
  hit.slant_range_m = ground_.slant_range_m[k];
  hit.cos_incidence = ground_.cos_incidence[k];
  hit.position_m = {ground_.x_m[k], plan_.sector().antenna_m.y + hit.slant_range_m * rays_.dir_y[k],
                    ground_.z_m[k]};
  hit.material = plan_.scene().world().material_of_cell(ground_.cell_x[k], ground_.cell_z[k]);
  return hit;
}

/// What any ray meets first, in double.
std::optional<ExactHit> RaySamples::exact_hit(std::size_t k, FrameStats& stats) {
  if (rough_[k].kind == RoughHit::Kind::none && !trace_.by_embree(k)) return std::nullopt;  // it is sure
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
  const StageProbe probe(Stage::refine);
  meet_ground();
  const World& world = plan_.scene().world();
  for (int ray = 0; ray < rays_.n; ++ray) {
    const auto k = static_cast<std::size_t>(ray);
    const auto s = static_cast<std::size_t>(samples.n);
    if (on_ground(k)) {
      ++stats.hits;
      samples.slant_range_m[s] = ground_.slant_range_m[k];
      samples.cos_incidence[s] = ground_.cos_incidence[k];
      samples.x_m[s] = ground_.x_m[k];
      samples.z_m[s] = ground_.z_m[k];
      samples.face[s] = kNoFace;
      samples.material[s] = world.material_of_cell(ground_.cell_x[k], ground_.cell_z[k]);
    } else if (const auto hit = exact_hit(k, stats)) {
      samples.slant_range_m[s] = hit->slant_range_m;
      samples.cos_incidence[s] = hit->cos_incidence;
      samples.x_m[s] = hit->position_m.x;
      samples.z_m[s] = hit->position_m.z;
      samples.face[s] = hit->face;
      samples.material[s] = hit->material;
    } else {
      continue;
    }
    samples.azimuth_bin[s] = rays_.azimuth_bin[k];
    samples.solid_angle_sr[s] = rays_.solid_angle_sr[k];
    samples.azimuth_offset_rad[s] = plan_.bins().azimuth_edge_rad(rays_.azimuth_bin[k] + 0.5);
    samples.sin_elevation[s] = rays_.dir_y[k];
    ++samples.n;
  }
}

/// Meets the next rays' surfaces; false when no ray was left.
bool RaySamples::next_rays(FrameStats& stats) {
  if (!trace(stats)) return false;
  const StageProbe probe(Stage::refine);
  meet_ground();
  for (std::size_t k = 0; k < static_cast<std::size_t>(rays_.n); ++k) {
    const bool ground = on_ground(k);
    stats.hits += ground ? 1 : 0;
    exact_[k] = ground ? ground_hit(k) : exact_hit(k, stats);
  }
  spread_rays_ = 0;
  return true;
}

/// Spreads rays until a batch of samples waits: one of them may cover all range bins.
void RaySamples::spread_some() {
  const StageProbe probe(Stage::plates);
  for (; spread_rays_ < rays_.n && spread_.size() - unloaded_ < kBatch; ++spread_rays_) {
    const auto k = static_cast<std::size_t>(spread_rays_);
    spreader_->take(rays_, k, exact_[k] ? &*exact_[k] : nullptr, spread_);
  }
}

/// Moves waiting samples into the batch; false when none was left.
bool RaySamples::unload(SampleBatch& samples) {
  const StageProbe probe(Stage::plates);
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
  if (unloaded_ == spread_.size() || unloaded_ >= kMostUnloaded) {
    spread_.erase(spread_.begin(), spread_.begin() + static_cast<std::ptrdiff_t>(unloaded_));
    unloaded_ = 0;
  }
  return n > 0;
}

}  // namespace obliq
