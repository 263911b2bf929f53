#include "server/radar/piece_sampler.h"

#include <algorithm>
#include <cmath>

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

void PieceSampler::visible(const VisiblePiece& piece) {
  if (!(share_.width_rad > 0)) return;
  const At from = at(piece, piece.t0);
  const At to = at(piece, piece.t1);
  // Range along a line is convex: nothing between the ends is farther than both of them.
  if (from.r_m < bins_.r_min_m && to.r_m < bins_.r_min_m) return;
  // The foot of the perpendicular from the antenna, where range turns.
  const double rate2 = piece.rate_d * piece.rate_d + piece.rate_h * piece.rate_h;
  const double foot = -(piece.d_m * piece.rate_d + piece.h_m * piece.rate_h) / rate2;
  if (foot > piece.t0 && foot < piece.t1) {
    const At turn = at(piece, foot);
    cut_at_bins(piece, from, turn);
    cut_at_bins(piece, turn, to);
  } else {
    cut_at_bins(piece, from, to);
  }
}

void PieceSampler::cut_at_bins(const VisiblePiece& piece, At from, At to) {
  const double least = std::min(from.r_m, to.r_m);
  const double most = std::max(from.r_m, to.r_m);
  if (most < bins_.r_min_m || least >= bins_.r_max_m) return;
  const int first = least < bins_.r_min_m ? -1 : bins_.range_bin(least);
  const int last = most >= bins_.r_max_m ? bins_.n_range : bins_.range_bin(most);
  if (first == last) {
    part(piece, from, to, 0);
    return;
  }
  // |A + t D|^2 = edge^2: t = (-A.D +- sqrt(D.D edge^2 - (A x D)^2)) / D.D, by Lagrange's identity without
  // the cancellation of the usual discriminant. Range grows with t beyond the foot and falls before it.
  const bool outwards = to.r_m > from.r_m;
  const double rate2 = piece.rate_d * piece.rate_d + piece.rate_h * piece.rate_h;
  const double along = piece.d_m * piece.rate_d + piece.h_m * piece.rate_h;
  const double cross = piece.d_m * piece.rate_h - piece.h_m * piece.rate_d;
  const int steps = last - first;
  At previous = from;
  for (int k = 1; k <= steps; ++k) {
    const int edge_index = outwards ? first + k : last - k + 1;
    const double edge =
        edge_index == bins_.n_range ? bins_.r_max_m : bins_.r_min_m + edge_index * bins_.range_spacing_m;
    const double root = std::sqrt(std::max(0.0, rate2 * edge * edge - cross * cross));
    const double t = std::clamp((outwards ? root - along : -root - along) / rate2, previous.t, to.t);
    const At here{t, edge};
    const int bin = outwards ? edge_index - 1 : edge_index;
    if (bin >= 0 && bin < bins_.n_range) part(piece, previous, here, 0);
    previous = here;
  }
  const int bin = outwards ? last : first;
  if (bin >= 0 && bin < bins_.n_range) part(piece, previous, to, 0);
}

void PieceSampler::part(const VisiblePiece& piece, At from, At to, int depth) {
  const double d0 = piece.ground_range_m(from.t);
  const double h0 = piece.height_m(from.t);
  const double d1 = piece.ground_range_m(to.t);
  const double h1 = piece.height_m(to.t);
  // r0 r1 sin and cos of the angle between the ends; the cross product of points of one line is that of the
  // line times the step, so that a tiny piece loses no digits.
  const double cross = (piece.d_m * piece.rate_h - piece.h_m * piece.rate_d) * (to.t - from.t);
  const double dot = d0 * d1 + h0 * h1;
  if (!(cross > 0)) return;
  if (cross > kTurn_rad * dot && depth < 40) {
    const At middle = at(piece, (from.t + to.t) / 2);
    if (middle.t > from.t && middle.t < to.t) {
      part(piece, from, middle, depth + 1);
      part(piece, middle, to, depth + 1);
      return;
    }
  }
  // sin e1 - sin e0 = sin(e1 - e0) (cos e0 + cos e1) / (1 + cos(e1 - e0)).
  const double r00 = from.r_m * from.r_m;
  const double r01 = from.r_m * to.r_m;
  const double r11 = to.r_m * to.r_m;
  const double rise = cross * (d0 * to.r_m + d1 * from.r_m) / (r01 * (r01 + dot));
  // The range whose 1 / r^2 is the mean over the piece. Over level ground 1 / r is linear in sin e, and the
  // mean of its square is exactly this.
  const double r = std::clamp(r01 * std::sqrt(3 / (r00 + r01 + r11)), std::min(from.r_m, to.r_m),
                              std::max(from.r_m, to.r_m));
  const double d = (d0 + d1) / 2;
  ++samples_;
  put({share_.azimuth_bin, r, share_.width_rad * rise, std::min(1.0, piece.plane_distance_m / r),
       share_.azimuth_offset_rad, (h0 + h1) / 2 / r, antenna_m_.x + d * share_.bearing.sin,
       antenna_m_.z + d * share_.bearing.cos, piece.face, piece.material});
}

}  // namespace obliq
