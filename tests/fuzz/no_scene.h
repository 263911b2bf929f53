#pragma once
// What a room of fuzz targets renders from: nothing.
#include "server/control/sections/radar.h"
#include "server/rendering/frame_renderer.h"

namespace obliq::fuzz {

class NoScene : public rendering::FrameRenderer {
 public:
  std::vector<FieldError> place(const PoseSettings& pose) const override {
    if (pose.height_m < 5000) return {};
    return {{"height_m", "too much", "less"}};
  }
  Plan plan(const SettingsPtr&, const PoseSettings&) const override { return {}; }
};

inline RadarConfig small_radar(const char* name) {
  RadarConfig radar;
  radar.name = name;
  return radar;
}

}  // namespace obliq::fuzz
