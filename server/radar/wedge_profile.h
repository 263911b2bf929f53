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

  /// Marches what marks() of these azimuth bins and area() of all will ask for, side by side.
  void prepare(const std::vector<int>& azimuth_bins);

  /// All strands of an azimuth bin of the wedge.
  const BinMarks& marks(int azimuth_bin);

  /// Ground area of the sector in an azimuth bin and how much of it is known, along its centre.
  struct Area {
    double sector_m2 = 0;
    double covered_m2 = 0;
  };
  Area area(int azimuth_bin);

 private:
  std::size_t index(int azimuth_bin) const { return static_cast<std::size_t>(azimuth_bin - range_.first); }
  std::size_t strand_of(int azimuth_bin, int strand) const {
    return index(azimuth_bin) * static_cast<std::size_t>(strands_) + static_cast<std::size_t>(strand);
  }
  /// In bins, from the sector's left edge.
  double position(std::size_t strand) const { return range_.first + static_cast<double>(strand) / strands_; }
  bool counts(int strand) const;
  const ProfileResult& profile(std::size_t strand);

  const FramePlan& plan_;
  AzimuthRange range_;
  int strands_;
  std::vector<std::optional<ProfileResult>> profiles_;  // [range.count strands + 1], the last an edge
  std::vector<std::optional<BinMarks>> marks_;          // [range.count]
  std::vector<FootprintSpan> spans_;
};

}  // namespace obliq
