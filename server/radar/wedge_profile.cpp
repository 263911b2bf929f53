#include "server/radar/wedge_profile.h"

namespace obliq {

WedgeProfile::WedgeProfile(const FramePlan& plan, AzimuthRange range)
    : plan_(plan),
      range_(range),
      marks_(static_cast<std::size_t>(range.count)),
      edges_(static_cast<std::size_t>(range.count) + 1),
      centres_(static_cast<std::size_t>(range.count)),
      areas_(static_cast<std::size_t>(range.count)) {}

const BinMarks& WedgeProfile::marks(int azimuth_bin) {
  std::optional<BinMarks>& slot = marks_[index(azimuth_bin)];
  if (slot) return *slot;
  const int strands = profile_strands(plan_);
  BinMarks all = edge(azimuth_bin);
  for (int strand = 1; strand < strands; ++strand) {
    if (2 * strand == strands) {
      march_centre(azimuth_bin);
      all.add(*centres_[index(azimuth_bin)]);
    } else if (const std::size_t first = first_bin_of_strand(plan_, strand, strands);
               first < all.visible.size()) {
      march_profile(plan_, azimuth_bin + static_cast<double>(strand) / strands, spans_, strand_);
      all.add(strand_, first);
    }
  }
  all.add(edge(azimuth_bin + 1));
  slot = std::move(all);
  return *slot;
}

const WedgeProfile::Area& WedgeProfile::area(int azimuth_bin) {
  march_centre(azimuth_bin);
  return areas_[index(azimuth_bin)];
}

const BinMarks& WedgeProfile::edge(int azimuth_edge) {
  std::optional<BinMarks>& slot = edges_[index(azimuth_edge)];
  if (!slot) {
    march_profile(plan_, azimuth_edge, spans_, strand_);
    slot.emplace().add(strand_);
  }
  return *slot;
}

void WedgeProfile::march_centre(int azimuth_bin) {
  std::optional<BinMarks>& slot = centres_[index(azimuth_bin)];
  if (slot) return;
  march_profile(plan_, azimuth_bin + 0.5, spans_, strand_);
  slot.emplace().add(strand_);
  areas_[index(azimuth_bin)] = {strand_.sector_area_m2, strand_.covered_area_m2};
}

}  // namespace obliq
