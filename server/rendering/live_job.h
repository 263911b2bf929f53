#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "server/rendering/live_stream.h"

namespace obliq::rendering {

/// Renders the whole frames of a live radar, each when it is due. One that has begun is rendered to its end
/// before the next, though other jobs may have their turns in between.
class LiveJob : public Job {
 public:
  LiveJob(const RenderContext& context, LiveStream& stream);
  ~LiveJob() override;

  bool has_begun() const { return work_ != nullptr; }
  Time date(Time now) override;
  bool work() override;
  /// Aborts a frame that has begun.
  void give_up();

 private:
  /// Plans the newest frame that is due and renders it.
  void render();
  bool plan();
  void end();

  const RenderContext& context_;
  LiveStream& stream_;
  std::int64_t shown_pose_ns_ = 0;  ///< arrival of the newest pose that a frame has shown

  // Of the current frame:
  LiveStream::Start start_;
  Time begun_;
  std::uint64_t generation_ = 0;  ///< of the renderer when it was planned
  std::vector<AzimuthRange> azimuths_;
  std::vector<FieldError> errors_;
  std::unique_ptr<BegunFrame> frame_;  ///< null: not yet planned
  std::unique_ptr<ParkedWork> work_;   ///< null: none has begun
};

}  // namespace obliq::rendering
