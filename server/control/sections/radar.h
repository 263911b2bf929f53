#pragma once
// [radar] or [[radar]] with [antenna], [mount], [frustum], [bins], [scan], [beam], [pulse], [receiver],
// [video] and [atmosphere].
#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/control/mount.h"
#include "server/radar/settings.h"

namespace obliq {

struct SceneConfig;
struct SceneReading;
template <class T>
struct SpecialKey;

/// One named radar as it is configured: how it looks and where it stands.
struct RadarConfig {
  std::string name = "main";
  RadarSettings settings;
  PoseSettings pose;
  bool finds_pixels =
      false;  ///< pixel_columns and pixel_rows are to be found (server/loading/scene_loading.h)
  /// That it rides on: its place is that one's (server/control/mount.h). Null: none.
  std::shared_ptr<const PlatformConfig> platform = nullptr;
  Mount mount = {};
};

/// Tables of a radar beside its own: in the scene file for all radars, or in [radar] for one.
inline constexpr std::array<std::string_view, 12> kRadarTables{"antenna",  "mount", "frustum",    "bins",
                                                               "scan",     "beam",  "pulse",      "doppler",
                                                               "receiver", "video", "atmosphere", "sea"};

/// The short forms frustum.quality and frustum.pixels, and what else no message carries.
std::span<const SpecialKey<RadarConfig>> radar_special_keys();

/// Which radars name no position of their own (by index): they get the terrain's centre.
struct MissingPosition {
  std::size_t radar;
  bool latitude;
  bool longitude;
};
std::vector<MissingPosition> read_radars(SceneReading& scene);
std::string printed_radars(const SceneConfig& config);

}  // namespace obliq
