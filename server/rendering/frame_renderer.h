#pragma once
// The radar pipeline as the render thread sees it: an interface, so that tests need no scene.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/plane.h"
#include "proto/target_record.h"
#include "server/radar/pulses/render_train.h"
#include "server/radar/receiver/weather.h"
#include "server/radar/render.h"
#include "server/radar/targets/target_echoes.h"
#include "terrain/base/errors.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
class ScanPass;
class WedgeBlock;
}  // namespace obliq::wire

namespace obliq::rendering {

class ReplayControl;  // server/rendering/replay_control.h

class PlannedFrame {
 public:
  virtual ~PlannedFrame() = default;
  virtual void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const = 0;
  /// As obliq::render_wedges.
  virtual bool render(AzimuthRange azimuths, const RenderOptions& options) const = 0;
  /// As obliq::render_train, of a radar that gives out its pulses; nothing when stopped. Of a frame that was
  /// recorded render() has them (RenderOptions::on_train), and this has none.
  virtual std::optional<RenderedTrain> render_train(const TrainLook&, const RenderOptions&) const {
    return RenderedTrain{};
  }
  /// What targets render() adds to the echoes of the ground; null: none.
  virtual std::unique_ptr<const TargetEchoes> targets(AzimuthRange, const RenderOptions&) const {
    return nullptr;
  }
  /// Where they are: of all azimuths, or of a dwell's, at most wire::kMaxTargetRecords. noise_power_w: what
  /// they are held against; 0: nothing.
  virtual std::vector<wire::TargetRecord> truth(AzimuthRange, const RenderOptions&,
                                                double /*noise_power_w*/) const {
    return {};
  }
  virtual void summarise(const FrameStats& stats, wire::FrameSummary& summary) const = 0;
  /// Where the antenna is in the air.
  virtual AirView air() const { return {}; }
  /// Buildings seen by what was rendered, and by the wedges reused from an earlier frame.
  virtual std::vector<std::uint32_t> seen() const { return {}; }
  virtual void see_again(const std::vector<std::uint32_t>& /*buildings*/) const {}
  /// The same plan, nothing of it rendered, with the number and date of another pose of the same antenna.
  /// Null: it must be planned anew.
  virtual std::unique_ptr<PlannedFrame> again(const PoseSettings& /*pose*/) const { return nullptr; }

  // Of a frame that was recorded, by this server's clock from now on:
  /// The pass that it is; null: all of the sector at once.
  virtual const wire::ScanPass* scan() const { return nullptr; }
  /// Facts of the current wedge, asked while on_wedge is called; null: what the frame says.
  virtual const wire::WedgeBlock* dwell() const { return nullptr; }
  /// Azimuth bins that its antenna missed.
  virtual std::vector<AzimuthRange> missed() const { return {}; }
  /// Why render() was false.
  virtual std::string why_stopped() const { return "the server has stopped rendering this frame"; }
};

/// Called from several threads at once.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  /// Why an antenna cannot be at this pose; empty: it can. Fast.
  virtual std::vector<FieldError> place(const PoseSettings& pose) const = 0;

  /// Why what the scene is made of does not go with these settings; empty: it does. Fast.
  virtual std::vector<FieldError> scene_faults(const RadarSettings&) const { return {}; }

  /// Why a frame of these settings from this pose could not be planned, as far as that is seen without a
  /// plan. May have to look at the ground: for the render thread.
  virtual std::vector<FieldError> faults(const RadarSettings&, const PoseSettings&) const { return {}; }

  struct Plan {
    std::unique_ptr<PlannedFrame> frame;  ///< null when there are errors
    std::vector<FieldError> errors;
    SettingsPtr settings;  ///< what the frame was made with; null: the settings asked for
    bool for_all = false;  ///< all watchers get it, whatever their rate: no frame may follow for long
  };
  /// As FrameDescriptor has it; empty: not known.
  virtual std::string scene_hash() const { return {}; }
  /// Changes with the scene: a frame that failed before may be possible now.
  virtual std::uint64_t generation() const { return 0; }
  /// Both empty: not ready; the call blocked for a moment.
  virtual Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const = 0;
  /// Another pose of the same pass: in the scene that `frame` was planned in.
  virtual Plan plan_again(const PlannedFrame&, const SettingsPtr& settings, const PoseSettings& pose) const {
    return plan(settings, pose);
  }

  /// Of a renderer that only replays: why no client may change anything or have a frame rendered. Else empty.
  virtual std::string fixed() const { return {}; }
  /// For a replay: frames are recorded passes of a scanning antenna; all watchers receive all of them,
  /// at any rate.
  virtual bool has_passes() const { return false; }
  /// The same renderer's controls; null: it replays nothing.
  virtual ReplayControl* replay() const { return nullptr; }
  /// The planes that its frames have.
  virtual wire::PlaneSet planes() const { return wire::kEveryPlane; }
};

}  // namespace obliq::rendering
