#include "server/radar/visibility/wedge_visibility.h"

#include <algorithm>
#include <array>

namespace obliq {

void BinMarks::add(const ProfileResult& strand, RangeWindow bins) {
  for (auto r = static_cast<std::size_t>(bins.first); r < static_cast<std::size_t>(bins.last + 1); ++r) {
    visible[r] |= strand.visible[r];
    present[r] |= strand.present[r];
  }
}

WedgeProfile::WedgeProfile(const FramePlan& plan, AzimuthRange range)
    : plan_(plan),
      range_(range),
      strands_(profile_strands(plan)),
      profiles_(static_cast<std::size_t>(range.count) * static_cast<std::size_t>(strands_) + 1) {}

/// The edges and the centre count everywhere, the others as far as they say anything.
RangeWindow WedgeProfile::counting(int strand, RangeWindow bins) const {
  if (strand == 0 || strand == strands_ || 2 * strand == strands_) return bins;
  const auto first = static_cast<int>(first_bin_of_strand(plan_, strand, strands_));
  return {std::max(bins.first, first), bins.last};
}

void WedgeProfile::want(Wanted& wanted, std::size_t strand, RangeWindow bins) {
  if (bins.empty()) return;
  RangeWindow& window = wanted[strand];
  window = window.empty() ? bins
                          : RangeWindow{std::min(window.first, bins.first), std::max(window.last, bins.last)};
}

void WedgeProfile::march_centres(const std::vector<Wish>& wishes) {
  Wanted wanted(profiles_.size(), {0, -1});
  for (const Wish& wish : wishes) want(wanted, centre_of(wish.azimuth_bin), wish.bins);
  march(wanted);
}

void WedgeProfile::march_strands(const std::vector<Wish>& wishes) {
  Wanted wanted(profiles_.size(), {0, -1});
  for (const Wish& wish : wishes)
    for (int strand = 0; strand <= strands_; ++strand)
      want(wanted, strand_of(wish.azimuth_bin, strand), counting(strand, wish.bins));
  march(wanted);
}

void WedgeProfile::march(Wanted& wanted) {
  std::vector<std::size_t> open;
  for (std::size_t strand = 0; strand < wanted.size(); ++strand) {
    const RangeWindow known = profiles_[strand].bins;
    if (wanted[strand].empty() || known.holds(wanted[strand])) continue;
    want(wanted, strand, known);
    open.push_back(strand);
  }
  for (std::size_t first = 0; first < open.size(); first += kMostProfiles) {
    const std::size_t n = std::min<std::size_t>(kMostProfiles, open.size() - first);
    std::array<ProfileWish, kMostProfiles> wishes;
    std::array<ProfileResult, kMostProfiles> results;
    for (std::size_t k = 0; k < n; ++k) wishes[k] = {position(open[first + k]), wanted[open[first + k]]};
    march_profiles(plan_, std::span(wishes).first(n), std::span(results).first(n), spans_);
    for (std::size_t k = 0; k < n; ++k) profiles_[open[first + k]] = {wishes[k].bins, std::move(results[k])};
  }
}

BinMarks WedgeProfile::marks(const Wish& wish) const {
  BinMarks all(plan_.bins().n_range);
  for (int strand = 0; strand <= strands_; ++strand) {
    const RangeWindow bins = counting(strand, wish.bins);
    if (!bins.empty()) all.add(profiles_[strand_of(wish.azimuth_bin, strand)].result, bins);
  }
  return all;
}

const BinMarks& WedgeProfile::whole_marks(int azimuth_bin) {
  if (whole_marks_.empty()) {
    std::vector<Wish> wishes;
    for (int k = 0; k < range_.count; ++k) wishes.push_back({range_.first + k, whole()});
    march_strands(wishes);
    for (const Wish& wish : wishes) whole_marks_.push_back(marks(wish));
  }
  return whole_marks_[index(azimuth_bin)];
}

}  // namespace obliq
