#include "server/rendering/demand.h"

#include <algorithm>
#include <set>

#include "terrain/base/units.h"

namespace obliq::rendering {

std::chrono::steady_clock::duration period_of(double rate_hz) { return from_seconds(1 / rate_hz); }

std::vector<Demand> take_due(std::vector<Demand>& demands, std::chrono::steady_clock::time_point now,
                             bool unserved_only) {
  std::vector<Demand> taken;
  for (Demand& demand : demands) {
    const auto period = period_of(demand.rate_hz);
    // A tenth of a period early is on time: the radar's clock is not exact.
    if (now + period / 10 < demand.due || (unserved_only && demand.is_served())) continue;
    taken.push_back(demand);
    demand.due = std::max(demand.due + period, now);
  }
  return taken;
}

void give_back(const std::vector<Demand>& taken, std::vector<Demand>& demands) {
  for (const Demand& one : taken) {
    const auto at = std::ranges::find(demands, one.watch_id, &Demand::watch_id);
    if (at != demands.end()) at->due = one.due;
  }
}

ReceivedPlanes needed_planes(const stream::StreamChoice& choice, const RadarSettings& settings) {
  const auto wants = [&](wire::Plane plane) { return (choice.planes & wire::plane_bit(plane)) != 0; };
  const bool video = wants(wire::Plane::video);
  return {wants(wire::Plane::iq) || (video && video_needs_iq(settings)),
          video && choice.format.video_bits == 8, video && choice.format.video_bits == 16};
}

bool wants_pulses(const stream::StreamChoice& choice, const RadarSettings& settings) {
  return settings.mode == RadarMode::pulses && (choice.planes & wire::kPulsesPlane) != 0;
}

Order order_of(const std::vector<Demand>& demands, const RadarSettings& settings) {
  Order order;
  std::set<stream::StreamChoice> choices;
  std::vector<bool> wedges(static_cast<std::size_t>(wedge_count(settings.azimuth_bins)));
  for (const Demand& demand : demands) {
    const auto window =
        wire::cut_window(demand.choice.format.window, settings.azimuth_bins, settings.range_bins);
    if (!window) continue;
    order.takers.push_back(demand.watch_id);
    choices.insert(demand.choice);
    const ReceivedPlanes needed = needed_planes(demand.choice, settings);
    order.iq |= needed.iq;
    order.truth |= demand.choice.truth;
    order.video8 |= needed.video8;
    order.video16 |= needed.video16;
    order.bins |= (demand.choice.planes & wire::kBinPlanes) != 0;
    order.pulses |= wants_pulses(demand.choice, settings);
    if (demand.choice.planes & wire::plane_bit(wire::Plane::state)) order.states = true;
    if (demand.choice.planes & wire::kLabelPlanes) order.labels = true;
    if (demand.choice.planes & wire::kTargetPlane) order.target_ids = true;
    for (std::uint64_t azimuth = window->azimuth.first; azimuth < window->azimuth.end();
         azimuth += window->azimuth.step)
      wedges[static_cast<std::size_t>(azimuth) / kWedgeAzimuthBins] = true;
  }
  order.choices.assign(choices.begin(), choices.end());
  for (std::size_t i = 0; i < wedges.size(); ++i) {
    if (!wedges[i]) continue;
    const int first = static_cast<int>(i) * kWedgeAzimuthBins;
    const int count = std::min(kWedgeAzimuthBins, settings.azimuth_bins - first);
    if (i > 0 && wedges[i - 1]) {
      order.azimuths.back().count += count;
    } else {
      order.azimuths.push_back({first, count});
    }
  }
  return order;
}

}  // namespace obliq::rendering
