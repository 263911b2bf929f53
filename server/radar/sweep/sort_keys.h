#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "terrain/base/asking.h"

namespace obliq {

/// Sorts numbers, or pairs of them, and asks on the way.
template <typename Key>
void sort_keys(std::vector<Key>& keys) {
  constexpr std::size_t kMany = kMostWork / 32;  // to ask once a comparison slows it down by half
  if (keys.size() < kMany) {
    ask(16 * static_cast<std::int64_t>(keys.size()));
    std::ranges::sort(keys);
  } else {
    std::ranges::sort(keys, [](const Key& p, const Key& q) {
      ask(1);
      return p < q;
    });
  }
}

}  // namespace obliq
