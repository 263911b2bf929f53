#pragma once
// A recorded frame in the place of a rendered one: each wedge when it was sent.
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "client/recording/recorded_frames.h"
#include "server/apps/replay/playback_clock.h"
#include "server/radar/receiver/video.h"
#include "server/rendering/frame_renderer.h"

namespace obliq {

/// For the render thread alone.
class ReplayedFrame : public rendering::PlannedFrame {
 public:
  struct Times {
    std::int64_t begin_ns = 0;       ///< of the frame, by the clock
    std::int64_t keep_until_ns = 0;  ///< what is up to there is shown at once, wherever the clock is
    std::uint64_t jumps = 0;         ///< of the clock; with another number the frame ends
  };
  /// video: the recorded one's. The clock must outlive this.
  ReplayedFrame(std::shared_ptr<const client::RecordedFrame> recorded, const VideoScale& video,
                PlaybackClock& clock, const Times& times);
  ~ReplayedFrame() override;

  void describe(const std::string&, wire::FrameDescriptor& descriptor) const override;
  bool render(AzimuthRange azimuths, const RenderOptions& options) const override;
  std::vector<wire::TargetRecord> truth(AzimuthRange, const RenderOptions&, double) const override;
  void summarise(const FrameStats&, wire::FrameSummary& summary) const override;
  const wire::ScanPass* scan() const override;
  const wire::WedgeBlock* dwell() const override { return dwell_.get(); }
  std::vector<AzimuthRange> missed() const override;
  std::string why_stopped() const override;

 private:
  bool wait_until(std::int64_t utc_ns, const std::stop_token& stop) const;
  void take_dwell(const client::RecordedWedge& recorded) const;
  void give_trains(const client::RecordedWedge& recorded, const RenderOptions& options) const;

  std::shared_ptr<const client::RecordedFrame> recorded_;
  VideoScale video_;
  PlaybackClock& clock_;
  Times times_;
  mutable std::unique_ptr<wire::ScanPass> scan_;
  mutable std::unique_ptr<wire::WedgeBlock> dwell_;  ///< of the current wedge
  mutable std::set<const client::AssembledTrain*> given_;
};

}  // namespace obliq
