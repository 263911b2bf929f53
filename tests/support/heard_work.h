#pragma once
// Counts every ask() of a thread: how much work there was between two, and in all.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>

#include "terrain/base/asking.h"

namespace obliq::test {

class HeardWork : public WorkGate {
 public:
  std::int64_t look() const override { return 0; }
  void pass(std::int64_t work) override {
    total_ += work;
    ++asks_;
    if (work > most_) most_ = work;
    if (on_ask) on_ask();
    if (asks_ >= most_asks || total_ >= most_total) throw Stopped{};
  }

  std::function<void()> on_ask;
  /// The work is stopped then.
  std::int64_t most_asks = std::numeric_limits<std::int64_t>::max();
  std::int64_t most_total = std::numeric_limits<std::int64_t>::max();

  std::int64_t asks() const { return asks_; }
  std::int64_t total() const { return total_; }
  std::int64_t most() const { return most_; }

 private:
  std::atomic<std::int64_t> asks_ = 0;
  std::atomic<std::int64_t> total_ = 0;
  std::atomic<std::int64_t> most_ = 0;  ///< with one thread
};

/// Calls work(), heard; false when it was stopped.
inline bool hear(HeardWork& heard, const std::function<void()>& work) {
  try {
    const BehindGate behind(&heard);
    work();
  } catch (const Stopped&) {
    return false;
  }
  return true;
}

}  // namespace obliq::test
