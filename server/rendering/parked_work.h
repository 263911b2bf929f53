#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "terrain/base/asking.h"

namespace obliq::rendering {

/// Work on threads of its own that wait, wherever they are, between its turns: where one of them asks
/// (terrain/base/asking.h) when a turn has lasted long enough. So it is written as if nothing ever
/// interrupted it. Its first thread is made by this; those that it makes itself go behind the same gate.
class ParkedWork : private WorkGate {
 public:
  /// Told what all threads have done in the turn: whether it is over. From any of them; fast.
  using IsOver = std::function<bool(std::int64_t work)>;

  /// Begins with the first turn. After a request to stop its threads unwind when they next ask: in a turn, or
  /// when this is destroyed. look: as WorkGate::look, for tests.
  ParkedWork(std::function<void()> work, std::stop_token stop, std::int64_t look = kLook);
  /// Stops what has not ended, and waits for it.
  ~ParkedWork() override;
  ParkedWork(const ParkedWork&) = delete;
  ParkedWork& operator=(const ParkedWork&) = delete;

  /// Lets the work go on until it has ended, then true, or until its turn is over. Throws what ended it, but
  /// for Stopped. All its threads have then seen what this thread wrote before, and the other way round.
  bool turn(const IsOver& is_over);

 private:
  std::int64_t look() const override { return look_; }
  void pass(std::int64_t work) override;
  void enter() override;
  void leave() override;

  void run();
  void park(std::unique_lock<std::mutex>& lock);
  void let_go();

  const std::function<void()> work_;
  const std::stop_token stop_;
  const std::int64_t look_;
  std::atomic<std::int64_t> done_ = 0;  // in this turn
  std::atomic<bool> parking_ = true;    // the turn is over, or none has begun
  std::atomic<bool> given_up_ = false;
  const IsOver* is_over_ = nullptr;  // written while all are parked

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  int working_ = 0;  // threads
  int parked_ = 0;
  std::uint64_t turns_ = 0;
  bool ended_ = false;
  std::exception_ptr failure_;

  std::thread thread_;
};

}  // namespace obliq::rendering
