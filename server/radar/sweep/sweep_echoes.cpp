#include "server/radar/sweep/sweep_echoes.h"

#include <algorithm>
#include <cmath>

#include "server/radar/echo/sea_echo.h"
#include "server/radar/profile/ground_walk.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/asking.h"
#include "terrain/base/stage_clock.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Floats keep a range of 37 km to 4 mm.
constexpr double kFinest_m = 1;
/// Longer range bins hold too different light to be given one share of it: 2 % too much over a town.
constexpr double kLongest_m = 1000;

/// What lies beyond the last range that matters may have its scatterers before it: so many cells.
constexpr double kMoreCells = 4;

}  // namespace

bool has_sub_columns(const ScenePlan& plan) {
  const RadarSettings& settings = plan.settings();
  const BinGrid& bins = plan.bins();
  return settings.frustum == FrustumKind::sweep && settings.sub_columns > 0 &&
         bins.range_spacing_m >= kFinest_m && bins.range_spacing_m <= kLongest_m;
}

SweepEchoes::SweepEchoes(const ScenePlan& plan, AzimuthRange range, const NearBuildings& near,
                         const ScatteringTable& scattering, EchoCells& cells, double far_m)
    : plan_(plan),
      range_(range),
      far_m_(std::min(far_m + kMoreCells * plan.scene().world().grid.cell_m, plan.sector().r_max_m)),
      cells_(cells),
      planes_(plan.extent().any ? sweep_columns_per_bin(plan.settings()) : 0),
      view_(plan, near, scattering, far_m_ + plan.building_reach_m() - plan.sector().r_max_m) {
  const World& world = plan.scene().world();
  cut_ = {plan.bins(),
          cells.table(),
          world.surface_material.empty() ? nullptr : world.surface_material.data(),
          world.raster_gamma.empty() ? nullptr : world.raster_gamma.data(),
          world.grid.nx,
          {nullptr, nullptr},
          {},
          {},
          {},
          {}};
  // Of ground of one material that has none itself, the lobes of the others are not looked up.
  if (cut_.material == nullptr) cut_.echo.any_lobes = cut_.echo.peak[0] > 0;
  for (VisibleSegments& segments : segments_) segments.wants_planes = cut_.echo.any_lobes;
  ground_ = ground_view(world.grid, plan.sector().antenna_m);
  echoes_.n = 0;
  if (cells.labels() == LabelParts::none) return;
  stretches_ = std::make_unique_for_overwrite<GroundStretches>();
  stretches_->n = 0;
  if (cells.labels() == LabelParts::all) returns_ = std::make_unique<SweptReturns>(plan, planes_);
}

std::int64_t SweepEchoes::bytes(const RadarSettings& s) {
  const double kept = static_cast<double>(s.range_bins) * kWedgeAzimuthBins;
  const double nodes = BuildingView::kMostNodesABin * s.r_max_m / s.range_bin_m();
  return std::llround(sweep_columns_per_bin(s) * static_cast<double>(sizeof(float)) * (kept + 5 * nodes)) +
         SweptReturns::bytes(s.range_bins);
}

void SweepEchoes::run(FrameStats& stats) {
  if (planes_ == 0) return;
  view_buildings();
  const StageProbe probe(Stage::ground);
  while (plane_ < planes_) {
    start_planes();
    stats.rays += static_cast<std::uint64_t>(range_.count * together_);
    march_planes();
  }
}

void SweepEchoes::view_buildings() {
  const StageProbe probe(Stage::buildings);
  const std::size_t shares = static_cast<std::size_t>(plan_.bins().n_range) * kWedgeAzimuthBins;
  for (int profile = 0; profile < range_.count; ++profile) {
    if (!view_.see(range_.first + profile, profile, cells_)) continue;
    if (kept_.empty()) fill(kept_, static_cast<std::size_t>(planes_) * shares, 1.0F);
    for (int plane = 0; plane < planes_; ++plane)
      view_.kept_shares(
          plane, kept_.data() + static_cast<std::size_t>(plane) * shares + static_cast<std::size_t>(profile),
          cells_);
    for (int plane = 0; returns_ && plane < planes_; ++plane) {
      std::vector<std::uint32_t>& buildings = returns_->buildings(plane, profile);
      view_.across((plane + 0.5) / planes_, buildings);
    }
  }
}

void SweepEchoes::start_planes() {
  // More than two go one after the other, so that planes of one ground cell follow each other.
  together_ = planes_ == 2 ? 2 : 1;
  for (int half = 0; half < 2; ++half) {
    half_marching_[half] = half < together_;
    segments_[half].n = 0;
    if (half < together_) start_plane(half);
  }
  for (std::size_t k = 0; k < GroundEchoes::kRuns; ++k) {
    echoes_.pending_bin[k] = -1;
    echoes_.pending_distance_m[k] = echoes_.pending_power[k] = echoes_.pending_material[k] =
        echoes_.pending_sine[k] = 0;
    if (stretches_) stretches_->start(k);
  }
  const std::size_t shares = static_cast<std::size_t>(plan_.bins().n_range) * kWedgeAzimuthBins;
  if (stretches_) stretches_->wants_ends = returns_ && returns_->any_roofs();
  cut_.kept[0] = kept_.empty() ? nullptr : kept_.data() + static_cast<std::size_t>(plane_) * shares;
  cut_.kept[1] = kept_.empty() || together_ == 1 ? cut_.kept[0] : cut_.kept[0] + shares;
  plane_ += together_;
}

