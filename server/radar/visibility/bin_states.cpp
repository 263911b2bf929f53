#include "server/radar/visibility/bin_states.h"

#include <vector>

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

void decide_states(const ScenePlan& plan, WedgeVisibility& profile, BinBlock& block) {
  std::vector<Request> open;
  for (int k = 0; k < block.n_azimuth; ++k) open.push_back({block.first_azimuth + k, {0, block.n_range - 1}});
  narrow(block, open, [](int, int) { return true; });
  profile.march_centres(open);
  narrow(block, open, [&](int azimuth_bin, int r) {
    return profile.centre(azimuth_bin).visible[static_cast<std::size_t>(r)] == 0;
  });
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
