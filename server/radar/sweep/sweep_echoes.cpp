#include "server/radar/sweep/sweep_echoes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/radar/geometry/silhouettes.h"
#include "server/radar/profile/ground_walk.h"
#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/stage_clock.h"

namespace obliq {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;
/// Nearer buildings fill too much of a bin's elevation to be spread over range evenly.
constexpr double kNearest_m = 100;

bool has_flat_plates(const Scene& scene) {
  return std::ranges::any_of(scene.materials(), [](const Material& material) {
    return material.model == ScatteringModel::flat_plate;
  });
}

/// Of which some part is no farther than kNearest_m, and some that are.
std::vector<std::uint32_t> near_buildings(const FramePlan& plan) {
  const BuildingIndex& index = plan.scene().building_index();
  std::vector<std::uint32_t> found;
  if (index.empty()) return found;
  const glm::dvec3& antenna = plan.sector().antenna_m;
  const double step_m = BuildingIndex::kCells * plan.scene().world().grid.cell_m;
  const int steps = static_cast<int>(kNearest_m / step_m) + 1;
  for (int i = -steps; i <= steps; ++i)
    for (int j = -steps; j <= steps; ++j) {
      const auto near = index.near(antenna.x + i * step_m, antenna.z + j * step_m);
      found.insert(found.end(), near.begin(), near.end());
    }
  std::ranges::sort(found);
  found.erase(std::ranges::unique(found).begin(), found.end());
  return found;
}

}  // namespace

SubColumnBins::SubColumnBins(const FramePlan& plan)
    : suffices_(static_cast<std::size_t>(plan.bins().n_azimuth)) {
  const RadarSettings& settings = plan.settings();
  const BinGrid& bins = plan.bins();
  if (settings.frustum != FrustumKind::sweep || settings.sub_columns == 0 ||
      settings.speckle == SpeckleKind::geometric || bins.azimuth_width_rad > kDegree_rad ||
      bins.range_spacing_m > 0.1 * bins.r_max_m || has_flat_plates(plan.scene()))
    return;
  suffices_.assign(suffices_.size(), true);
  const double lowest_slope = lowest_slope_in_swath(plan);
  for (const std::uint32_t b : near_buildings(plan)) {
    const Silhouette seen = silhouette_of(plan.scene().world().buildings, plan.sector(), b);
    if (seen.near_m > kNearest_m || seen.top_slope < lowest_slope) continue;
    for (int bin = 0; bin < bins.n_azimuth; ++bin)
      for (int turn = -1; turn <= 1; ++turn)
        if (bins.azimuth_edge_rad(bin + 1.0) + turn * 2 * std::numbers::pi > seen.from_rad &&
            bins.azimuth_edge_rad(bin) + turn * 2 * std::numbers::pi < seen.to_rad)
          suffices_[static_cast<std::size_t>(bin)] = false;
  }
}

bool SubColumnBins::all_of(AzimuthRange range) const {
  const auto first = suffices_.begin() + range.first;
  return std::all_of(first, first + range.count, [](bool suffices) { return suffices; });
}

SweepEchoes::SweepEchoes(const FramePlan& plan, AzimuthRange range, EchoCells& cells)
    : plan_(plan),
      range_(range),
      cells_(cells),
      planes_(plan.extent().any ? sweep_columns_per_bin(plan.settings()) : 0),
      view_(plan) {
  const World& world = plan.scene().world();
  cut_ = {plan.bins(), cells.table(),
          world.surface_material.empty() ? nullptr : world.surface_material.data(), world.grid.nx, nullptr};
  ground_ = ground_view(world.grid, plan.sector().antenna_m);
  segments_.n = 0;
  echoes_.n = 0;
}

bool SweepEchoes::step(FrameStats& stats) {
  if (planes_ == 0) return false;
  if (viewed_ < range_.count) {
    const StageProbe probe(Stage::buildings);
    step_buildings();
    return true;
  }
  const StageProbe probe(Stage::ground);
  if (!marching_) {
    if (plane_ == planes_) return false;
    start_planes();
    stats.rays += static_cast<std::uint64_t>(range_.count);
  }
  step_ground();
  return true;
}

