#include "server/radar/sweep/segment_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/simd/range_run.h"

namespace obliq {

void PieceSampler::begin(SampleBatch& batch) {
  batch_ = &batch;
  batch.n = 0;
  const std::size_t n = std::min<std::size_t>(waiting_.size(), kBatch);
  std::vector<Waiting> first(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(n));
  std::vector<Waiting> rest(waiting_.begin() + static_cast<std::ptrdiff_t>(n), waiting_.end());
  waiting_.clear();
  for (const Waiting& sample : first) put(sample);
  waiting_ = std::move(rest);
}

void PieceSampler::put(const Waiting& sample) {
  if (batch_->n == kBatch || !waiting_.empty()) {
    waiting_.push_back(sample);
    return;
  }
  const auto s = static_cast<std::size_t>(batch_->n++);
  batch_->azimuth_bin[s] = sample.azimuth_bin;
  batch_->slant_range_m[s] = sample.slant_range_m;
  batch_->solid_angle_sr[s] = sample.solid_angle_sr;
  batch_->cos_incidence[s] = sample.cos_incidence;
  batch_->azimuth_offset_rad[s] = sample.azimuth_offset_rad;
  batch_->sin_elevation[s] = sample.sin_elevation;
  batch_->x_m[s] = sample.x_m;
  batch_->z_m[s] = sample.z_m;
  batch_->face[s] = sample.face;
  batch_->material[s] = sample.material;
}

void PieceSampler::visible(const VisibleSegment& piece) {
  if (!(share_.width_rad > 0)) return;
  if (piece.wall) {
    aslant(piece);
  } else {
    straight(piece);
  }
}

void PieceSampler::aslant(const VisibleSegment& wall) {
  // The wall is the line n.p = -distance from the antenna: at a bearing off the plane's by `off` it stands at
  // 1 / d = -n.direction / distance. That is a cosine of the bearing, as good as straight across a strand.
  const PlaneShare whole = share_;
  const auto direction = [&](double off_rad) {
    const SinCos turn = sincos_turns(off_rad / (2 * std::numbers::pi));
    return SinCos{whole.bearing.sin * turn.cos + whole.bearing.cos * turn.sin,
                  whole.bearing.cos * turn.cos - whole.bearing.sin * turn.sin};
  };
  const auto over_d = [&](const SinCos& to) {
    // A strand may reach a little beyond the wall's ends.
    return std::clamp(-(wall.normal_x * to.sin + wall.normal_z * to.cos) / wall.plane_distance_m,
                      1 / wall.farthest_m, 1 / wall.nearest_m);
  };
  const double over_left = over_d(direction(-whole.width_rad / 2));
  const double over_right = over_d(direction(whole.width_rad / 2));
  // On the wall a range-bin edge is a curve across the strand. Between where it enters at the foot and where
  // it leaves at the top (or the other way round) it is as good as straight, and the plane in the middle of
  // that stretch divides it as a whole.
  const double near_d = 1 / std::max(over_left, over_right);
  const double far_d = 1 / std::min(over_left, over_right);
  const double low2 = std::min(wall.t0 * wall.t0, wall.t1 * wall.t1);
  const double high2 = std::max(wall.t0 * wall.t0, wall.t1 * wall.t1);
  const double nearest = std::sqrt(near_d * near_d + (wall.t0 < 0 && wall.t1 > 0 ? 0 : low2));
  const double farthest = std::sqrt(far_d * far_d + high2);
  if (farthest < bins_.r_min_m || nearest >= bins_.r_max_m) return;
  if (over_left == over_right) return straight(wall);
  // Edges beyond the swath count as well: what is nearer must not depend on where the swath ends.
  const double first = std::max(0.0, std::ceil((nearest - bins_.r_min_m) / bins_.range_spacing_m));
  const double last = std::floor((farthest - bins_.r_min_m) / bins_.range_spacing_m);
  cuts_.clear();
  if (last - first > kMostEdges) {
    for (int part = 1; part < kMostEdges; ++part) cuts_.push_back(static_cast<double>(part) / kMostEdges);
  } else {
    for (double edge_index = first; edge_index <= last; ++edge_index) {
      const double edge = bins_.r_min_m + edge_index * bins_.range_spacing_m;
      for (const double h : {wall.t0, wall.t1}) {
        const double d2 = edge * edge - h * h;
        if (!(d2 > 0)) continue;
        const double at = (1 / std::sqrt(d2) - over_left) / (over_right - over_left);
        if (at > 0 && at < 1) cuts_.push_back(at);
      }
    }
  }
  cuts_.push_back(1);
  std::sort(cuts_.begin(), cuts_.end());
  double from = 0;
  for (const double to : cuts_) {
    if (!(to > from)) continue;
    const double off = ((from + to) / 2 - 0.5) * whole.width_rad;
    share_.bearing = direction(off);
    share_.azimuth_offset_rad = whole.azimuth_offset_rad + off;
    share_.width_rad = (to - from) * whole.width_rad;
    VisibleSegment part = wall;
    part.d_m = 1 / over_d(share_.bearing);
    // The foot follows the roof or the ground that it stands on; where something in front hides it, that
    // one's shadow.
    if (wall.foot == VisibleSegment::Foot::hidden) part.t0 = wall.t0 * part.d_m / wall.d_m;
    if (wall.foot == VisibleSegment::Foot::ground) {
      const double ground_y_m = grid_.height_at_m(antenna_m_.x + part.d_m * share_.bearing.sin,
                                                  antenna_m_.z + part.d_m * share_.bearing.cos);
      if (!std::isnan(ground_y_m)) part.t0 = ground_y_m - antenna_m_.y;
    }
    part.t0 = std::min(part.t0, part.t1);
    straight(part);
    from = to;
  }
  share_ = whole;
}

void PieceSampler::straight(const VisibleSegment& piece) {
  const At from = at(piece, piece.t0);
  const At to = at(piece, piece.t1);
  // Range along a line is convex: nothing between the ends is farther than both of them.
  if (from.r_m < bins_.r_min_m && to.r_m < bins_.r_min_m) return;
  // Between t0 and t1 lies the foot of the perpendicular from the antenna, where range turns, when range
  // falls at t0 and rises at t1.
  const double rate2 = piece.rate_d * piece.rate_d + piece.rate_h * piece.rate_h;
  const double along = piece.d_m * piece.rate_d + piece.h_m * piece.rate_h;
  if (along + rate2 * piece.t0 < 0 && along + rate2 * piece.t1 > 0) {
    const At turn = at(piece, std::clamp(-along / rate2, piece.t0, piece.t1));
    cut_at_bins(piece, from, turn);
    cut_at_bins(piece, turn, to);
  } else {
    cut_at_bins(piece, from, to);
  }
}

void PieceSampler::cut_at_bins(const VisibleSegment& piece, At from, At to) {
  const double least = std::min(from.r_m, to.r_m);
  const double most = std::max(from.r_m, to.r_m);
  if (most < bins_.r_min_m || least >= bins_.r_max_m) return;
  // Rounding may take a range within 1e-16 of an edge for one beyond it: a part without extent.
  const auto bin_of = [&](double r) { return static_cast<int>((r - bins_.r_min_m) * bins_per_m_); };
  const int first = least < bins_.r_min_m ? -1 : bin_of(least);
  const int last = most >= bins_.r_max_m ? bins_.n_range : bin_of(most);
  if (first == last) {
    add_part(piece, from, to, 0);
    return;
  }
  const bool outwards = to.r_m > from.r_m;
  const double rate2 = piece.rate_d * piece.rate_d + piece.rate_h * piece.rate_h;
  const double along = piece.d_m * piece.rate_d + piece.h_m * piece.rate_h;
  const double cross = piece.d_m * piece.rate_h - piece.h_m * piece.rate_d;
  const int steps = last - first;
  At previous = from;
  for (int k = 1; k <= steps; ++k) {
    const int edge_index = outwards ? first + k : last - k + 1;
    const double edge = bins_.edge_m(static_cast<double>(edge_index));
    const At here{edge_at(rate2, along, cross, outwards ? 1.0 : -1.0, edge, previous.t, to.t), edge};
    const int bin = outwards ? edge_index - 1 : edge_index;
    if (bin >= 0 && bin < bins_.n_range) add_part(piece, previous, here, 0);
    previous = here;
  }
  const int bin = outwards ? last : first;
  if (bin >= 0 && bin < bins_.n_range) add_part(piece, previous, to, 0);
}

void PieceSampler::add_part(const VisibleSegment& piece, At from, At to, int depth) {
  const double d0 = piece.ground_range_m(from.t);
  const double h0 = piece.height_m(from.t);
  const double d1 = piece.ground_range_m(to.t);
  const double h1 = piece.height_m(to.t);
  const double cross = (piece.d_m * piece.rate_h - piece.h_m * piece.rate_d) * (to.t - from.t);
  if (!(cross > 0)) return;
  const auto part = part_of(cross, d0, h0, from.r_m, d1, h1, to.r_m);
  if (part.turn_sin > kTurn_rad * part.turn_cos && depth < 40) {
    const At middle = at(piece, (from.t + to.t) / 2);
    if (middle.t > from.t && middle.t < to.t) {
      add_part(piece, from, middle, depth + 1);
      add_part(piece, middle, to, depth + 1);
      return;
    }
  }
  const double over_r = 1 / part.range_m;
  ++samples_;
  put({share_.azimuth_bin, part.range_m, share_.width_rad * part.share,
       std::min(1.0, piece.plane_distance_m * over_r), share_.azimuth_offset_rad, part.height_m * over_r,
       antenna_m_.x + part.distance_m * share_.bearing.sin,
       antenna_m_.z + part.distance_m * share_.bearing.cos, piece.face, piece.material});
}

}  // namespace obliq
