#include "server/radar/sweep/segment_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/simd/ground/range_run.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {
constexpr int kAnEdge = 10;  // of a range bin on a segment, in units of ask()
}

void SegmentSampler::begin(SampleBatch& batch) {
  batch_ = &batch;
  batch.n = 0;
  const auto end =
      waiting_.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(waiting_.size(), kBatch));
  std::for_each(waiting_.begin(), end, [&](const Sample& sample) { batch.push(sample); });
  waiting_.erase(waiting_.begin(), end);
}

void SegmentSampler::put(const Sample& sample) {
  if (batch_->full() || !waiting_.empty()) {
    waiting_.push_back(sample);
  } else {
    batch_->push(sample);
  }
}

void SegmentSampler::visible(const VisibleSegment& segment) {
  if (!(share_.width_rad > 0)) return;
  if (segment.wall) {
    aslant(segment);
  } else {
    straight(segment);
  }
}

void SegmentSampler::aslant(const VisibleSegment& wall) {
  // The wall is the line n.p = -distance from the antenna: at a bearing off the plane's by `off` it stands at
  // 1 / d = -n.direction / distance. That is a cosine of the bearing, nearly straight across a strand.
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
  // it leaves at the top (or the other way round) it is nearly straight, and the plane in the middle of
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

void SegmentSampler::straight(const VisibleSegment& segment) {
  const At from = at(segment, segment.t0);
  const At to = at(segment, segment.t1);
  // Range along a line is convex: nothing between the ends is farther than both of them.
  if (from.r_m < bins_.r_min_m && to.r_m < bins_.r_min_m) return;
  // Between t0 and t1 lies the foot of the perpendicular from the antenna, where range turns, when range
  // falls at t0 and rises at t1.
  const double rate2 = segment.rate_d * segment.rate_d + segment.rate_h * segment.rate_h;
  const double along = segment.d_m * segment.rate_d + segment.h_m * segment.rate_h;
  if (along + rate2 * segment.t0 < 0 && along + rate2 * segment.t1 > 0) {
    const At turn = at(segment, std::clamp(-along / rate2, segment.t0, segment.t1));
    cut_at_bins(segment, from, turn);
    cut_at_bins(segment, turn, to);
  } else {
    cut_at_bins(segment, from, to);
  }
}

void SegmentSampler::cut_at_bins(const VisibleSegment& segment, At from, At to) {
  const double least = std::min(from.r_m, to.r_m);
  const double most = std::max(from.r_m, to.r_m);
  if (most < bins_.r_min_m || least >= bins_.r_max_m) return;
  // Rounding may take a range within 1e-16 of an edge for one beyond it: a part without extent.
  const auto bin_of = [&](double r) { return static_cast<int>((r - bins_.r_min_m) * bins_per_m_); };
  const int first = least < bins_.r_min_m ? -1 : bin_of(least);
  const int last = most >= bins_.r_max_m ? bins_.n_range : bin_of(most);
  if (first == last) {
    add_part(segment, from, to, 0);
    return;
  }
  const bool outwards = to.r_m > from.r_m;
  const double rate2 = segment.rate_d * segment.rate_d + segment.rate_h * segment.rate_h;
  const double along = segment.d_m * segment.rate_d + segment.h_m * segment.rate_h;
  const double cross = segment.d_m * segment.rate_h - segment.h_m * segment.rate_d;
  const int steps = last - first;
  ask(kAnEdge * steps);
  At previous = from;
  for (int k = 1; k <= steps; ++k) {
    const int edge_index = outwards ? first + k : last - k + 1;
    const double edge = bins_.edge_m(static_cast<double>(edge_index));
    const At here{edge_at(rate2, along, cross, outwards ? 1.0 : -1.0, edge, previous.t, to.t), edge};
    const int bin = outwards ? edge_index - 1 : edge_index;
    if (bin >= 0 && bin < bins_.n_range) add_part(segment, previous, here, 0);
    previous = here;
  }
  const int bin = outwards ? last : first;
  if (bin >= 0 && bin < bins_.n_range) add_part(segment, previous, to, 0);
}

void SegmentSampler::add_part(const VisibleSegment& segment, At from, At to, int depth) {
  const double d0 = segment.ground_range_m(from.t);
  const double h0 = segment.height_m(from.t);
  const double d1 = segment.ground_range_m(to.t);
  const double h1 = segment.height_m(to.t);
  const double cross = (segment.d_m * segment.rate_h - segment.h_m * segment.rate_d) * (to.t - from.t);
  if (!(cross > 0)) return;
  const auto part = part_of(cross, d0, h0, from.r_m, d1, h1, to.r_m);
  if (part.turn_sin > turn_rad_ * part.turn_cos && depth < 40) {
    const At middle = at(segment, (from.t + to.t) / 2);
    if (middle.t > from.t && middle.t < to.t) {
      add_part(segment, from, middle, depth + 1);
      add_part(segment, middle, to, depth + 1);
      return;
    }
  }
  const double over_r = 1 / part.range_m;
  put({share_.azimuth_bin, part.range_m, share_.width_rad * part.share,
       std::min(1.0, segment.plane_distance_m * over_r), share_.azimuth_offset_rad, part.height_m * over_r,
       antenna_m_.x + part.distance_m * share_.bearing.sin,
       antenna_m_.z + part.distance_m * share_.bearing.cos, segment.face, segment.material,
       segment.raster_gamma});
}

}  // namespace obliq
