#include "server/radar/rays/perspective_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "server/radar/geometry/sector.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Tangent of a bearing offset as the start or the end of an interval. Ahead of the antenna tangents rise
/// from -infinity to infinity, and so they do on each side behind it.
double tangent(double offset, bool start) {
  if (std::abs(std::abs(offset) - kPi / 2) < 1e-12) return start ? -kInfinity : kInfinity;
  const SinCos at = sincos_turns(offset / (2 * kPi));
  return at.sin / at.cos;
}

/// An edge that only rounding keeps from abeam lies there: no sliver of a bin is beyond it, whose tangents
/// would span whole rows.
double at_cut(double offset) {
  const double cut = std::copysign(kPi / 2, offset);
  return std::abs(offset - cut) < 1e-12 ? cut : offset;
}

PixelCamera pixel_camera(const ScenePlan& plan) {
  const PerspectiveFrustum& camera = plan.camera();
  const double width = camera.pixel_width_m();
  const double height = camera.pixel_height_m();
  return {camera.left_m,
          width,
          plan.sector().sin_bearing,
          plan.sector().cos_bearing,
          width * height * camera.near_m,
          camera.wide_m2(),
          swath_test(plan.box(), plan.sector()),
          plan.settings().plates == PlateKind::spread ? std::hypot(width, height) / 2 : 0.0};
}

}  // namespace

PerspectiveRays::PerspectiveRays(const ScenePlan& plan, AzimuthRange range)
    : camera_(plan.camera()), pixel_camera_(pixel_camera(plan)) {
  for (int bin = range.first; bin < range.first + range.count; ++bin)
    add_intervals(bin, at_cut(plan.bins().azimuth_edge_rad(bin)),
                  at_cut(plan.bins().azimuth_edge_rad(bin + 1)));
}

bool PerspectiveRays::generate(RayBatch& batch) {
  for (pixels_.n = 0; pixels_.n < kBatch;) {
    if (taken_ == waiting_.size()) {
      if (next_row_ >= camera_.rows) break;
      begin_rows();
      continue;
    }
    // Squares are not divided among batches, where rows are short enough.
    const auto room = static_cast<std::size_t>(kBatch - pixels_.n);
    const std::size_t n = waiting_.size() - taken_;
    if (n > room && pixels_.n > 0) break;
    take(std::min(n, room));
  }
  generate_waiting(batch);
  return pixels_.n > 0;
}

/// Adds waiting pixels to the current ones.
void PerspectiveRays::take(std::size_t n) {
  const auto first = static_cast<std::size_t>(pixels_.n);
  const bool whole = taken_ == 0 && n == waiting_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Pixel& pixel = waiting_[taken_ + k];
    pixels_.column[first + k] = pixel.column;
    pixels_.row[first + k] = pixel.row;
    pixels_.bin[first + k] = pixel.bin;
    pixels_.up_m[first + k] = pixel.up_m;
    pixels_.ahead_m[first + k] = pixel.ahead_m;
    packet_order_[first + k] =
        static_cast<std::uint16_t>(first + (whole ? static_cast<std::size_t>(by_squares_[k]) : k));
  }
  taken_ += n;
  pixels_.n += static_cast<int>(n);
}

void PerspectiveRays::add_intervals(int bin, double from, double to) {
  double start = from;
  for (const double cut : {-kPi / 2, kPi / 2, kInfinity}) {
    const double end = std::min(cut, to);
    if (end > start) {
      const double middle = (start + end) / 2;
      intervals_.push_back({bin, std::abs(middle) < kPi / 2, tangent(start, true), tangent(end, false)});
      start = end;
    }
    if (cut >= to) break;
  }
}

int PerspectiveRays::column_at(double x_m) const {
  const double column = (x_m - camera_.left_m) / camera_.pixel_width_m() - 0.5;
  if (!(column > 0)) return 0;
  if (!(column < camera_.columns)) return camera_.columns;
  return static_cast<int>(std::ceil(column));
}

