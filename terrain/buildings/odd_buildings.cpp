#include "terrain/buildings/odd_buildings.h"

#include <bit>
#include <cmath>
#include <glm/common.hpp>

#include "terrain/base/hash.h"

namespace obliq {
namespace {

bool is_sliver(const Buildings& all, const Building& building) {
  double doubled_m2 = 0, circumference_m = 0;
  const glm::dvec2 origin(all.outline(building).front());
  for (std::uint32_t r = building.first_ring; r < building.first_ring + building.n_rings; ++r) {
    glm::dvec2 p = glm::dvec2(all.ring(r).back()) - origin;
    for (const glm::vec2& corner : all.ring(r)) {
      const glm::dvec2 q = glm::dvec2(corner) - origin;
      doubled_m2 += p.x * q.y - p.y * q.x;
      circumference_m += std::hypot(q.x - p.x, q.y - p.y);
      p = q;
    }
  }
  return doubled_m2 <= kSliver_m * circumference_m;
}

/// The rectangle that bounds an outline.
struct Place {
  glm::vec2 middle_m;
  glm::vec2 size_m;

  bool same(const Place& other) const {
    const glm::vec2 off = glm::abs(middle_m - other.middle_m);
    const glm::vec2 larger = glm::abs(size_m - other.size_m);
    return off.x <= kSame_m && off.y <= kSame_m && larger.x <= kSame_m && larger.y <= kSame_m;
  }
};

Place place_of(const Buildings& all, const Building& building) {
  const auto [low, high] = Rectangle(all.outline(building));
  return {(low + high) / 2.0f, high - low};
}

/// Places by cells of a metre, a few of them in each: a town that stands in one place takes no longer.
class PlaceTable {
 public:
  explicit PlaceTable(std::size_t n)
      : slots_(std::bit_ceil(2 * n + kMostProbes), kFree), mask_(slots_.size() - 1) {}

  /// Whether one like it is there; if not, it is added.
  bool has_or_add(const Place& place) {
    const std::int64_t i1 = cell(place.middle_m.x + kSame_m), j1 = cell(place.middle_m.y + kSame_m);
    for (std::int64_t i = cell(place.middle_m.x - kSame_m); i <= i1; ++i)
      for (std::int64_t j = cell(place.middle_m.y - kSame_m); j <= j1; ++j)
        if (find(place, i, j)) return true;
    const std::size_t at = hash_cell(0, cell(place.middle_m.x), cell(place.middle_m.y));
    for (std::size_t probe = 0; probe < kMostProbes; ++probe) {
      Place& slot = slots_[(at + probe) & mask_];
      if (slot.size_m.x >= 0) continue;
      slot = place;
      break;
    }
    return false;
  }

 private:
  static constexpr std::size_t kMostProbes = 8;
  static constexpr Place kFree{glm::vec2(0.0f), glm::vec2(-1.0f)};

  static std::int64_t cell(float m) { return static_cast<std::int64_t>(std::floor(m)); }

  bool find(const Place& place, std::int64_t i, std::int64_t j) const {
    const std::size_t at = hash_cell(0, i, j);
    for (std::size_t probe = 0; probe < kMostProbes; ++probe) {
      const Place& slot = slots_[(at + probe) & mask_];
      if (slot.size_m.x < 0) return false;
      if (place.same(slot)) return true;
    }
    return false;
  }

  std::vector<Place> slots_;
  std::size_t mask_;
};

}  // namespace

OddBuildings count_odd(const Buildings& buildings) {
  OddBuildings odd;
  PlaceTable places(buildings.list.size());
  for (const Building& building : buildings.list) {
    if (is_sliver(buildings, building)) ++odd.slivers;
    if (places.has_or_add(place_of(buildings, building))) ++odd.copies;
  }
  return odd;
}

}  // namespace obliq
