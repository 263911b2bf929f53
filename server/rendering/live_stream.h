#pragma once
// A live radar as the render thread sees it, and a frame of it that has begun.
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/radar/receiver/receiver.h"
#include "server/rendering/demand.h"
#include "server/rendering/fair_share.h"
#include "server/rendering/job.h"
#include "server/stream/frame_encoder.h"

namespace obliq::rendering {

/// The frames of a live radar: what its watchers ask for, when the next one is due, how many are alive, what
/// could not be rendered. Shared by the job that renders whole frames and the one that scans.
class LiveStream {
 public:
  using Time = Job::Time;

  /// on_freed: called, on any thread, whenever one of its frames has gone.
  LiveStream(RenderContext& context, std::size_t radar, std::string name, std::uint32_t stream_id,
             LiveView view, std::function<void()> on_freed);

  // From any thread:
  void set_view(LiveView view);
  /// None: no client watches; the current frame is given up.
  void set_demand(std::vector<Demand> demands);
  /// On: time stands still. What has begun goes on to its end, a pass to the end of its dwell; then each
  /// client gets one frame of the view that is set next, and nothing else begins. Of a radar that scans, the
  /// clients that watch keep what they have, and those that come get such a frame. Off: a pass goes on where
  /// it was.
  void hold(bool on);
  /// Gives up the current frame and begins no other.
  void stop();
  /// What its frames take up at present.
  struct Load {
    int live_frames = 0;
    std::size_t live_bytes = 0;
    std::size_t spare_bytes = 0;       ///< of blocks that were sent, kept for the next
    std::uint64_t frames_skipped = 0;  ///< because of the limit of live frames
    std::uint64_t frames_shed = 0;     ///< for lack of time
  };
  Load load() const;
  /// on_freed is not called any more once this returns.
  void forget_listener() { frames_->forget_listener(); }

  // For the render thread alone, or its work while it has its turn:
  std::size_t radar() const { return radar_; }
  const std::string& name() const { return name_; }
  std::shared_ptr<const LiveView> view() const;
  bool is_watched() const;
  /// Passes of a scan are wanted, not whole frames.
  bool wants_scan() const;
  /// It is held in a scan, and a client has come since.
  bool wants_still() const;

  /// Not empty: nothing begins before that date, because no client watches or the radar cannot be rendered as
  /// it is.
  std::optional<Time> rests_until(Time now);
  /// When the next whole frame is due.
  Time due() const;
  /// Dates up to now do not count: no client wanted a frame then.
  void put_off(Time now);
  /// With as many frames alive as may be, when to look again; else now. The periods missed meanwhile are
  /// counted as skipped.
  Time free_at(Time now);

  /// What a frame or a dwell begins with.
  struct Start {
    std::shared_ptr<const LiveView> view;
    std::vector<Demand> demands;
    double late_s = 0;  ///< of a whole frame, after its date
    std::stop_token stop;
  };
  /// A whole frame, for the demands that are due, with the pose of now. Empty: nothing is to be begun.
  std::optional<Start> begin_frame(Time now);
  /// The frame is for the demands that are not due, too.
  void take_all(Start& start) const;
  /// The frame was not made: its demands are due again.
  void give_back(const Start& start, Time now);
  /// A dwell of a scan, for all demands, with the view as it was set.
  std::optional<Start> begin_dwell();
  /// How long holds that have ended since the last call took in all.
  Time::duration take_pause();

  std::uint64_t next_frame_id() { return ++last_frame_; }
  /// Periods or passes that went by without a frame; the next FrameBegin reports them.
  void skip(std::uint64_t frames);
  /// Remembers what could not be rendered, and with which generation of the renderer; null: nothing.
  void set_faulty(std::shared_ptr<const LiveView> view, std::uint64_t generation);

 private:
  friend struct BegunFrame;

  bool wants_scan(const LiveView& view) const;
  /// It is held, and all who watch have its picture.
  bool stands_still() const;
  bool still_faulty(Time now) const;
  bool sheds_none() const;
  std::stop_token new_stop();

  RenderContext& context_;
  const std::size_t radar_;
  const std::string name_;
  const std::uint32_t stream_id_;
  const std::shared_ptr<stream::LiveFrames> frames_;
  std::atomic<std::uint64_t> skipped_in_all_{0};
  std::atomic<std::uint64_t> shed_{0};

  mutable std::mutex mutex_;  ///< guards what follows, up to the next comment of this kind
  std::shared_ptr<const LiveView> view_;
  std::vector<Demand> demands_;
  double rate_hz_ = 0;  ///< the greatest; 0: no client watches
  FrameDates dates_;
  Time held_up_since_ = Time::max();  ///< of a frame due; max: it is not
  std::stop_source stop_;             ///< of the current frame
  bool stopped_ = false;
  std::optional<Time> held_since_;  ///< empty: it is not held
  Time::duration pause_{};

  // The same two's alone:
  Time next_reminder_{};
  std::shared_ptr<const LiveView> faulty_;
  std::uint64_t faulty_generation_ = 0;
  std::uint64_t last_frame_ = 0;
  std::uint64_t skipped_ = 0;  ///< since the newest frame
  std::uint64_t sequence_ = 0;
};

/// A frame of the stream that has begun: a whole one, or a pass of a scan.
struct BegunFrame {
  BegunFrame(LiveStream& stream, std::uint64_t frame_id, std::unique_ptr<PlannedFrame> planned,
             const RadarSettings& settings, const Order& order, const LiveView& view, double waited_s);

  void send(std::vector<stream::BlockPtr> blocks) const;
  /// Of any part of it, as the view is, with the targets that there are.
  RenderOptions render_options(const std::stop_token& stop, const LiveView& view) const;
  /// The world has moved on.
  void take_targets() { targets = stream.context_.targets.get(); }
  /// A train along these azimuths, to clients that asked. False when stopped.
  bool send_train(const TrainLook& look, const RenderOptions& options);
  /// Where targets are, to clients that asked: of what has just been rendered with these options.
  void send_truth(const AzimuthRange& azimuths, const RenderOptions& options);
  /// FrameBegin, with the pose of `view`.
  void send_begin(const LiveView& view);
  /// FrameEnd; `rendered` is given the counts of what was rendered.
  void send_end(const std::vector<AzimuthRange>& missed = {});
  void send_abort(const std::string& reason);

  LiveStream& stream;
  const std::uint64_t frame_id;
  stream::FrameEncoder encoder;
  FrameSum stats;
  RenderedFrame rendered;
  stream::LiveFramePtr frame;
  bool iq = false;
  bool states = false;
  bool video8 = false;
  bool video16 = false;
  bool labels = false;
  bool target_ids = false;
  bool truth = false;
  bool bins = false;
  bool pulses = false;
  int azimuth_bins = 0;
  TargetsPtr targets;  ///< in the world; null: none
  std::unique_ptr<PlannedFrame> plan;
  std::optional<Receiver> receiver;  ///< none where the renderer only replays: what it has been received
};

}  // namespace obliq::rendering
