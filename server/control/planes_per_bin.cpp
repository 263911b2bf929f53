#include "server/control/planes_per_bin.h"

#include <algorithm>
#include <cstdint>
#include <string>

namespace obliq {

void settle_planes(RadarSettings& settings, bool columns_named) {
  if (columns_named) settings.planes_per_bin = 0;
  if (settings.frustum != FrustumKind::sweep || settings.planes_per_bin <= 0) return;
  settings.pixel_columns = static_cast<int>(std::clamp<std::int64_t>(
      std::int64_t{settings.planes_per_bin} * settings.azimuth_bins, 1, kMostPlanes));
}

std::optional<FieldError> planes_fault(const RadarSettings& s) {
  if (s.frustum != FrustumKind::sweep || s.planes_per_bin <= 0 || s.azimuth_bins < 1) return std::nullopt;
  const int most = (kMostPlanes + s.azimuth_bins - 1) / s.azimuth_bins;
  if (s.planes_per_bin <= most) return std::nullopt;
  return FieldError{
      "frustum.planes_per_bin",
      std::to_string(s.planes_per_bin) + " with bins.azimuth = " + std::to_string(s.azimuth_bins),
      "at most " + std::to_string(most) + ": " + std::to_string(kMostPlanes) + " planes in all"};
}

}  // namespace obliq
