#include "server/radar/sweep/sweep_ground.h"

#include <algorithm>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {

SweepGround::SweepGround(const ScenePlan& plan) : plan_(plan) {
  const World& world = plan.scene().world();
  bins_ = {};
  bins_.axis = plan.bins();
  bins_.ground = ground_view(world.grid, plan.sector().antenna_m);
  bins_.turn_rad = SegmentSampler::kMostTurn_rad;
  bins_.material = world.surface_material.empty() ? nullptr : world.surface_material.data();
  bins_.raster_gamma = world.raster_gamma.empty() ? nullptr : world.raster_gamma.data();
}

void SweepGround::start(std::vector<GroundShare> shares) {
  shares_ = std::move(shares);
  lanes_ = {};
  lanes_.last_start_m = plan_.sector().r_max_m;
  segments_.n = cut_ = 0;
  marching_ = true;
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(kMost); ++lane) {
    lanes_.end_m[lane] = -1;
    if (lane >= shares_.size()) continue;
    const GroundShare& share = shares_[lane];
    const SinCos bearing = share.plane.bearing;
    set_out(lanes_, lane, bearing, plan_.scene().world().grid, plan_.sector().antenna_m,
            {share.width_rad.data(), share.to_m.data()});
    bins_.sin_bearing[lane] = bearing.sin;
    bins_.cos_bearing[lane] = bearing.cos;
    bins_.azimuth_offset_rad[lane] = share.plane.azimuth_offset_rad;
    bins_.azimuth_bin[lane] = share.plane.azimuth_bin;
  }
}

bool SweepGround::next(SegmentSampler& sampler, SampleBatch& samples) {
  MarchedCells marched(lanes_, plan_.scene().world().grid);
  while (!sampler.full()) {
    if (cut_ >= segments_.n) {
      if (!marching_) return false;
      segments_.n = cut_ = 0;
      marching_ = active_kernels().visible_ground(bins_.ground, lanes_, segments_);
      marched.ask_for_them();
      continue;
    }
    bool rare = false;
    cut_ = active_kernels().cut_at_range_bins(bins_, segments_, cut_, samples, rare);
    if (rare) {
      cut_rare(sampler);
    } else if (cut_ < segments_.n) {
      return true;
    }
  }
  return true;
}

/// The next row of segments, one at a time.
void SweepGround::cut_rare(SegmentSampler& sampler) {
  const World& world = plan_.scene().world();
  const auto nx = static_cast<std::uint64_t>(world.grid.nx);
  for (std::size_t lane = 0; lane < shares_.size(); ++lane) {
    if ((segments_.seen[cut_] >> lane & 1) == 0) continue;
    const auto cell = static_cast<std::uint64_t>(segments_.cell[cut_][lane]);
    VisibleSegment segment{};
    segment.h_m = segments_.start_m[cut_][lane];
    segment.rate_d = 1;
    segment.rate_h = segments_.rise[cut_][lane];
    segment.t0 = segments_.from_m[cut_][lane];
    segment.t1 = segments_.to_m[cut_][lane];
    segment.plane_distance_m = segments_.plane_distance_m[cut_][lane];
    segment.face = kNoFace;
    const auto i = static_cast<int>(cell % nx);
    const auto j = static_cast<int>(cell / nx);
    segment.material = world.material_of_cell(i, j);
    segment.raster_gamma = world.raster_gamma_of_cell(i, j);
    sampler.set(shares_[lane].plane);
    sampler.set_width(segments_.width_rad[cut_][lane]);
    sampler.visible(segment);
  }
  ++cut_;
}

}  // namespace obliq
