#include "server/radar/echo/scatterer_sums.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

constexpr std::size_t kFirstRoom = std::size_t{1} << 13;
constexpr std::uint32_t kRun = 4096;  // samples between two times that are asked

}  // namespace

void ScattererSums::ScattererArrays::resize(std::size_t n) {
  bin.resize(n + ScattererLists::kSpare);
  place.resize(n + ScattererLists::kSpare);
  kind.resize(n + ScattererLists::kSpare);
  power_w.resize(n + ScattererLists::kSpare);
}

std::int64_t ScattererSums::bytes(double samples) {
  constexpr int kBytesASample = 4 + 8 + 8 + 8;
  return std::llround(2 * kBytesASample * std::max(static_cast<double>(kFirstRoom), samples));
}

void ScattererSums::restart(int n_range) {
  n_ = 0;
  n_range_ = static_cast<std::size_t>(n_range);
}

void ScattererSums::make_room() {
  if (n_ > 0) merge();
  if (2 * n_ < room_) return;
  room_ = std::max(kFirstRoom, 2 * room_);
  samples_.resize(room_);
}

void ScattererSums::merge() {
  ScattererArrays& sorted = scratch_->sorted;
  std::vector<std::uint32_t>& bin_end = scratch_->end;
  if (sorted.bin.size() < samples_.bin.size()) sorted.resize(room_);
  bin_end.assign(n_range_ + 1, 0);
  for (std::size_t k = 0; k < n_; ++k) {
    if (k % kRun == 0) ask(kRun);
    ++bin_end[samples_.bin[k] + 1];
  }
  std::partial_sum(bin_end.begin(), bin_end.end(), bin_end.begin());
  for (std::size_t k = 0; k < n_; ++k) {
    if (k % kRun == 0) ask(2 * kRun);
    const std::uint32_t to = bin_end[samples_.bin[k]]++;
    sorted.place[to] = samples_.place[k];
    sorted.kind[to] = samples_.kind[k];
    sorted.power_w[to] = samples_.power_w[k];
  }
  // What is added up takes no more room than the samples did.
  ScattererLists lists{bin_end.data(),        sorted.place.data(),     sorted.kind.data(),
                       sorted.power_w.data(), samples_.bin.data(),     samples_.place.data(),
                       samples_.kind.data(),  samples_.power_w.data(), 0};
  const auto n_range = static_cast<std::uint32_t>(bin_end.size() - 1);
  const auto begin_of = [&](std::uint32_t bin) { return bin == 0 ? 0 : bin_end[bin - 1]; };
  for (std::uint32_t bin = 0; bin < n_range;) {
    std::uint32_t end = bin + 1;
    while (end < n_range && bin_end[end] - begin_of(bin) < kRun) ++end;
    ask(4 * (bin_end[end - 1] - begin_of(bin)) + end - bin);
    bin = active_kernels().sum_scatterers(lists, bin, end);
    if (bin < end) merge_large(lists, bin++);
  }
  n_ = lists.n;
}

/// One bin with many samples: these are sorted, since a search through the scatterers found so far would cost
/// their number each time.
void ScattererSums::merge_large(ScattererLists& lists, std::uint32_t bin) {
  ScattererArrays& sorted = scratch_->sorted;
  std::vector<std::uint32_t>& order = scratch_->order;
  const std::uint32_t begin = bin == 0 ? 0 : scratch_->end[bin - 1];
  order.resize(scratch_->end[bin] - begin);
  std::iota(order.begin(), order.end(), begin);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    ask(2);
    if (sorted.place[a] != sorted.place[b]) return sorted.place[a] < sorted.place[b];
    return sorted.kind[a] != sorted.kind[b] ? sorted.kind[a] < sorted.kind[b] : a < b;
  });
  // Each scatterer's power goes to its first sample, and the first samples are taken in their order.
  std::vector<std::uint32_t> firsts;
  for (std::size_t at = 0; at < order.size(); ++at) {
    if (at % kRun == 0) ask(4 * kRun);
    const std::uint32_t k = order[at];
    if (!firsts.empty() && sorted.place[firsts.back()] == sorted.place[k] &&
        sorted.kind[firsts.back()] == sorted.kind[k]) {
      sorted.power_w[firsts.back()] += sorted.power_w[k];
    } else {
      firsts.push_back(k);
    }
  }
  std::sort(firsts.begin(), firsts.end(), [](std::uint32_t a, std::uint32_t b) {
    ask(1);
    return a < b;
  });
  for (const std::uint32_t k : firsts) {
    samples_.bin[lists.n] = bin;
    samples_.place[lists.n] = sorted.place[k];
    samples_.kind[lists.n] = sorted.kind[k];
    samples_.power_w[lists.n++] = sorted.power_w[k];
  }
}

}  // namespace obliq
