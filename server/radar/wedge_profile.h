#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "server/radar/profile.h"
#include "server/radar/render.h"

namespace obliq {

/// What the strands of one azimuth bin find together, [n_range] each.
struct BinMarks {
  std::vector<std::uint8_t> visible;  ///< 1 where any strand sees surface
  std::vector<std::uint8_t> present;  ///< 1 where any strand has surface, seen or hidden

  /// Joins another strand's marks, or several strands', from range bin `first` on.
  template <class Marks>
  void add(const Marks& other, std::size_t first = 0) {
    visible.resize(other.visible.size());
    present.resize(other.present.size());
    for (std::size_t r = first; r < visible.size(); ++r) {
      visible[r] |= other.visible[r];
      present[r] |= other.present[r];
    }
  }
};

/// Terrain profiles of a wedge's azimuth bins, marched when first asked for. Neighbours share the strand
/// between them. Owned by one task.
class WedgeProfile {
 public:
  WedgeProfile(const FramePlan& plan, AzimuthRange range);

  /// All strands of an azimuth bin of the wedge.
  const BinMarks& marks(int azimuth_bin);

  /// Ground area of the sector in an azimuth bin and how much of it is known, along its centre.
  struct Area {
    double sector_m2 = 0;
    double covered_m2 = 0;
  };
  const Area& area(int azimuth_bin);

 private:
  const BinMarks& edge(int azimuth_edge);
  void march_centre(int azimuth_bin);
  std::size_t index(int azimuth_bin) const { return static_cast<std::size_t>(azimuth_bin - range_.first); }

  const FramePlan& plan_;
  AzimuthRange range_;
  std::vector<std::optional<BinMarks>> marks_;    // [range.count]
  std::vector<std::optional<BinMarks>> edges_;    // [range.count + 1]
  std::vector<std::optional<BinMarks>> centres_;  // [range.count]
  std::vector<Area> areas_;                       // [range.count], with centres_
  std::vector<FootprintSpan> spans_;
  ProfileResult strand_;
};

}  // namespace obliq
