#pragma once
#include <cstdint>
#include <memory>

#include "server/rendering/live_stream.h"

namespace obliq::net {

/// Renders the whole frames of a live radar, each when it is due. One that has begun is rendered to its end
/// before the next, though other jobs may have their turns in between.
class LiveJob : public Job {
 public:
  LiveJob(const RenderContext& context, LiveStream& stream);
  ~LiveJob() override;

  bool has_begun() const { return frame_ != nullptr; }
  Time date(Time now) override;
  bool work() override;

 private:
  struct Frame;
  /// Plans the newest frame that is due and sends its begin; false when there is none after all.
  bool begin();
  /// Renders until the frame is over, then true, or gives way.
  bool go_on(Frame& frame);
  void end(Frame& frame);

  const RenderContext& context_;
  LiveStream& stream_;
  std::unique_ptr<Frame> frame_;    ///< null: none has begun
  std::int64_t shown_pose_ns_ = 0;  ///< arrival of the newest pose that a frame has shown
};

}  // namespace obliq::net
