// The threads of a rendering: which of them renders which wedge, delivery. Wedges know nothing of each other,
// so the bits are the same for any number of threads.
#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "server/radar/receiver/receiver.h"
#include "server/radar/targets/target_echoes.h"
#include "server/radar/wedge_sums.h"
#include "server/radar/wedge_work.h"
#include "terrain/base/asking.h"
#include "terrain/base/stage_clock.h"

namespace obliq {

namespace {

/// Of delivery, in units of ask(): its planes are copied and compressed.
constexpr std::int64_t kDeliveryABin = 4;

/// Threads beside the one that has them.
class Helpers {
 public:
  ~Helpers() {
    const OutsideGate outside;
    threads_.clear();
  }
  void add(const std::function<void()>& work) {
    threads_.emplace_back([work, gate = gate_of_this_thread()] {
      const BehindGate behind(gate);
      work();
    });
  }

 private:
  std::vector<std::jthread> threads_;
};

/// One call of render_wedges.
class WedgeThreads {
 public:
  WedgeThreads(const FramePlan& plan, WedgeSums& sums, const RenderOptions& options)
      : plan_(plan), options_(options), tables_(plan.looks_at()), sums_(sums) {}

  /// Targets among the echoes of these wedges.
  void add_targets_of(int first_wedge, int end_wedge) {
    targets_.emplace(
        plan_, air_view(plan_.looks_at()), *options_.targets,
        AzimuthRange{first_wedge * kWedgeAzimuthBins, (end_wedge - first_wedge) * kWedgeAzimuthBins},
        target_look(options_));
  }

  /// False when stopped.
  bool run(int threads) {
    {
      Helpers helpers;
      for (int t = 1; t < std::min(threads, sums_.n_wedges()); ++t)
        helpers.add([this] { work_until_done(); });
      work_until_done();
    }
    if (failure_) std::rethrow_exception(failure_);
    return !stopped();
  }

 private:
  bool stopped() const { return stopped_ || options_.stop.stop_requested(); }

  void work_until_done() {
    const StageClock clock(options_.times);
    try {
      WedgeWork work(plan_, tables_, options_.surfaces, sums_.needs_iq(), plan_.label_parts(options_.labels));
      while (go_on(work)) {
      }
    } catch (const Stopped&) {
      stopped_ = true;
    } catch (...) {
      if (!failed_.exchange(true)) failure_ = std::current_exception();
    }
  }

  /// Look, echoes, beam and pulse, targets, receive: the next wedge that is to be looked at, and those for
  /// the display that are ready then. False when nothing is left, or nothing to go on for.
  bool go_on(WedgeWork& work) {
    for (Wedge ready; !stopped() && !failed_ && sums_.next(work.sums, ready);) receive(std::move(ready));
    const int k = next_++;
    if (k >= sums_.n_wedges() || stopped() || failed_) return false;
    const int index = sums_.wedge(k);
    if (sums_.take_kept(index)) return true;
    render_wedge(work, index, sums_.needed(index));
    sums_.take(std::move(work.wedge));
    return true;
  }

  void receive(Wedge&& wedge) {
    if (targets_ || options_.target_ids) {
      const StageProbe probe(Stage::bin);
      add_targets(targets_ ? &*targets_ : nullptr, wedge.bins, options_.iq, options_.target_ids);
    }
    if (options_.receiver != nullptr) {
      const StageProbe probe(Stage::bin);
      options_.receiver->receive(wedge.bins, {options_.iq, options_.video8, options_.video16});
    }
    const auto bins = static_cast<std::int64_t>(wedge.bins.state.size());
    {
      const BehindGate unheard(nullptr);  // or it would wait with the lock held
      std::unique_lock lock(delivery_, std::defer_lock);
      {
        const StageProbe probe(Stage::wait);
        lock.lock();
      }
      if (options_.on_wedge && !failed_) options_.on_wedge(std::move(wedge));
    }
    ask(kDeliveryABin * bins);
  }

  const FramePlan& plan_;
  const RenderOptions& options_;
  const FrameTables tables_;
  WedgeSums& sums_;
  std::optional<TargetEchoes> targets_;
  std::atomic<int> next_{0};
  std::atomic<bool> stopped_{false};
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::mutex delivery_;
};

}  // namespace

bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options) {
  const int first = azimuths.first / kWedgeAzimuthBins;
  const int end = std::min(wedge_count(plan.settings().azimuth_bins),
                           (azimuths.first + azimuths.count + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins);
  const auto sums = make_wedge_sums(plan, first, end, options);
  WedgeThreads threads(plan, *sums, options);
  if (options.targets != nullptr) threads.add_targets_of(first, end);
  return threads.run(thread_count(options.threads));
}

bool look_at_wedges(const FramePlan& plan, WedgeSums& sums, const RenderOptions& options) {
  return WedgeThreads(plan, sums, options).run(thread_count(options.threads));
}

int thread_count(int threads) {
  return threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace obliq
