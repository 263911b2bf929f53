#pragma once
// A recorded frame in the place of a rendered one: each wedge when it was sent.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/recorded_frames.h"
#include "server/apps/replay/playback_clock.h"
#include "server/radar/receiver/video.h"
#include "server/rendering/frame_renderer.h"

namespace obliq {

/// For the render thread alone.
class ReplayedFrame : public net::PlannedFrame {
 public:
  /// video: the recorded one's. begins_ns: by the clock, which must outlive this. jumps: of the clock; with
  /// another one, the frame ends.
  ReplayedFrame(std::shared_ptr<const client::RecordedFrame> recorded, const VideoScale& video,
                std::int64_t begins_ns, PlaybackClock& clock, std::uint64_t jumps);
  ~ReplayedFrame() override;

  void describe(const std::string&, wire::FrameDescriptor& descriptor) const override;
  bool render(AzimuthRange azimuths, const RenderOptions& options) const override;
  void summarise(const FrameStats&, wire::FrameSummary& summary) const override;
  const wire::ScanPass* scan() const override;
  const wire::WedgeBlock* dwell() const override { return dwell_.get(); }
  std::vector<AzimuthRange> missed() const override;
  std::string why_stopped() const override;

 private:
  bool wait_until(std::int64_t utc_ns, const std::stop_token& stop) const;
  void take_dwell(const client::RecordedWedge& recorded) const;

  std::shared_ptr<const client::RecordedFrame> recorded_;
  VideoScale video_;
  std::int64_t begins_ns_;
  PlaybackClock& clock_;
  std::uint64_t jumps_;
  mutable std::unique_ptr<wire::ScanPass> scan_;
  mutable std::unique_ptr<wire::WedgeBlock> dwell_;  ///< of the wedge in hand
};

}  // namespace obliq
