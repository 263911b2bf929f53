// Buildings by azimuth bin: the bins of each circle in float lanes, then a counting sort, both by chunks of
// buildings whose number does not depend on the threads.
#include "server/radar/geometry/azimuth_buildings.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "server/radar/geometry/circle_axes.h"
#include "server/radar/geometry/silhouettes.h"
#include "terrain/base/parallel.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBlock = 1024;  // buildings whose bins are worked out before they are used
constexpr std::size_t kLeastForThreads = 50000;
constexpr std::size_t kMostChunks = 16;

/// How far off a bearing may be that is worked out in floats: 2e-8 for the polynomial, a dozen roundings of
/// 2^-24 of at most pi. tests/unit/radar_azimuth_buildings_test.cpp has the least that serves.
constexpr double kBearingMargin_rad = 4e-6;

/// Bins narrower than this are found in double.
constexpr double kNarrow_rad = 1e-6;

/// Bins from `first` to `last`; where last < first, from `first` to the end and from 0 to `last`.
struct BinSpan {
  std::int32_t first;
  std::int32_t last;  // kNoBin: none
};
constexpr std::int32_t kNoBin = -1;
constexpr std::int32_t kLookCloser = -2;  // as `last`: the circle does not tell

struct Spans {
  std::int32_t first[kBlock];
  std::int32_t last[kBlock];
};

/// Bins of circles, in floats.
class CircleBins {
 public:
  CircleBins(const BuildingCircles& circles, const Sector& sector, const BinGrid& bins, double reach_m)
      : circles_(circles), axes_(circles, sector) {
    reach_m_ = static_cast<float>(reach_m);
    n_ = static_cast<float>(bins.n_azimuth);
    start_rad_ = static_cast<float>(bins.azimuth_start_rad);
    end_rad_ = static_cast<float>(bins.azimuth_start_rad + bins.n_azimuth * bins.azimuth_width_rad);
    narrow_ = !(bins.azimuth_width_rad > kNarrow_rad);
    per_rad_ = narrow_ ? 0.0f : static_cast<float>(1 / bins.azimuth_width_rad);
  }

  /// Of `count` buildings from `from` on. Without branches, so that the compiler takes several at a time.
  void find(std::size_t from, int count, Spans& spans) const {
    constexpr auto pi = static_cast<float>(kPi);
    constexpr auto margin_rad = static_cast<float>(kBearingMargin_rad);
    const float* x_m = circles_.x_m.data() + from;
    const float* z_m = circles_.z_m.data() + from;
    const float* radius_m = circles_.radius_m.data() + from;
    for (int k = 0; k < count; ++k) {
      const float right = axes_.right_m(x_m[k], z_m[k]);
      const float ahead = axes_.ahead_m(x_m[k], z_m[k]);
      const float radius = radius_m[k] + axes_.error_m;
      const float radius2 = radius * radius;
      const float distance2 = right * right + ahead * ahead;
      const float bearing = bearing_of(right, ahead);
      // The tangent of half the angle that the circle fills, which is larger than the angle.
      const float beyond2 = distance2 - radius2;
      const float half = radius / std::sqrt(beyond2 > 0 ? beyond2 : 1.0f) * 1.00001f + margin_rad;
      const float low = bearing - half;
      const float high = bearing + half;
      const float first = clamped((low - start_rad_) * per_rad_, n_);
      const float last = clamped((high - start_rad_) * per_rad_ + 1, n_);
      const auto first_bin = static_cast<std::int32_t>(first);
      const std::int32_t last_bin = static_cast<std::int32_t>(last) - 1;
      const float far = reach_m_ + radius;
      const bool in_reach = distance2 <= far * far * 1.00001f;
      const bool within = in_reach & (high >= start_rad_) & (low <= end_rad_);
      const bool turns_over = (high >= start_rad_ + 2 * pi) | (low <= end_rad_ - 2 * pi);
      const bool closer = (beyond2 < 0.05f * radius2) | (in_reach & turns_over) | (within & narrow_);
      const std::int32_t none_or_bin = within & (first_bin <= last_bin) ? last_bin : kNoBin;
      spans.first[k] = first_bin;
      spans.last[k] = closer ? kLookCloser : none_or_bin;
    }
  }

 private:
  static float clamped(float value, float most) {
    const float positive = value > 0 ? value : 0.0f;
    return positive < most ? positive : most;
  }

  /// atan2(right, ahead) by the polynomial for the arc tangent of M. Abramowitz, I. Stegun, "Handbook of
  /// Mathematical Functions", 4.4.49, off by 2e-8 at most.
  static float bearing_of(float right, float ahead) {
    const float to_right = std::abs(right);
    const float along = std::abs(ahead);
    const bool steep = to_right > along;
    const float large = steep ? to_right : along;
    const float small = steep ? along : to_right;
    const float t = small / (large > 0 ? large : 1.0f);
    const float z = t * t;
    const float arc =
        t *
        (1 + z * (-0.3333314528f +
                  z * (0.1999355085f +
                       z * (-0.1420889944f +
                            z * (0.1065626393f +
                                 z * (-0.0752896400f +
                                      z * (0.0429096138f + z * (-0.0161657367f + z * 0.0028662257f))))))));
    const float quarter = steep ? static_cast<float>(kPi / 2) - arc : arc;
    const float half = ahead < 0 ? static_cast<float>(kPi) - quarter : quarter;
    return std::copysign(half, right);
  }

  const BuildingCircles& circles_;
  CircleAxes axes_;
  float reach_m_, n_, start_rad_, end_rad_, per_rad_;
  bool narrow_;
};

