#include "server/flight/speedometer.h"

#include "terrain/base/seconds.h"

namespace obliq {

void Speedometer::note(std::span<const RadarPlace> radars, Time now) {
  heard_ = now;
  const double elapsed_s = to_seconds(now - since_);
  const bool comparable = to_.size() == radars.size();
  if (comparable && elapsed_s < 0.5) return;
  from_ = to_;
  elapsed_s_ = comparable ? elapsed_s : 0;
  to_.assign(radars.begin(), radars.end());
  since_ = now;
}

std::vector<RadarPlace> Speedometer::ahead(std::span<const RadarPlace> radars, double later_s,
                                           Time now) const {
  std::vector<RadarPlace> places(radars.begin(), radars.end());
  if (now - heard_ > kStandsAfter || elapsed_s_ <= 0 || from_.size() != places.size()) return places;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LonLat& from = from_[i].position;
    const LonLat moved = towards(from, to_[i].position, later_s / elapsed_s_);
    LonLat& at = places[i].position;
    at = {at.longitude_deg + moved.longitude_deg - from.longitude_deg,
          at.latitude_deg + moved.latitude_deg - from.latitude_deg};
  }
  return places;
}

}  // namespace obliq
