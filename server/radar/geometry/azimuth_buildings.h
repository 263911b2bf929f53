#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/geometry/sector.h"
#include "server/scene/scene.h"

namespace obliq {

/// Which buildings an antenna sees in each azimuth bin, as far as their circles tell: all that overlap it,
/// and some that only come close. Immutable; the same for any number of threads.
class AzimuthBuildings {
 public:
  /// Those of which some part is no farther over ground than reach_m. by_corners: by bounds_of(), which takes
  /// twenty times as long. A ray's pixel may reach beyond its bin and takes the buildings of its bin alone,
  /// so that its bits depend on those which only come close.
  AzimuthBuildings(const Scene& scene, const Sector& sector, const BinGrid& bins, double reach_m,
                   bool by_corners = false);

  /// Indices, rising.
  std::span<const std::uint32_t> in(int azimuth_bin) const {
    const auto bin = static_cast<std::size_t>(azimuth_bin);
    return {buildings_.get() + start_[bin], buildings_.get() + start_[bin + 1]};
  }
  /// Those of several bins, each once, rising.
  std::vector<std::uint32_t> in(AzimuthRange range) const;

 private:
  std::size_t n_buildings_;
  std::vector<std::uint32_t> start_;            // [n_azimuth + 1], into buildings_
  std::unique_ptr<std::uint32_t[]> buildings_;  // bin by bin
};

}  // namespace obliq