void SweepEchoes::start_plane(int half) {
  const BinGrid& bins = plan_.bins();
  plane_width_rad_ = bins.azimuth_width_rad / planes_;
  const GroundWidths widths{&plane_width_rad_, &kInfinity};
  SightProfiles& profiles = profiles_[half];
  profiles = {};
  profiles.last_start_m = far_m_;
  for (std::size_t lane = 0; lane < SightProfiles::kLanes; ++lane) {
    profiles.end_m[lane] = -1;
    if (static_cast<int>(lane) >= range_.count) continue;
    const double position = range_.first + static_cast<double>(lane) + (plane_ + half + 0.5) / planes_;
    const SinCos bearing = plan_.sector().world_bearing(bins.azimuth_edge_rad(position));
    set_out(profiles, lane, bearing, plan_.scene().world().grid, plan_.sector().antenna_m, widths);
    const std::size_t run = lane + static_cast<std::size_t>(half) * SightProfiles::kLanes;
    cells_.set_bearing(run, bearing);
    if (returns_) returns_->start(run, plane_ + half, static_cast<int>(lane), bearing);
    const ElevationTable& elevation = cut_.echo.elevation;
    if (const SeaTable* sea = cut_.echo.sea; sea != nullptr) {
      cut_.sea_lean[run] = static_cast<float>(sea->lean(bearing.sin, bearing.cos));
      cut_.half_sea_curve[run] = static_cast<float>(sea->curve(bearing.sin, bearing.cos) / 2);
      if (sea->upwind > 0) {
        const auto terms = upwind_terms(*sea, bearing.sin * sea->wind_sin + bearing.cos * sea->wind_cos);
        for (std::size_t k = 0; k < terms.size(); ++k) cut_.upwind[k][run] = terms[k];
      }
    }
    cut_.lean[run] = static_cast<float>(elevation.lean_x * bearing.sin + elevation.lean_z * bearing.cos);
  }
}

/// Marches planes that have been started, and cuts what they see.
void SweepEchoes::march_planes() {
  const HeightGrid& grid = plan_.scene().world().grid;
  MarchedCells marched[] = {{profiles_[0], grid}, {profiles_[1], grid}};
  while (half_marching_[0] || half_marching_[1]) {
    for (int half = 0; half < 2; ++half) {
      segments_[half].n = 0;
      if (!half_marching_[half]) continue;
      half_marching_[half] = active_kernels().visible_ground(ground_, profiles_[half], segments_[half]);
    }
    SegmentRows a{&segments_[0], 0, segments_[0].n};
    SegmentRows b{&segments_[1], 0, segments_[1].n};
    while (!active_kernels().ground_echoes(cut_, a, b, echoes_, stretches_.get())) {
      if (echoes_.n > GroundEchoes::kMost - GroundEchoes::kSpare) cells_.add(echoes_);
      if (stretches_) take_stretches();
    }
  }
  // The cells of sixteen profiles are few enough to ask for them together; so are the echoes of a list.
  for (MarchedCells& cells : marched) cells.ask_for_them();
  for (std::size_t run = 0; run < GroundEchoes::kRuns; ++run) end_run(run);
  cells_.add(echoes_);
  if (!stretches_) return;
  for (std::size_t run = 0; run < GroundEchoes::kRuns; ++run) end_stretch(run);
  take_stretches();
  if (returns_) returns_->end_planes();
}

void SweepEchoes::take_stretches() {
  cells_.add(*stretches_);
  if (returns_) returns_->add(*stretches_);
  stretches_->n = 0;
}

/// The same of a stretch.
void SweepEchoes::end_stretch(std::size_t run) {
  GroundStretches& s = *stretches_;
  if (s.pending_bin[run] < 0) return;
  if (s.n >= GroundStretches::kMost) take_stretches();
  const auto n = static_cast<std::size_t>(s.n++);
  s.at[n] = static_cast<std::uint32_t>(s.pending_bin[run]) * GroundEchoes::kRuns +
            static_cast<std::uint32_t>(run) +
            (static_cast<std::uint32_t>(s.pending_material[run]) << GroundStretches::kMaterialBit);
  s.from_m[n] = s.pending_from_m[run];
  s.end_m[n] = s.pending_end_m[run];
  s.from_h_m[n] = s.pending_from_h_m[run];
  s.end_h_m[n] = s.pending_end_h_m[run];
  s.light[n] = s.pending_power[run];
  s.height[n] = s.pending_height[run];
}

/// Flushes the run's pending echo.
void SweepEchoes::end_run(std::size_t run) {
  if (echoes_.pending_bin[run] < 0) return;
  if (echoes_.n >= GroundEchoes::kMost) cells_.add(echoes_);
  const auto n = static_cast<std::size_t>(echoes_.n++);
  echoes_.at[n] = static_cast<std::uint32_t>(echoes_.pending_bin[run]) * GroundEchoes::kRuns +
                  static_cast<std::uint32_t>(run);
  echoes_.distance_m[n] = echoes_.pending_distance_m[run];
  echoes_.light[n] = echoes_.pending_power[run];
  echoes_.sine[n] = echoes_.pending_sine[run];
  echoes_.material[n] = static_cast<std::uint32_t>(echoes_.pending_material[run]);
}

}  // namespace obliq
