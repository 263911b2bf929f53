#pragma once
// Long computations report their work at intervals: there they may be paused, and end when they are no longer
// needed. The gate is thread-local, like the clock of stage_clock.h, so that inner loops need no parameter.
#include <cstddef>
#include <cstdint>
#include <limits>

namespace obliq {

/// Thrown by ask() where the work is no longer needed. No std::exception: handlers of faults let it pass.
struct Stopped {};

/// Receives how much work the threads of one task have done. From any of them.
class WorkGate {
 public:
  /// Between two calls of pass(), in units of ask(): some 1 ms.
  static constexpr std::int64_t kLook = 250'000;

  virtual ~WorkGate() = default;
  /// How much work a thread does between two calls of pass(); 0: every ask() calls it.
  virtual std::int64_t look() const { return kLook; }
  /// So much has been done since the last call. May wait; throws Stopped.
  virtual void pass(std::int64_t work) = 0;
  /// A thread begins to work, and it does so no longer. enter() may wait; neither throws.
  virtual void enter() {}
  virtual void leave() {}
};

namespace asking {
struct Count {
  std::int64_t left;  ///< until the gate is called
  WorkGate* gate;     ///< null: no gate counts this thread
};
constexpr Count kUnheard{std::numeric_limits<std::int64_t>::max(), nullptr};
extern constinit thread_local Count count;
void pass();
}  // namespace asking

/// This thread has done so much work: a unit is a cell, a tap, an echo or a triangle, some 5 ns. For every
/// loop to call at least once in kMostWork: per tile, row of cells, building or batch, never per element. May
/// wait, so hold no lock; throws Stopped, so not below code of others (TBB, Embree, GDAL).
constexpr std::int64_t kMostWork = 1'000'000;
inline void ask(std::int64_t work) {
  if ((asking::count.left -= work) < 0) asking::pass();
}

/// Of this thread; null: none.
inline WorkGate* gate_of_this_thread() { return asking::count.gate; }

/// As long as this lives, a gate counts the thread's work; null: none does.
class BehindGate {
 public:
  explicit BehindGate(WorkGate* gate);
  ~BehindGate();
  BehindGate(const BehindGate&) = delete;
  BehindGate& operator=(const BehindGate&) = delete;

 private:
  asking::Count before_;
};

/// As long as this lives, the thread only waits for others behind the same gate.
class OutsideGate {
 public:
  OutsideGate();
  ~OutsideGate();
  OutsideGate(const OutsideGate&) = delete;
  OutsideGate& operator=(const OutsideGate&) = delete;

 private:
  WorkGate* gate_;
};

/// Gives a large vector so many elements of one value. The first touch of fresh memory costs what a pass over
/// it does.
template <class Vector>
void fill(Vector& vector, std::size_t n, const typename Vector::value_type& value) {
  constexpr std::size_t kStep = (std::size_t{1} << 20) / sizeof(value);
  constexpr std::size_t kBytesAUnit = 8;
  vector.clear();
  vector.reserve(n);
  while (vector.size() < n) {
    const std::size_t more = n - vector.size() < kStep ? n - vector.size() : kStep;
    vector.resize(vector.size() + more, value);
    ask(static_cast<std::int64_t>(more * sizeof(value) / kBytesAUnit));
  }
}

}  // namespace obliq
