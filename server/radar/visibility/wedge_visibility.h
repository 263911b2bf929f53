#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/visibility/range_visibility.h"

namespace obliq {

/// What the strands of one azimuth bin find together, [n_range] each.
struct BinMarks {
  std::vector<std::uint8_t> visible;  ///< 1 where any strand sees surface
  std::vector<std::uint8_t> present;  ///< 1 where any strand has surface, seen or hidden

  explicit BinMarks(int n_range)
      : visible(static_cast<std::size_t>(n_range)), present(static_cast<std::size_t>(n_range)) {}
  /// Joins a strand's marks of some range bins.
  void add(const ProfileResult& strand, RangeWindow bins);
};

/// Terrain profiles of a wedge's azimuth bins. Neighbours share the strand between them. Owned by one task.
class WedgeProfile {
 public:
  WedgeProfile(const FramePlan& plan, AzimuthRange range);

  /// An azimuth bin, and those of its range bins whose marks are wanted.
  struct Wish {
    int azimuth_bin;
    RangeWindow bins;
  };
  /// Marches the strands of azimuth bins side by side, as far as no earlier march has answered.
  void march_centres(const std::vector<Wish>& wishes);
  void march_strands(const std::vector<Wish>& wishes);

  /// Of what has been marched, right in the bins that were wished for.
  const ProfileResult& centre(int azimuth_bin) const { return profiles_[centre_of(azimuth_bin)].result; }
  BinMarks marks(const Wish& wish) const;

  /// All strands of an azimuth bin, whole. The first call marches those of all of the wedge's.
  const BinMarks& whole_marks(int azimuth_bin);

 private:
  struct Strand {
    RangeWindow bins{0, -1};
    ProfileResult result;
  };
  std::size_t index(int azimuth_bin) const { return static_cast<std::size_t>(azimuth_bin - range_.first); }
  std::size_t strand_of(int azimuth_bin, int strand) const {
    return index(azimuth_bin) * static_cast<std::size_t>(strands_) + static_cast<std::size_t>(strand);
  }
  std::size_t centre_of(int azimuth_bin) const { return strand_of(azimuth_bin, strands_ / 2); }
  /// In bins, from the sector's left edge.
  double position(std::size_t strand) const { return range_.first + static_cast<double>(strand) / strands_; }
  /// Of the wished bins, those in which a strand counts.
  RangeWindow counting(int strand, RangeWindow bins) const;
  RangeWindow whole() const { return {0, plan_.bins().n_range - 1}; }

  /// Strands and the range bins that are wanted of them: the least window around all wishes.
  using Wanted = std::vector<RangeWindow>;
  static void want(Wanted& wanted, std::size_t strand, RangeWindow bins);
  void march(Wanted& wanted);

  const FramePlan& plan_;
  AzimuthRange range_;
  int strands_;
  std::vector<Strand> profiles_;       // [range.count strands + 1], the last an edge
  std::vector<BinMarks> whole_marks_;  // [range.count], or none yet
  std::vector<FootprintSpan> spans_;
};

}  // namespace obliq
