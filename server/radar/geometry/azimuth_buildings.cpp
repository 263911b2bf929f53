// Buildings by azimuth bin: the bins of each circle, then a counting sort, both by chunks of
// buildings whose number does not depend on the threads.
#include "server/radar/geometry/azimuth_buildings.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <utility>

#include "server/radar/geometry/circle_axes.h"
#include "server/radar/geometry/silhouettes.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"
#include "terrain/base/parallel.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr std::size_t kBlock = 1024;  // buildings whose bins are worked out before they are used
constexpr std::size_t kLeastForThreads = 50000;
constexpr std::size_t kMostChunks = 16;
constexpr std::size_t kLeastRun = 64;  // buildings of a chunk at a time
constexpr std::int64_t kCorners = 20;  // bounds_of, in units of ask()

/// Bins narrower than this are found in double.
constexpr double kNarrow_rad = 1e-6;

/// Bins from `first` to `last`; where last < first, from `first` to the end and from 0 to `last`.
struct BinSpan {
  std::int32_t first;
  std::int32_t last;  // kNoBin: none
};

CircleSector circle_sector(const BuildingCircles& circles, const Sector& sector, const BinGrid& bins,
                           double reach_m) {
  const bool narrow = !(bins.azimuth_width_rad > kNarrow_rad);
  return {circle_axes(circles, sector),
          static_cast<float>(reach_m),
          static_cast<float>(bins.azimuth_start_rad),
          static_cast<float>(bins.azimuth_start_rad + bins.n_azimuth * bins.azimuth_width_rad),
          narrow ? 0.0f : static_cast<float>(1 / bins.azimuth_width_rad),
          bins.n_azimuth};
}

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

std::int64_t bins_of(const BinSpan& span, std::int32_t n_bins) {
  if (span.last < 0) return 0;
  return span.last + 1 - span.first + (span.last < span.first ? n_bins : 0);
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
                                   double reach_m, bool by_corners)
    : n_buildings_(scene.circles().size()), start_(static_cast<std::size_t>(bins.n_azimuth) + 1) {
  const std::size_t n = n_buildings_;
  const auto n_bins = static_cast<std::size_t>(bins.n_azimuth);
  const std::size_t n_chunks = n < kLeastForThreads ? 1 : kMostChunks;
  const CircleSector circle_bins = circle_sector(scene.circles(), sector, bins, reach_m);
  const Kernels& kernels = active_kernels();
  const auto spans = std::make_unique_for_overwrite<BinSpan[]>(n);
  std::vector<std::uint32_t> next(n_chunks * n_bins);  // first counts, then where a chunk's next one goes
  const auto chunk_from = [&](std::size_t chunk) { return n * chunk / n_chunks; };
  // Some buildings of every chunk at a time, and more of them where they take little: only this thread asks.
  using Work = std::function<std::int64_t(std::size_t chunk, std::size_t from, std::size_t count)>;
  const auto for_each_run = [&](const Work& work) {
    std::vector<std::size_t> at(n_chunks);
    for (std::size_t chunk = 0; chunk < n_chunks; ++chunk) at[chunk] = chunk_from(chunk);
    for (std::size_t most = kLeastRun;;) {
      std::atomic<std::int64_t> done = 0;
      const auto take = [&](int index) {
        const auto chunk = static_cast<std::size_t>(index);
        for (std::size_t left = most; left > 0 && at[chunk] < chunk_from(chunk + 1);) {
          const std::size_t count = std::min({kBlock, left, chunk_from(chunk + 1) - at[chunk]});
          done += work(chunk, at[chunk], count);
          at[chunk] += count;
          left -= count;
        }
      };
      if (n_chunks == 1) {
        take(0);
      } else {
        for_each_row(static_cast<int>(n_chunks), take);
      }
      if (done == 0) return;
      ask(done);
      if (done < WorkGate::kLook) most *= 2;
      if (done > 2 * WorkGate::kLook) most = std::max(kLeastRun, most / 2);
    }
  };

  for_each_run([&](std::size_t chunk, std::size_t from, std::size_t count) {
    std::uint32_t* counts = next.data() + chunk * n_bins;
    std::array<std::int32_t, kBlock> first, last;
    std::int64_t done = static_cast<std::int64_t>(count) * (by_corners ? kCorners : 1);
    kernels.circle_bins(circle_bins, circle_run(scene.circles(), from, count), first.data(), last.data());
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t b = from + k;
      BinSpan span{first[k], last[k]};
      if (span.last == kLookCloser || by_corners)
        span = exact_bins(scene.world().buildings, sector, bins, reach_m, static_cast<std::uint32_t>(b));
      for_each_bin(span, bins.n_azimuth, [&](std::int32_t bin) { ++counts[bin]; });
      spans[b] = span;
      done += bins_of(span, bins.n_azimuth);
    }
    return done;
  });

  std::uint32_t sum = 0;
  for (std::size_t bin = 0; bin < n_bins; ++bin) {
    start_[bin] = sum;
    for (std::size_t chunk = 0; chunk < n_chunks; ++chunk) {
      std::uint32_t& count = next[chunk * n_bins + bin];
      sum += std::exchange(count, sum);
    }
    if (bin % kBlock == 0) ask(static_cast<std::int64_t>(kBlock * n_chunks));
  }
  start_[n_bins] = sum;
  buildings_ = std::make_unique_for_overwrite<std::uint32_t[]>(sum);

  for_each_run([&](std::size_t chunk, std::size_t from, std::size_t count) {
    std::uint32_t* to = next.data() + chunk * n_bins;
    auto done = static_cast<std::int64_t>(count);
    for (std::size_t b = from; b < from + count; ++b) {
      for_each_bin(spans[b], bins.n_azimuth,
                   [&](std::int32_t bin) { buildings_[to[bin]++] = static_cast<std::uint32_t>(b); });
      done += bins_of(spans[b], bins.n_azimuth);
    }
    return done;
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
  ask(static_cast<std::int64_t>(end - begin) * 3 + static_cast<std::int64_t>(present.size()));
  buildings.reserve(static_cast<std::size_t>(end - begin));
  for (std::size_t word = 0; word < present.size(); ++word)
    for (std::uint64_t bits = present[word]; bits != 0; bits &= bits - 1)
      buildings.push_back(static_cast<std::uint32_t>((from + word) * 64) +
                          static_cast<std::uint32_t>(std::countr_zero(bits)));
  return buildings;
}

}  // namespace obliq
