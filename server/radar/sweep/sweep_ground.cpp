#include "server/radar/sweep/sweep_ground.h"

#include <algorithm>

#include "server/radar/profile/ground_walk.h"

namespace obliq {

static_assert(SampleArrays::kGround == kNoFace);

SweepGround::SweepGround(const FramePlan& plan, const Kernels& kernels) : plan_(plan), kernels_(kernels) {
  const World& world = plan.scene().world();
  bins_ = {};
  bins_.axis = plan.bins();
  bins_.ground = ground_view(world.grid, plan.sector().antenna_m);
  bins_.turn_rad = PieceSampler::kTurn_rad;
  bins_.material = world.surface_material.empty() ? nullptr : world.surface_material.data();
}

void SweepGround::start(std::vector<GroundShare> shares) {
  shares_ = std::move(shares);
  lanes_ = {};
  lanes_.last_start_m = plan_.sector().r_max_m;
  pieces_.n = cut_ = 0;
  marching_ = true;
  const Horizon<double> nothing;
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(kMost); ++lane) {
    lanes_.end_m[lane] = -1;
    if (lane >= shares_.size()) continue;
    const GroundShare& share = shares_[lane];
    const SinCos bearing = share.plane.bearing;
    const GroundWalk walk(plan_.scene().world().grid, plan_.sector().antenna_m, bearing.sin, bearing.cos, 0,
                          GroundWalk::kInfinity);
    set_out(lanes_, lane, bearing, walk);
    bins_.sin_bearing[lane] = bearing.sin;
    bins_.cos_bearing[lane] = bearing.cos;
    lanes_.horizon_d_m[lane] = nothing.d_m;
    lanes_.horizon_h_m[lane] = nothing.h_m;
    lanes_.width_rad[lane] = share.width_rad.front();
    lanes_.width_to_m[lane] = share.to_m.front();
    lanes_.next_width_rad[lane] = share.width_rad.data() + 1;
    lanes_.next_width_to_m[lane] = share.to_m.data() + 1;
    bins_.azimuth_offset_rad[lane] = share.plane.azimuth_offset_rad;
    bins_.azimuth_bin[lane] = share.plane.azimuth_bin;
  }
}

bool SweepGround::next(PieceSampler& sampler, SampleBatch& samples) {
  while (!sampler.full()) {
    if (cut_ >= pieces_.n) {
      if (!marching_) return false;
      pieces_.n = cut_ = 0;
      marching_ = kernels_.visible_ground(bins_.ground, lanes_, pieces_);
      continue;
    }
    SampleArrays out{samples.n,
                     kBatch,
                     samples.azimuth_bin.data(),
                     samples.slant_range_m.data(),
                     samples.solid_angle_sr.data(),
                     samples.cos_incidence.data(),
                     samples.azimuth_offset_rad.data(),
                     samples.sin_elevation.data(),
                     samples.x_m.data(),
                     samples.z_m.data(),
                     samples.face.data(),
                     samples.material.data()};
    bool rare = false;
    cut_ = kernels_.cut_at_range_bins(bins_, pieces_, cut_, out, rare);
    samples.n = out.n;
    if (rare) {
      cut_rare(sampler);
    } else if (cut_ < pieces_.n) {
      return true;
    }
  }
  return true;
}

/// The next row of pieces, one at a time.
void SweepGround::cut_rare(PieceSampler& sampler) {
  const World& world = plan_.scene().world();
  const auto nx = static_cast<std::uint64_t>(world.grid.nx);
  for (std::size_t lane = 0; lane < shares_.size(); ++lane) {
    if ((pieces_.seen[cut_] >> lane & 1) == 0) continue;
    const auto cell = static_cast<std::uint64_t>(pieces_.cell[cut_][lane]);
    VisibleSegment piece{};
    piece.h_m = pieces_.start_m[cut_][lane];
    piece.rate_d = 1;
    piece.rate_h = pieces_.rise[cut_][lane];
    piece.t0 = pieces_.from_m[cut_][lane];
    piece.t1 = pieces_.to_m[cut_][lane];
    piece.plane_distance_m = pieces_.plane_distance_m[cut_][lane];
    piece.face = kNoFace;
    piece.material = world.material_of_cell(static_cast<int>(cell % nx), static_cast<int>(cell / nx));
    sampler.set(shares_[lane].plane);
    sampler.set_width(pieces_.width_rad[cut_][lane]);
    sampler.visible(piece);
  }
  ++cut_;
}

}  // namespace obliq
