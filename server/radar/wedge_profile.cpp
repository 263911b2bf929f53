#include "server/radar/wedge_profile.h"

#include <algorithm>
#include <array>

namespace obliq {

WedgeProfile::WedgeProfile(const FramePlan& plan, AzimuthRange range)
    : plan_(plan),
      range_(range),
      strands_(profile_strands(plan)),
      profiles_(static_cast<std::size_t>(range.count) * static_cast<std::size_t>(strands_) + 1),
      marks_(static_cast<std::size_t>(range.count)) {}

/// Between the edges of a bin: the centre, and the others as far as they say anything.
bool WedgeProfile::counts(int strand) const {
  return 2 * strand == strands_ ||
         first_bin_of_strand(plan_, strand, strands_) < static_cast<std::size_t>(plan_.bins().n_range);
}

void WedgeProfile::prepare(const std::vector<int>& azimuth_bins) {
  std::vector<std::size_t> wanted;
  for (int bin = range_.first; bin < range_.first + range_.count; ++bin)
    wanted.push_back(strand_of(bin, strands_ / 2));
  for (const int bin : azimuth_bins)
    for (int strand = 0; strand <= strands_; ++strand)
      if (strand == 0 || strand == strands_ || counts(strand)) wanted.push_back(strand_of(bin, strand));
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::erase_if(wanted, [&](std::size_t strand) { return profiles_[strand].has_value(); });
  for (std::size_t first = 0; first < wanted.size(); first += kMostProfiles) {
    const std::size_t n = std::min<std::size_t>(kMostProfiles, wanted.size() - first);
    std::array<double, kMostProfiles> positions;
    std::array<ProfileResult, kMostProfiles> results;
    for (std::size_t k = 0; k < n; ++k) positions[k] = position(wanted[first + k]);
    march_profiles(plan_, std::span(positions).first(n), std::span(results).first(n), spans_);
    for (std::size_t k = 0; k < n; ++k) profiles_[wanted[first + k]] = std::move(results[k]);
  }
}

const BinMarks& WedgeProfile::marks(int azimuth_bin) {
  std::optional<BinMarks>& slot = marks_[index(azimuth_bin)];
  if (slot) return *slot;
  BinMarks all;
  for (int strand = 0; strand <= strands_; ++strand) {
    if (strand == 0 || strand == strands_ || 2 * strand == strands_) {
      all.add(profile(strand_of(azimuth_bin, strand)));
    } else if (counts(strand)) {
      all.add(profile(strand_of(azimuth_bin, strand)), first_bin_of_strand(plan_, strand, strands_));
    }
  }
  slot = std::move(all);
  return *slot;
}

WedgeProfile::Area WedgeProfile::area(int azimuth_bin) {
  const ProfileResult& centre = profile(strand_of(azimuth_bin, strands_ / 2));
  return {centre.sector_area_m2, centre.covered_area_m2};
}

const ProfileResult& WedgeProfile::profile(std::size_t strand) {
  std::optional<ProfileResult>& slot = profiles_[strand];
  if (!slot) march_profile(plan_, position(strand), spans_, slot.emplace());
  return *slot;
}

}  // namespace obliq
