#include "terrain/base/stage_clock.h"

#include <ctime>
#include <numeric>

#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr std::array<const char*, kStages> kNames = {
    "load",      "grid",   "outlines", "build", "plan",   "rays",   "trace", "refine", "plates",
    "buildings", "ground", "scatter",  "bin",   "states", "encode", "send",  "wait",   "other"};

/// This thread's.
double processor_time_s() {
  timespec at{};
  (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &at);
  return static_cast<double>(at.tv_sec) + 1e-9 * static_cast<double>(at.tv_nsec);
}

}  // namespace

const char* stage_name(Stage stage) { return kNames[static_cast<std::size_t>(stage)]; }

void StageTimes::add(const PerStage& stages, double processor_s) {
  const std::scoped_lock lock(mutex_);
  for (std::size_t k = 0; k < stages_.size(); ++k) stages_[k] += stages[k];
  processor_s_ += processor_s;
  ++threads_;
}

double StageTimes::seconds(Stage stage) const { return to_seconds(stages_[static_cast<std::size_t>(stage)]); }

double StageTimes::total_s() const {
  return to_seconds(std::accumulate(stages_.begin(), stages_.end(), Duration::zero()));
}

constinit thread_local StageClock* StageClock::current_ = nullptr;

StageClock::StageClock(StageTimes* times) : times_(times) {
  if (!times_) return;
  processor_s_ = processor_time_s();
  since_ = Clock::now();
  current_ = this;
}

StageClock::~StageClock() {
  if (!times_) return;
  enter(Stage::other);
  current_ = nullptr;
  times_->add(stages_, processor_time_s() - processor_s_);
}

Stage StageClock::enter(Stage stage) {
  const auto now = Clock::now();
  stages_[static_cast<std::size_t>(stage_)] += now - since_;
  since_ = now;
  const Stage before = stage_;
  stage_ = stage;
  return before;
}

}  // namespace obliq
