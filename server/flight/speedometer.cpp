#include "server/flight/speedometer.h"

#include <algorithm>

namespace obliq {

void Speedometer::note(std::span<const RadarPlace> radars, Time now) {
  const double elapsed_s = std::chrono::duration<double>(now - since_).count();
  const bool comparable = from_.size() == radars.size();
  if (comparable && elapsed_s < 0.5) return;
  speed_m_s_ = 0;
  if (comparable) {
    for (std::size_t i = 0; i < radars.size(); ++i) {
      speed_m_s_ = std::max(speed_m_s_, distance_m(from_[i].position, radars[i].position) / elapsed_s);
    }
  }
  from_.assign(radars.begin(), radars.end());
  since_ = now;
}

}  // namespace obliq
