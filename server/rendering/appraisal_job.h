#pragma once
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "server/rendering/job.h"

namespace obliq::rendering {

/// Says of settings whether frames of them can be planned (FrameRenderer::faults), where that needs the
/// ground. One after the other, in the order in which they came.
class AppraisalJob : public Job {
 public:
  explicit AppraisalJob(const RenderContext& context);

  /// From any thread.
  void enqueue(AppraisalPtr appraisal);
  /// From any thread: appraisals that wait or run are no longer reported.
  void stop();
  /// Ends the current appraisal.
  void give_up() { work_ = nullptr; }

  Time date(Time now) override;
  bool work() override;

 private:
  bool begin();

  const RenderContext& context_;
  std::mutex mutex_;  ///< guards the queue, and the start of another appraisal
  std::deque<AppraisalPtr> queue_;

  // Current:
  AppraisalPtr appraisal_;
  std::vector<FieldError> faults_;
  std::unique_ptr<ParkedWork> work_;  ///< null: none has begun
};

}  // namespace obliq::rendering
