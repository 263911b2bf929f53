#include "server/rendering/appraisal_job.h"

#include <exception>
#include <utility>

namespace obliq::rendering {

AppraisalJob::AppraisalJob(const RenderContext& context) : context_(context) {}

void AppraisalJob::enqueue(AppraisalPtr appraisal) {
  const std::lock_guard lock(mutex_);
  queue_.push_back(std::move(appraisal));
}

void AppraisalJob::stop() {
  const std::lock_guard lock(mutex_);
  for (const AppraisalPtr& appraisal : queue_) appraisal->stop.request_stop();
  if (appraisal_) appraisal_->stop.request_stop();
}

Job::Time AppraisalJob::date(Time now) {
  if (work_) return now;
  const std::lock_guard lock(mutex_);
  if (context_.finishing) queue_.clear();
  std::erase_if(queue_, [](const AppraisalPtr& appraisal) { return appraisal->stop.stop_requested(); });
  return queue_.empty() ? Time::max() : now;
}

bool AppraisalJob::work() {
  if (!work_ && !begin()) return true;
  try {
    if (!context_.turn(*work_)) return false;
  } catch (const std::exception& failure) {  // no memory, above all
    faults_ = memory_failure(failure);
  }
  work_ = nullptr;
  if (!appraisal_->stop.stop_requested()) context_.events.on_appraised(appraisal_, faults_);
  return true;
}

bool AppraisalJob::begin() {
  {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return false;
    appraisal_ = std::move(queue_.front());
    queue_.pop_front();
  }
  faults_.clear();
  const auto appraise = [this] {
    faults_ = context_.renderer.faults(appraisal_->settings, appraisal_->pose);
  };
  work_ = std::make_unique<ParkedWork>(appraise, appraisal_->stop.get_token(), context_.options.look);
  return true;
}

}  // namespace obliq::rendering
