#include "server/radar/visibility/wedge_visibility.h"

#include <algorithm>
#include <array>

#include "terrain/base/asking.h"

namespace obliq {
namespace {

using Request = WedgeVisibility::Request;

/// The states of one azimuth bin, [n_range].
std::uint8_t* states_of(BinBlock& block, int azimuth_bin) {
  return block.state.data() + static_cast<std::size_t>(azimuth_bin - block.first_azimuth) *
                                  static_cast<std::size_t>(block.n_range);
}

/// Leaves of the requests what lies between the first and the last bin without samples for which
/// is_open(azimuth bin, range bin).
template <typename IsOpen>
void narrow(BinBlock& block, std::vector<Request>& requests, const IsOpen& is_open) {
  for (Request& request : requests) {
    const std::uint8_t* const state = states_of(block, request.azimuth_bin);
    const auto closed = [&](int r) {
      return state[r] != static_cast<std::uint8_t>(BinState::not_sampled) || !is_open(request.azimuth_bin, r);
    };
    ask(block.n_range);
    RangeWindow& bins = request.bins;
    while (!bins.empty() && closed(bins.first)) ++bins.first;
    while (!bins.empty() && closed(bins.last)) --bins.last;
  }
  std::erase_if(requests, [](const Request& request) { return request.bins.empty(); });
}

}  // namespace

void BinMarks::add(const BinMarks& other, RangeWindow bins) {
  for (auto r = static_cast<std::size_t>(bins.first); r < static_cast<std::size_t>(bins.last + 1); ++r) {
    visible[r] |= other.visible[r];
    present[r] |= other.present[r];
  }
}

WedgeVisibility::WedgeVisibility(const ScenePlan& plan, AzimuthRange range, bool roofs)
    : plan_(plan),
      range_(range),
      sub_azimuths_(sub_azimuths_per_bin(plan)),
      roofs_(roofs),
      profiles_(static_cast<std::size_t>(range.count) * static_cast<std::size_t>(sub_azimuths_) + 1) {}

RangeWindow WedgeVisibility::counting(int sub_azimuth, RangeWindow bins) const {
  const auto first = static_cast<int>(first_bin_of_sub_azimuth(plan_, sub_azimuth, sub_azimuths_));
  return {std::max(bins.first, first), bins.last};
}

void WedgeVisibility::want(Wanted& wanted, std::size_t sub_azimuth, RangeWindow bins) {
  if (bins.empty()) return;
  RangeWindow& window = wanted[sub_azimuth];
  window = window.empty() ? bins
                          : RangeWindow{std::min(window.first, bins.first), std::max(window.last, bins.last)};
}

void WedgeVisibility::march_centres(const std::vector<Request>& requests) {
  Wanted wanted(profiles_.size(), {0, -1});
  for (const Request& request : requests)
    want(wanted, centre_of(request.azimuth_bin), counting(sub_azimuths_ / 2, request.bins));
  march(wanted);
}

void WedgeVisibility::march_all(const std::vector<Request>& requests) {
  Wanted wanted(profiles_.size(), {0, -1});
  for (const Request& request : requests)
    for (int sub_azimuth = 0; sub_azimuth <= sub_azimuths_; ++sub_azimuth)
      want(wanted, sub_azimuth_of(request.azimuth_bin, sub_azimuth), counting(sub_azimuth, request.bins));
  march(wanted);
}

void WedgeVisibility::march(Wanted& wanted) {
  std::vector<std::size_t> open;
  for (std::size_t sub_azimuth = 0; sub_azimuth < wanted.size(); ++sub_azimuth) {
    const RangeWindow known = profiles_[sub_azimuth].bins;
    if (wanted[sub_azimuth].empty() || known.holds(wanted[sub_azimuth])) continue;
    want(wanted, sub_azimuth, known);
    open.push_back(sub_azimuth);
  }
  // Side by side those that set out at about the same range: a march takes as long as its longest profile.
  std::ranges::stable_sort(open, {}, [&](std::size_t sub_azimuth) { return wanted[sub_azimuth].first; });
  for (std::size_t first = 0; first < open.size(); first += kMostProfiles) {
    const std::size_t n = std::min<std::size_t>(kMostProfiles, open.size() - first);
    std::array<VisibilityRequest, kMostProfiles> requests;
    std::array<BinMarks, kMostProfiles> results;
    for (std::size_t k = 0; k < n; ++k)
      requests[k] = {position(open[first + k]), wanted[open[first + k]], roofs_};
    mark_profiles(plan_, std::span(requests).first(n), std::span(results).first(n), spans_);
    for (std::size_t k = 0; k < n; ++k)
      profiles_[open[first + k]] = {requests[k].bins, std::move(results[k])};
  }
}

BinMarks WedgeVisibility::marks(const Request& request) const {
  BinMarks all(plan_.bins().n_range);
  for (int sub_azimuth = 0; sub_azimuth <= sub_azimuths_; ++sub_azimuth) {
    const RangeWindow bins = counting(sub_azimuth, request.bins);
    if (bins.empty()) continue;
    ask(bins.last - bins.first + 1);
    all.add(profiles_[sub_azimuth_of(request.azimuth_bin, sub_azimuth)].result, bins);
  }
  return all;
}

const BinMarks& WedgeVisibility::whole_marks(int azimuth_bin) {
  if (whole_marks_.empty()) {
    std::vector<Request> requests;
    for (int k = 0; k < range_.count; ++k) requests.push_back({range_.first + k, whole()});
    march_all(requests);
    for (const Request& request : requests) whole_marks_.push_back(marks(request));
  }
  return whole_marks_[index(azimuth_bin)];
}

void decide_states(const ScenePlan& plan, WedgeVisibility& profile, BinBlock& block) {
  std::vector<Request> open;
  for (int k = 0; k < block.n_azimuth; ++k) open.push_back({block.first_azimuth + k, {0, block.n_range - 1}});
  narrow(block, open, [](int, int) { return true; });
  profile.march_centres(open);
  narrow(block, open, [&](int azimuth_bin, int r) { return !profile.centre_sees(azimuth_bin, r); });
  profile.march_all(open);
  const glm::dvec3& antenna = plan.sector().antenna_m;
  const double below_m = antenna.y - plan.scene().world().grid.height_at_m(antenna.x, antenna.z);
  // Where the ground below is nearer than the swath, what the swath lacks is missing beyond it. NaN over a
  // void.
  const bool has_hole = below_m >= plan.bins().r_min_m;
  // The others are what they were to begin with: not sampled, though the centre sees them.
  for (const Request& request : open) {
    const BinMarks marks = profile.marks(request);
    // A request leaves out nearer bins only where they hold surface.
    bool before_surface = has_hole && request.bins.first == 0;
    std::uint8_t* const state = states_of(block, request.azimuth_bin);
    for (int r = request.bins.first; r <= request.bins.last; ++r) {
      const auto k = static_cast<std::size_t>(r);
      const bool decided_before = state[k] != static_cast<std::uint8_t>(BinState::not_sampled);
      before_surface = before_surface && !decided_before && !marks.present[k];
      if (decided_before) continue;
      const BinState decided = marks.visible[k]   ? BinState::not_sampled
                               : marks.present[k] ? BinState::shadow
                               : before_surface   ? BinState::nearer_than_ground
                                                  : BinState::no_surface;
      state[k] = static_cast<std::uint8_t>(decided);
    }
  }
}

}  // namespace obliq