bool SweepEchoes::step_buildings() {
  const auto n_range = static_cast<std::size_t>(plan_.bins().n_range);
  if (!viewing_) {
    viewing_ = view_.start(range_.first + viewed_, viewed_);
    if (!viewing_) ++viewed_;
    return true;
  }
  if (view_.step(cells_)) return true;
  viewing_ = false;
  if (kept_.empty()) kept_.assign(static_cast<std::size_t>(planes_) * n_range * kWedgeAzimuthBins, 1.0F);
  for (int plane = 0; plane < planes_; ++plane)
    view_.kept_shares(plane,
                      kept_.data() + static_cast<std::size_t>(plane) * n_range * kWedgeAzimuthBins +
                          static_cast<std::size_t>(viewed_),
                      cells_);
  ++viewed_;
  return true;
}

void SweepEchoes::start_planes() {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr double kNoWidth = 0;
  const BinGrid& bins = plan_.bins();
  const Horizon<double> nothing;
  profiles_ = {};
  profiles_.last_start_m = plan_.sector().r_max_m;
  for (std::size_t lane = 0; lane < SightProfiles::kLanes; ++lane) {
    profiles_.end_m[lane] = -1;
    echoes_.bin_now[lane] = -1;
    echoes_.distance_now_m[lane] = echoes_.power_now_w[lane] = echoes_.material_now[lane] = 0;
    if (static_cast<int>(lane) >= range_.count) continue;
    const double position = range_.first + static_cast<double>(lane) + (plane_ + 0.5) / planes_;
    const SinCos offset = sincos_turns(bins.azimuth_edge_rad(position) / (2 * std::numbers::pi));
    const glm::dvec3 d = plan_.sector().world_from_antenna(offset.sin, 0, offset.cos);
    const SinCos bearing{d.x, d.z};
    const GroundWalk walk(plan_.scene().world().grid, plan_.sector().antenna_m, bearing.sin, bearing.cos, 0,
                          GroundWalk::kInfinity);
    set_out(profiles_, lane, bearing, walk);
    profiles_.horizon_d_m[lane] = nothing.d_m;
    profiles_.horizon_h_m[lane] = nothing.h_m;
    profiles_.width_rad[lane] = bins.azimuth_width_rad / planes_;
    profiles_.width_to_m[lane] = kInfinity;
    profiles_.next_width_rad[lane] = &kNoWidth;
    profiles_.next_width_to_m[lane] = &kInfinity;
  }
  cells_.set_bearings(profiles_.sin_bearing, profiles_.cos_bearing);
  cut_.kept = kept_.empty() ? nullptr
                            : kept_.data() + static_cast<std::size_t>(plane_) *
                                                 static_cast<std::size_t>(bins.n_range) * kWedgeAzimuthBins;
  segments_.n = 0;
  marching_ = true;
}

/// Marches and cuts what fills a few lists.
void SweepEchoes::step_ground() {
  const Kernels& kernels = widest_kernels();
  for (int turn = 0; turn < 4 && marching_; ++turn) {
    segments_.n = 0;
    marching_ = kernels.visible_ground(ground_, profiles_, segments_);
    for (int row = 0; row < segments_.n;) {
      row = kernels.ground_echoes(cut_, segments_, row, echoes_);
      if (row < segments_.n) cells_.add(echoes_);
    }
  }
  if (marching_) return;
  // What is still on the way ends here.
  cells_.add(echoes_);
  for (std::size_t lane = 0; lane < SightProfiles::kLanes; ++lane) {
    if (echoes_.bin_now[lane] < 0) continue;
    const auto n = static_cast<std::size_t>(echoes_.n++);
    echoes_.at[n] = static_cast<std::uint32_t>(echoes_.bin_now[lane]) * kWedgeAzimuthBins +
                    static_cast<std::uint32_t>(lane);
    echoes_.distance_m[n] = echoes_.distance_now_m[lane];
    echoes_.power_w[n] = echoes_.power_now_w[lane];
    echoes_.material[n] = static_cast<std::uint32_t>(echoes_.material_now[lane]);
  }
  cells_.add(echoes_);
  ++plane_;
}

}  // namespace obliq
