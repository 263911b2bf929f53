#pragma once
// Where time goes. A thread that is measured is in exactly one stage at any moment, so that the times of its
// stages add up to its own, by construction. A thread that is not pays one look at a null pointer a probe.
#include <array>
#include <chrono>
#include <mutex>

namespace obliq {

/// Of loading a scene, of a frame, and what is neither. Their order is that of the tables.
enum class Stage {
  load,       ///< elevation models are opened and read
  grid,       ///< their heights become the world's grid
  outlines,   ///< footprints and random prisms become buildings, surfaces are painted
  build,      ///< the ray tracer's scene and the indexes over ground and buildings
  plan,       ///< what the wedges of a frame share
  rays,       ///< rays of a frustum: directions and solid angles
  trace,      ///< what rays meet: marched, or by Embree
  refine,     ///< hits again in double, leaks traced again
  plates,     ///< spread plates: which bins a pixel covers
  buildings,  ///< the sweep: strands at buildings, with the ground before and behind them
  ground,     ///< the sweep: bare ground
  scatter,    ///< samples to powers, sorted into bins and scatterers
  bin,        ///< scatterers to voltages, the wedge's planes
  states,     ///< why bins are without samples, coverage
  encode,     ///< messages of the wire
  send,       ///< to the socket, and at the end until the reader has the last byte
  wait,       ///< for another thread to deliver its wedge
  other,      ///< everything between the probes
};
constexpr int kStages = static_cast<int>(Stage::other) + 1;

const char* stage_name(Stage stage);

/// What the threads of one piece of work have spent, added up.
class StageTimes {
 public:
  using Duration = std::chrono::steady_clock::duration;
  using PerStage = std::array<Duration, kStages>;

  /// A thread's share; from any thread.
  void add(const PerStage& stages, double processor_s);

  // After the threads have ended:
  double seconds(Stage stage) const;
  /// Of all stages and threads.
  double total_s() const;
  /// How much of total_s() the threads had a processor for.
  double processor_s() const { return processor_s_; }
  int threads() const { return threads_; }  ///< that have added something

 private:
  std::mutex mutex_;
  PerStage stages_{};
  double processor_s_ = 0;
  int threads_ = 0;
};

/// Measures the thread that made it, for as long as it lives; one at a time. Begins in Stage::other.
class StageClock {
 public:
  /// Null: nothing is measured, and no clock is read.
  explicit StageClock(StageTimes* times);
  ~StageClock();
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  friend class StageProbe;
  using Clock = std::chrono::steady_clock;

  /// The time until now belongs to the stage so far. Returns that one.
  Stage enter(Stage stage);

  /// Of this thread; null where nothing is measured. Thread-local, so that a stage deep down in the pipeline
  /// needs no parameter through all that calls it.
  static constinit thread_local StageClock* current_;

  StageTimes* times_;
  StageTimes::PerStage stages_{};
  Stage stage_ = Stage::other;
  Clock::time_point since_;
  double processor_s_ = 0;
};

/// The thread is in `stage` as long as this lives, but for probes within. Put it around batches, not samples:
/// it reads the clock twice where the thread is measured.
class StageProbe {
 public:
  explicit StageProbe(Stage stage) : clock_(StageClock::current_) {
    if (clock_) before_ = clock_->enter(stage);
  }
  ~StageProbe() {
    if (clock_) clock_->enter(before_);
  }
  StageProbe(const StageProbe&) = delete;
  StageProbe& operator=(const StageProbe&) = delete;

 private:
  StageClock* clock_;
  Stage before_ = Stage::other;
};

}  // namespace obliq