/// The next rows and their pixels.
void PerspectiveRays::begin_rows() {
  waiting_.clear();
  taken_ = 0;
  std::array<PixelSpan, kSquare> spans;
  for (int k = 0; k < kSquare && next_row_ + k < camera_.rows; ++k)
    spans[static_cast<std::size_t>(k)] = add_row(next_row_ + k);
  const PixelRows rows(next_row_, spans);
  next_row_ += kSquare;
  ask(4 * static_cast<std::int64_t>(waiting_.size() + kSquare * intervals_.size()));
  by_squares_.resize(waiting_.size());
  if (static_cast<std::size_t>(rows.size()) == waiting_.size()) {
    std::size_t at = 0;
    rows.by_squares([this, &at](int n) { by_squares_[at++] = n; });
  } else {  // a row has gaps
    std::iota(by_squares_.begin(), by_squares_.end(), 0);
  }
}

/// Adds the row's pixels; returns the columns that they span.
PixelSpan PerspectiveRays::add_row(int row) {
  const glm::dvec3 direction = camera_.direction(0, row);
  // A row exactly abeam is treated as a hair ahead: the tangents need a side.
  const double ahead = direction.z == 0 ? std::numeric_limits<double>::min() : direction.z;
  runs_.clear();
  double last_tan = 0;
  int last_column = -1;  // of last_tan: mostly the next interval begins there
  for (const BearingInterval& interval : intervals_) {
    if (interval.ahead != (ahead > 0)) continue;
    const bool joined = last_column >= 0 && interval.tan_from == last_tan;
    const int a = joined ? last_column : column_at(ahead * interval.tan_from);
    const int b = column_at(ahead * interval.tan_to);
    last_tan = interval.tan_to;
    last_column = b;
    if (a != b) runs_.push_back({interval.bin, {std::min(a, b), std::max(a, b)}});
  }
  if (runs_.empty()) return {};
  const auto by_column = [](const Run& a, const Run& b) { return a.columns.from < b.columns.from; };
  if (!std::is_sorted(runs_.begin(), runs_.end(), by_column))
    std::sort(runs_.begin(), runs_.end(), by_column);
  const PixelSpan span{runs_.front().columns.from, runs_.back().columns.to};
  const bool backwards = row % 2 == 1;
  if (backwards) std::reverse(runs_.begin(), runs_.end());
  std::size_t at = waiting_.size();
  std::size_t n_pixels = 0;
  for (const Run& run : runs_) n_pixels += static_cast<std::size_t>(run.columns.to - run.columns.from);
  waiting_.resize(at + n_pixels);
  for (const Run& run : runs_) {
    const int n = run.columns.to - run.columns.from;
    const int first = backwards ? run.columns.to - 1 : run.columns.from;
    for (int k = 0; k < n; ++k)
      waiting_[at++] = {row, backwards ? first - k : first + k, run.bin, direction.y, ahead};
  }
  return span;
}

/// The rays of the current pixels that reach the swath.
void PerspectiveRays::generate_waiting(RayBatch& batch) {
  // Padded to a multiple of 8; the values are ignored.
  for (auto k = static_cast<std::size_t>(pixels_.n); k % 8 != 0; ++k) {
    pixels_.column[k] = 0;
    pixels_.up_m[k] = pixels_.ahead_m[k] = 1;
  }
  std::array<std::int32_t, kBatch> from;
  std::array<std::int32_t, kBatch> ray_of;
  std::fill_n(ray_of.begin(), pixels_.n, -1);
  batch.n = active_kernels().pixel_rays(
      pixel_camera_, pixels_,
      {batch.dir_x.data(), batch.dir_y.data(), batch.dir_z.data(), batch.solid_angle_sr.data(), from.data()});
  for (std::size_t k = 0; k < static_cast<std::size_t>(batch.n); ++k) {
    const auto at = static_cast<std::size_t>(from[k]);
    ray_of[at] = static_cast<std::int32_t>(k);
    batch.azimuth_bin[k] = pixels_.bin[at];
    batch.pixel[k] =
        static_cast<std::uint32_t>(pixels_.row[at]) * static_cast<std::uint32_t>(camera_.columns) +
        static_cast<std::uint32_t>(pixels_.column[at]);
    if (std::isnan(batch.solid_angle_sr[k]))
      batch.solid_angle_sr[k] = camera_.wide_solid_angle_sr(pixels_.column[at], pixels_.row[at]);
  }
  std::size_t n = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(pixels_.n); ++k)
    if (const std::int32_t ray = ray_of[packet_order_[k]]; ray >= 0)
      batch.packet_order[n++] = static_cast<std::uint16_t>(ray);
}

}  // namespace obliq
