#include "server/radar/rays/plates/pixel_plates.h"

#include <algorithm>
#include <cmath>

#include "server/radar/simd/kernels.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

/// No plate is walked farther than this many cells from its hit: pixels are a few cells long, and near the
/// horizon they would reach across the scene.
constexpr double kReach_cells = 64;
// In units of ask(): eight walked together, and one by itself.
constexpr int kEightPlates = 160;
constexpr int kAPlate = 60;

PlateField field_of(const ScenePlan& plan) {
  const World& world = plan.scene().world();
  const PerspectiveFrustum& camera = plan.camera();
  const bool pitched = camera.kind == FrustumKind::symmetric;
  return {ground_view(world.grid, plan.sector().antenna_m),
          world.surface_material.empty() ? nullptr : world.surface_material.data(),
          world.raster_gamma.empty() ? nullptr : world.raster_gamma.data(),
          plan.bins(),
          kReach_cells * world.grid.cell_m,
          kLook_cells,
          kTouching_m,
          std::ranges::any_of(plan.scene().materials(),
                              [](const Material& material) {
                                return material.model != ScatteringModel::constant_gamma &&
                                       material.model != ScatteringModel::sea;
                              }),
          camera.pixel_width_m() / camera.near_m / 2,
          camera.pixel_height_m() / camera.near_m / 2,
          pitched ? std::sin(camera.pitch_rad) : 1.0,
          pitched ? std::cos(camera.pitch_rad) : 0.0,
          plan.sector().sin_bearing,
          plan.sector().cos_bearing};
}

}  // namespace

PixelPlates::PixelPlates(const ScenePlan& plan, AzimuthRange range, WedgeVisibility& profile)
    : plan_(plan),
      range_(range),
      profile_(profile),
      field_(field_of(plan)),
      surface_(plan.scene().world(), plan.sector().antenna_m) {
  for (int bin = range.first; bin < range.first + range.count; ++bin) buildings_.emplace_back(plan, bin);
}

int PixelPlates::spread(const RayBatch& rays, const HitBatch& hits, int first, SampleBatch& samples,
                        std::vector<Sample>& waiting) {
  constexpr int kMostSamples = GroundPlates::kLanes * GroundPlates::kMost;
  for (; first < rays.n && waiting.size() < kBatch; first += GroundPlates::kLanes) {
    if (samples.n + kMostSamples > kBatch) return first;
    spread_eight(rays, hits, first, samples, waiting);
  }
  return std::min(first, rays.n);
}

void PixelPlates::spread_eight(const RayBatch& rays, const HitBatch& hits, int first, SampleBatch& samples,
                               std::vector<Sample>& waiting) {
  ask(kEightPlates);
  const auto begin = static_cast<std::size_t>(first);
  const auto n = static_cast<std::size_t>(std::min(GroundPlates::kLanes, rays.n - first));
  unsigned on_ground = 0;
  for (std::size_t lane = 0; lane < n; ++lane)
    on_ground |= (hits.is_hit(begin + lane) && hits.face[begin + lane] == kNoFace ? 1u : 0u) << lane;
  active_kernels().ground_plates(
      field_, {rays.dir_x.data(), rays.dir_y.data(), rays.dir_z.data(), hits.slant_range_m}, first, on_ground,
      plates_);

  PlatePixels pixels{rays.solid_angle_sr.data() + first,
                     hits.cos_incidence + first,
                     hits.slant_range_m + first,
                     rays.azimuth_bin.data() + first,
                     {},
                     {}};
  for (std::size_t lane = 0; lane < n; ++lane) {
    const std::size_t k = begin + lane;
    if ((plates_.walked >> lane & 1) == 0) continue;
    if (buildings(rays, k).any_between(plates_.from_m[lane], plates_.to_m[lane], plates_.sin_bearing[lane],
                                       plates_.cos_bearing[lane]))
      plates_.walked &= ~(1u << lane);
    pixels.azimuth_offset_rad[lane] = plan_.bins().azimuth_edge_rad(rays.azimuth_bin[k] + 0.5);
    pixels.visible[lane] = profile_.whole_marks(rays.azimuth_bin[k]).visible.data();
  }
  const unsigned dark = active_kernels().plate_samples(field_, pixels, plates_, samples);
  for (std::size_t lane = 0; lane < n; ++lane) {
    const std::size_t k = begin + lane;
    if (!hits.is_hit(k)) continue;
    if ((plates_.walked >> lane & 1) == 0) {
      walk(rays, hits, k, waiting);
    } else if ((dark >> lane & 1) != 0) {
      waiting.push_back(sample_at_hit(plan_.bins(), rays, hits, k));
    }
  }
}

/// One of the eight current rays.
void PixelPlates::walk(const RayBatch& rays, const HitBatch& hits, std::size_t k,
                       std::vector<Sample>& waiting) {
  ask(kAPlate);
  const std::size_t lane = k % GroundPlates::kLanes;
  const BinGrid& bins = plan_.bins();
  plate_.clear();
  double sin_bearing = 0;
  double cos_bearing = 1;
  const SightPoint point{plates_.d_m[lane], plates_.h_m[lane], plates_.slope[lane]};
  if (point.d_m > 0) {
    sin_bearing = plates_.sin_bearing[lane];
    cos_bearing = plates_.cos_bearing[lane];
    const double half = plates_.half_extent[lane];
    const double reach_m = field_.reach_m;
    roofs_.clear();
    buildings(rays, k).add_stretches(point.d_m - reach_m, point.d_m + reach_m, sin_bearing, cos_bearing,
                                     roofs_);
    if (!roofs_.empty()) roofs_ = disjoint_roofs(roofs_);
    surface_.aim(sin_bearing, cos_bearing, roofs_);
    visible_.clear();
    surface_.walk_out(point, point.slope + half, point.d_m + reach_m, visible_);
    surface_.walk_in(point, point.slope - half, point.d_m - reach_m, visible_);
    for (const SurfaceSegment& segment : visible_) plate_.add(bins, segment);
    plate_.drop_hidden(profile_.whole_marks(rays.azimuth_bin[k]).visible,
                       bins.range_bin(hits.slant_range_m[k]));
  }
  emit_plate(plan_, plate_, sample_at_hit(bins, rays, hits, k), sin_bearing, cos_bearing, waiting);
}

}  // namespace obliq
