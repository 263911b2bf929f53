#include "server/rendering/parked_work.h"

#include <utility>

namespace obliq::rendering {

ParkedWork::ParkedWork(std::function<void()> work, std::stop_token stop, std::int64_t look)
    : work_(std::move(work)), stop_(std::move(stop)), look_(look) {}

ParkedWork::~ParkedWork() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    given_up_ = true;
    let_go();
  }
  thread_.join();
}

bool ParkedWork::turn(const IsOver& is_over) {
  std::unique_lock lock(mutex_);
  is_over_ = &is_over;
  done_ = 0;
  parking_ = false;
  if (!thread_.joinable()) {
    thread_ = std::thread([this] { run(); });
  } else {
    let_go();
  }
  changed_.wait(lock, [this] { return ended_ || (parking_ && working_ == 0); });
  if (!ended_) return false;
  lock.unlock();
  thread_.join();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return true;
}

void ParkedWork::run() {
  try {
    const BehindGate behind(this);
    work_();
  } catch (const Stopped&) {
  } catch (...) {
    failure_ = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

/// All that are parked go on: every thread has a part of every turn. With the mutex held.
void ParkedWork::let_go() {
  working_ += std::exchange(parked_, 0);
  ++turns_;
  changed_.notify_all();
}

/// Waits for the next turn. The thread does not count as working.
void ParkedWork::park(std::unique_lock<std::mutex>& lock) {
  ++parked_;
  if (working_ == 0) changed_.notify_all();
  changed_.wait(lock, [this, turn = turns_] { return turns_ != turn; });
}

void ParkedWork::pass(std::int64_t work) {
  const std::int64_t done = done_ += work;
  if (!given_up_ && !stop_.stop_requested() && (parking_ || (*is_over_)(done))) {
    std::unique_lock lock(mutex_);
    parking_ = true;
    if (!given_up_) {
      --working_;
      park(lock);
    }
  }
  if (given_up_ || stop_.stop_requested()) throw Stopped{};
}

void ParkedWork::enter() {
  std::unique_lock lock(mutex_);
  if (given_up_ || !parking_) {
    ++working_;
  } else {
    park(lock);
  }
}

void ParkedWork::leave() {
  const std::lock_guard lock(mutex_);
  if (--working_ == 0) changed_.notify_all();
}

}  // namespace obliq::rendering
