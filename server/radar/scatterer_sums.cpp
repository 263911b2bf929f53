#include "server/radar/scatterer_sums.h"

#include <algorithm>
#include <numeric>

#include "server/radar/lane_kernels.h"

namespace obliq {
namespace {

constexpr std::size_t kFirstRoom = std::size_t{1} << 13;

}  // namespace

void ScattererSums::restart(int n_range) {
  n_ = 0;
  end_.resize(static_cast<std::size_t>(n_range) + 1);
}

void ScattererSums::make_room() {
  if (n_ > 0) merge();
  if (2 * n_ < room_) return;
  room_ = std::max(kFirstRoom, 2 * room_);
  for (ScattererArrays* arrays : {&samples_, &sorted_}) {
    arrays->bin.resize(room_ + ScattererLists::kSpare);
    arrays->place.resize(room_ + ScattererLists::kSpare);
    arrays->kind.resize(room_ + ScattererLists::kSpare);
    arrays->power_w.resize(room_ + ScattererLists::kSpare);
  }
}

void ScattererSums::merge() {
  std::fill(end_.begin(), end_.end(), 0);
  for (std::size_t k = 0; k < n_; ++k) ++end_[samples_.bin[k] + 1];
  std::partial_sum(end_.begin(), end_.end(), end_.begin());
  for (std::size_t k = 0; k < n_; ++k) {
    const std::uint32_t to = end_[samples_.bin[k]]++;
    sorted_.place[to] = samples_.place[k];
    sorted_.kind[to] = samples_.kind[k];
    sorted_.power_w[to] = samples_.power_w[k];
  }
  // What is added up takes no more room than the samples did.
  ScattererLists lists{end_.data(),
                       sorted_.place.data(),
                       sorted_.kind.data(),
                       sorted_.power_w.data(),
                       samples_.bin.data(),
                       samples_.place.data(),
                       samples_.kind.data(),
                       samples_.power_w.data(),
                       0};
  const auto n_range = static_cast<std::uint32_t>(end_.size() - 1);
  for (std::uint32_t bin = 0; bin < n_range;) {
    bin = lane_kernels().merge(lists, bin, n_range);
    if (bin < n_range) merge_large(lists, bin++);
  }
  n_ = lists.n;
}

/// One bin with many samples: they are sorted, since looking through the scatterers found so far costs their
/// number each time.
void ScattererSums::merge_large(ScattererLists& lists, std::uint32_t bin) {
  const std::uint32_t begin = bin == 0 ? 0 : end_[bin - 1];
  order_.resize(end_[bin] - begin);
  std::iota(order_.begin(), order_.end(), begin);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (sorted_.place[a] != sorted_.place[b]) return sorted_.place[a] < sorted_.place[b];
    return sorted_.kind[a] != sorted_.kind[b] ? sorted_.kind[a] < sorted_.kind[b] : a < b;
  });
  // Each scatterer's power goes to its first sample, and the first samples are taken in their order.
  std::vector<std::uint32_t> firsts;
  for (const std::uint32_t k : order_) {
    if (!firsts.empty() && sorted_.place[firsts.back()] == sorted_.place[k] &&
        sorted_.kind[firsts.back()] == sorted_.kind[k]) {
      sorted_.power_w[firsts.back()] += sorted_.power_w[k];
    } else {
      firsts.push_back(k);
    }
  }
  std::sort(firsts.begin(), firsts.end());
  for (const std::uint32_t k : firsts) {
    samples_.bin[lists.n] = bin;
    samples_.place[lists.n] = sorted_.place[k];
    samples_.kind[lists.n] = sorted_.kind[k];
    samples_.power_w[lists.n++] = sorted_.power_w[k];
  }
}

}  // namespace obliq
