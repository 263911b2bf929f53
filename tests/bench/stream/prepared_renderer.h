#pragma once
#include "server/rendering/frame_renderer.h"

namespace obliq::bench {

/// Frames that cost nothing to render: each wedge was rendered long ago. For benchmarks of what comes behind.
class PreparedRenderer : public rendering::FrameRenderer {
 public:
  explicit PreparedRenderer(int range_bins);
  std::vector<FieldError> place(const PoseSettings&) const override { return {}; }
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override;

 private:
  mutable Wedge wedge_;
};

}  // namespace obliq::bench
