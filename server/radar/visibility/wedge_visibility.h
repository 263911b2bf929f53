#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/visibility/range_visibility.h"

namespace obliq {

/// Terrain profiles of a wedge's azimuth bins. Neighbours share the sub-azimuth between them. Owned by one
/// task.
class WedgeVisibility {
 public:
  /// roofs: false where what buildings hide is known otherwise.
  WedgeVisibility(const ScenePlan& plan, AzimuthRange range, bool roofs = true);

  /// An azimuth bin, and those of its range bins whose marks are wanted.
  struct Request {
    int azimuth_bin;
    RangeWindow bins;
  };
  /// Marches the sub-azimuths of azimuth bins side by side, as far as they count and no earlier march has
  /// answered.
  void march_centres(const std::vector<Request>& requests);
  void march_all(const std::vector<Request>& requests);

  /// Of what has been marched, right in the bins that were requested.
  bool centre_sees(int azimuth_bin, int range_bin) const {
    const std::vector<std::uint8_t>& visible = profiles_[centre_of(azimuth_bin)].result.visible;
    return !visible.empty() && visible[static_cast<std::size_t>(range_bin)] != 0;
  }
  BinMarks marks(const Request& request) const;

  /// All sub-azimuths of an azimuth bin, whole. The first call marches those of all of the wedge's.
  const BinMarks& whole_marks(int azimuth_bin);

  /// A visible and a present mark a bin, of up to 9 profiles an azimuth bin and of all together.
  static std::int64_t bytes(int n_range) { return std::int64_t{n_range} * kWedgeAzimuthBins * 2 * (9 + 1); }

 private:
  struct SubAzimuth {
    RangeWindow bins{0, -1};
    BinMarks result;
  };
  std::size_t index(int azimuth_bin) const { return static_cast<std::size_t>(azimuth_bin - range_.first); }
  std::size_t sub_azimuth_of(int azimuth_bin, int sub_azimuth) const {
    return index(azimuth_bin) * static_cast<std::size_t>(sub_azimuths_) +
           static_cast<std::size_t>(sub_azimuth);
  }
  std::size_t centre_of(int azimuth_bin) const { return sub_azimuth_of(azimuth_bin, sub_azimuths_ / 2); }
  /// In bins, from the sector's left edge.
  double position(std::size_t sub_azimuth) const {
    return range_.first + static_cast<double>(sub_azimuth) / sub_azimuths_;
  }
  /// Of the requested bins, those in which a sub-azimuth counts.
  RangeWindow counting(int sub_azimuth, RangeWindow bins) const;
  RangeWindow whole() const { return {0, plan_.bins().n_range - 1}; }

  /// Strands and the range bins that are wanted of them: the least window around all requests.
  using Wanted = std::vector<RangeWindow>;
  static void want(Wanted& wanted, std::size_t sub_azimuth, RangeWindow bins);
  void march(Wanted& wanted);

  const ScenePlan& plan_;
  AzimuthRange range_;
  int sub_azimuths_;
  bool roofs_;
  std::vector<SubAzimuth> profiles_;   // [range.count sub-azimuths + 1], the last an edge
  std::vector<BinMarks> whole_marks_;  // [range.count], or none yet
  std::vector<RoofSpan> spans_;
};

/// Gives every bin without samples its state, by the profiles of its azimuth. Profiles are marched
/// where they can still say something: along an azimuth bin's centre from its first undecided bin to its
/// last, and on its other sub-azimuths around those that the centre does not see. `block`: of the profile's
/// wedge, where it has no samples not sampled, or already in the shadow of buildings.
void decide_states(const ScenePlan& plan, WedgeVisibility& profile, BinBlock& block);

}  // namespace obliq
