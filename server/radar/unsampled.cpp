#include "server/radar/unsampled.h"

#include <cstdio>

namespace obliq {

std::string unsampled_warning(const FrameStats& stats, const RadarSettings& settings) {
  if (!is_undersampled(stats)) return {};
  const char* remedy = "";
  switch (settings.frustum) {
    case FrustumKind::oblique:
      remedy =
          "frustum.quality = \"standard\" (the sweep) samples nearly all of them, \"oblique\" finds the "
          "pixels that do, "
          "as does a larger frustum.pixels";
      break;
    case FrustumKind::symmetric:
      remedy =
          "frustum.quality = \"standard\" (the sweep) samples nearly all of them, or take a larger "
          "frustum.pixels";
      break;
    case FrustumKind::polar:  // of recordings, which warn of nothing
    case FrustumKind::sweep:
      remedy = "take a larger frustum.pixel_columns, or frustum.quality = \"reference\"";
      break;
  }
  char text[400];
  std::snprintf(text, sizeof text, "%.1f %% of the lit bins (%llu of %llu) hold no sample: %s",
                100 * stats.unsampled_share(), static_cast<unsigned long long>(stats.unsampled_bins),
                static_cast<unsigned long long>(stats.lit_bins), remedy);
  return text;
}

}  // namespace obliq
