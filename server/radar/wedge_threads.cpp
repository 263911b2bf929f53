// The threads of a rendering: which of them renders which wedge, pauses, delivery. Wedges know nothing of
// each other, so the bits are the same for any number of threads and any pauses.
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "server/radar/receiver/receiver.h"
#include "server/radar/wedge_work.h"
#include "terrain/base/stage_clock.h"

namespace obliq {

class BegunWedges {
 public:
  BegunWedges(const FramePlan& plan, int first, int threads)
      : tables(plan), next(first), work(static_cast<std::size_t>(threads)) {}

  const FrameTables tables;
  std::atomic<int> next;
  std::vector<std::unique_ptr<WedgeWork>> work;  // each thread's
};

namespace {

/// One call of render_wedges.
class WedgeThreads {
 public:
  WedgeThreads(const FramePlan& plan, int end, const RenderOptions& options, BegunWedges& begun)
      : plan_(plan), end_(end), options_(options), begun_(begun) {}

  /// True when it has paused.
  bool run() {
    {
      std::vector<std::jthread> helpers;
      for (std::size_t t = 1; t < begun_.work.size(); ++t)
        helpers.emplace_back([this, t] { work_until_done(begun_.work[t]); });
      work_until_done(begun_.work[0]);
    }
    if (failure_) std::rethrow_exception(failure_);
    return paused_ && !stopped();
  }

 private:
  bool stopped() const { return options_.stop.stop_requested(); }

  void work_until_done(std::unique_ptr<WedgeWork>& work) {
    const StageClock clock(options_.times);
    try {
      if (!work) work = std::make_unique<WedgeWork>(plan_, begun_.tables, options_);
      render_wedges(*work);
    } catch (...) {
      if (!failed_.exchange(true)) failure_ = std::current_exception();
    }
  }

  void render_wedges(WedgeWork& work) {
    // A pause is due when a thread has done its share: a wedge has one thread, and may be all that there is.
    const int threads = static_cast<int>(begun_.work.size());
    int batches = options_.pause ? std::max(1, options_.pause->batches / threads) : 0;
    const std::function<bool()> may_go_on = [&] {
      if (stopped()) return false;
      if (!options_.pause) return true;
      return --batches > 0 && !(options_.pause->is_due && options_.pause->is_due());
    };
    while (!stopped() && !failed_) {
      if (!work.begun()) {
        const int index = begun_.next++;
        if (index >= end_) return;
        if (options_.before_wedge) options_.before_wedge(index);
        begin_wedge(work, index, options_.observer);
      }
      if (!render_wedge(work, options_.states, may_go_on)) {
        if (!stopped()) paused_ = true;
        return;
      }
      if (options_.receiver != nullptr) {
        const StageProbe probe(Stage::bin);
        options_.receiver->receive(work.wedge.bins, {options_.iq, options_.video8, options_.video16});
      }
      deliver(std::move(work.wedge));
    }
  }

  void deliver(Wedge&& wedge) {
    std::unique_lock lock(delivery_, std::defer_lock);
    {
      const StageProbe probe(Stage::wait);
      lock.lock();
    }
    if (options_.on_wedge && !failed_) options_.on_wedge(std::move(wedge));
  }

  const FramePlan& plan_;
  int end_;
  const RenderOptions& options_;
  BegunWedges& begun_;
  std::atomic<bool> paused_{false};
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::mutex delivery_;
};

}  // namespace

bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options) {
  const int first = azimuths.first / kWedgeAzimuthBins;
  const int end = std::min(wedge_count(plan.settings().azimuth_bins),
                           (azimuths.first + azimuths.count + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins);
  const int threads = options.threads > 0
                          ? options.threads
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::shared_ptr<BegunWedges> begun;
  if (options.pause) begun = std::exchange(options.pause->begun, nullptr);
  if (!begun) begun = std::make_shared<BegunWedges>(plan, first, threads);
  const bool paused = WedgeThreads(plan, end, options, *begun).run();
  if (paused) options.pause->begun = std::move(begun);
  return !options.stop.stop_requested();
}

}  // namespace obliq