/// The bins of a building by its corners.
BinSpan exact_bins(const Buildings& all, const Sector& sector, const BinGrid& bins, double reach_m,
                   std::uint32_t building) {
  const BuildingBounds seen = bounds_of(all, sector, building);
  BinSpan span{0, kNoBin};
  if (seen.near_m > reach_m) return span;
  // In doubles until clamped: a narrow sector makes bin numbers that fit no integer.
  const double end = bins.n_azimuth - 1;
  for (int turn = -1; turn <= 1; ++turn) {
    const double from = seen.from_rad + turn * 2 * kPi, to = seen.to_rad + turn * 2 * kPi;
    const double a = std::floor((from - bins.azimuth_start_rad) / bins.azimuth_width_rad - 1e-9);
    const double z = std::floor((to - bins.azimuth_start_rad) / bins.azimuth_width_rad + 1e-9);
    if (!(a <= end && z >= 0)) continue;
    const BinSpan next{static_cast<std::int32_t>(std::max(0.0, a)),
                       static_cast<std::int32_t>(std::min(end, z))};
    // Of two stretches, a turn apart, the first begins at bin 0 and the second ends at the last one.
    if (span.last == kNoBin)
      span = next;
    else if (next.first <= span.last + 1)
      return {0, bins.n_azimuth - 1};
    else
      span = {next.first, span.last};
  }
  return span;
}

template <typename Use>
void for_each_bin(const BinSpan& span, std::int32_t n_bins, Use&& use) {
  if (span.last < 0) return;
  const bool round = span.last < span.first;
  if (round)
    for (std::int32_t bin = 0; bin <= span.last; ++bin) use(bin);
  for (std::int32_t bin = span.first; bin <= (round ? n_bins - 1 : span.last); ++bin) use(bin);
}

}  // namespace

AzimuthBuildings::AzimuthBuildings(const Scene& scene, const Sector& sector, const BinGrid& bins,
                                   double reach_m)
    : n_buildings_(scene.circles().size()), start_(static_cast<std::size_t>(bins.n_azimuth) + 1) {
  const std::size_t n = n_buildings_;
  const auto n_bins = static_cast<std::size_t>(bins.n_azimuth);
  const std::size_t n_chunks = n < kLeastForThreads ? 1 : kMostChunks;
  const CircleBins circle_bins(scene.circles(), sector, bins, reach_m);
  const auto spans = std::make_unique_for_overwrite<BinSpan[]>(n);
  std::vector<std::uint32_t> next(n_chunks * n_bins);  // first counts, then where a chunk's next one goes
  const auto chunk_from = [&](std::size_t chunk) { return n * chunk / n_chunks; };
  const auto for_each_chunk = [&](const std::function<void(int)>& work) {
    if (n_chunks == 1) return work(0);
    for_each_row(static_cast<int>(n_chunks), work);
  };

  for_each_chunk([&](int index) {
    const auto chunk = static_cast<std::size_t>(index);
    std::uint32_t* counts = next.data() + chunk * n_bins;
    Spans found;
    for (std::size_t from = chunk_from(chunk), end = chunk_from(chunk + 1); from < end; from += kBlock) {
      const int count = static_cast<int>(std::min<std::size_t>(kBlock, end - from));
      circle_bins.find(from, count, found);
      for (int k = 0; k < count; ++k) {
        const std::size_t b = from + static_cast<std::size_t>(k);
        BinSpan span{found.first[k], found.last[k]};
        if (span.last == kLookCloser)
          span = exact_bins(scene.world().buildings, sector, bins, reach_m, static_cast<std::uint32_t>(b));
        for_each_bin(span, bins.n_azimuth, [&](std::int32_t bin) { ++counts[bin]; });
        spans[b] = span;
      }
    }
  });

  std::uint32_t sum = 0;
  for (std::size_t bin = 0; bin < n_bins; ++bin) {
    start_[bin] = sum;
    for (std::size_t chunk = 0; chunk < n_chunks; ++chunk) {
      std::uint32_t& count = next[chunk * n_bins + bin];
      sum += std::exchange(count, sum);
    }
  }
  start_[n_bins] = sum;
  buildings_ = std::make_unique_for_overwrite<std::uint32_t[]>(sum);

  for_each_chunk([&](int index) {
    const auto chunk = static_cast<std::size_t>(index);
    std::uint32_t* to = next.data() + chunk * n_bins;
    for (std::size_t b = chunk_from(chunk), end = chunk_from(chunk + 1); b < end; ++b)
      for_each_bin(spans[b], bins.n_azimuth,
                   [&](std::int32_t bin) { buildings_[to[bin]++] = static_cast<std::uint32_t>(b); });
  });
}

std::vector<std::uint32_t> AzimuthBuildings::in(AzimuthRange range) const {
  const auto first = static_cast<std::size_t>(range.first);
  const std::uint32_t* begin = buildings_.get() + start_[first];
  const std::uint32_t* end = buildings_.get() + start_[first + static_cast<std::size_t>(range.count)];
  std::vector<std::uint32_t> buildings;
  if (begin == end) return buildings;
  // A bit a building brings them into order.
  const auto [least, most] = std::minmax_element(begin, end);
  const std::uint32_t from = *least / 64;
  std::vector<std::uint64_t> present(*most / 64 - from + 1);
  for (const std::uint32_t* b = begin; b < end; ++b) present[*b / 64 - from] |= std::uint64_t{1} << (*b % 64);
  buildings.reserve(static_cast<std::size_t>(end - begin));
  for (std::size_t word = 0; word < present.size(); ++word)
    for (std::uint64_t bits = present[word]; bits != 0; bits &= bits - 1)
      buildings.push_back(static_cast<std::uint32_t>((from + word) * 64) +
                          static_cast<std::uint32_t>(std::countr_zero(bits)));
  return buildings;
}

}  // namespace obliq
