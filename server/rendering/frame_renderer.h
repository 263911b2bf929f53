#pragma once
// What the render thread needs of the radar pipeline, as an interface: the network side is tested with a
// stand-in that needs no scene.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "proto/plane.h"
#include "server/radar/render.h"
#include "terrain/base/errors.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq::net {

class PlannedFrame {
 public:
  virtual ~PlannedFrame() = default;
  virtual void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const = 0;
  /// As obliq::render_wedges.
  virtual bool render(AzimuthRange azimuths, const RenderOptions& options) const = 0;
  virtual void summarise(const FrameStats& stats, wire::FrameSummary& summary) const = 0;
  /// Buildings that what was rendered has seen; and those of an earlier frame whose wedges it has.
  virtual std::vector<std::uint32_t> seen() const { return {}; }
  virtual void see_again(const std::vector<std::uint32_t>& /*buildings*/) const {}
  /// The same frame once more, of which nothing has been rendered, with another number and date of the same
  /// antenna. Null: it must be planned anew.
  virtual std::unique_ptr<PlannedFrame> again(const PoseSettings& /*pose*/) const { return nullptr; }
};

/// Called from several threads at once.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  /// Why an antenna cannot be there; empty: it can. Fast.
  virtual std::vector<FieldError> place(const PoseSettings& pose) const = 0;

  struct Plan {
    std::unique_ptr<PlannedFrame> frame;  ///< null when there are errors
    std::vector<FieldError> errors;
    SettingsPtr settings;  ///< what the frame was really made with; null: what was asked for
  };
  /// Changes when the scene has: what could not be rendered before may be now.
  virtual std::uint64_t generation() const { return 0; }
  /// Neither a frame nor errors: nothing new yet, and the time until then has been waited for.
  virtual Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const = 0;
  /// Another pose of the same pass: in the scene that `frame` was planned in.
  virtual Plan plan_again(const PlannedFrame&, const SettingsPtr& settings, const PoseSettings& pose) const {
    return plan(settings, pose);
  }

  /// Why nobody may change anything or have a frame rendered, for a renderer that only repeats; empty: all
  /// may.
  virtual std::string fixed() const { return {}; }
  /// The planes that frames bring.
  virtual wire::PlaneSet planes() const { return wire::kAllPlanes; }
};

}  // namespace obliq::net
