// The threads of a rendering: which of them renders which wedge, pauses, delivery. Wedges know nothing of
// each other, so the bits are the same for any number of threads and any pauses.
#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "server/radar/beam/echo_rows.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/visibility/coverage.h"
#include "server/radar/wedge_work.h"
#include "terrain/base/stage_clock.h"

namespace obliq {

class BegunWedges {
 public:
  /// Output wedges [first_wedge, end_wedge).
  BegunWedges(const FramePlan& plan, int first_wedge, int end_wedge, int threads)
      : tables(plan.traced()), next(first_wedge), end(end_wedge), work(static_cast<std::size_t>(threads)) {
    if (plan.echo() == nullptr) return;
    rows.emplace(*plan.echo(), first_wedge, end_wedge);
    outputs = {
        first_wedge * kWedgeAzimuthBins,
        std::min(end_wedge * kWedgeAzimuthBins, plan.echo()->n_azimuth) - first_wedge * kWedgeAzimuthBins};
    next = 0;
    end = rows->n_sharp();
  }

  const FrameTables tables;
  std::optional<EchoRows> rows;  // of a frame that is made from sharp wedges
  AzimuthRange outputs{};        // that are made of them
  // Wedges to render: their own numbers, or places in the order of `rows`.
  std::atomic<int> next;
  int end;
  std::vector<std::unique_ptr<WedgeWork>> work;  // each thread's
};

namespace {

/// One call of render_wedges.
class WedgeThreads {
 public:
  WedgeThreads(const FramePlan& plan, const RenderOptions& options, BegunWedges& begun)
      : plan_(plan), options_(options), traced_(options), begun_(begun) {
    if (begun.rows && plan.echo()->draws()) traced_.iq = false;
  }

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
      if (!work) work = std::make_unique<WedgeWork>(plan_.traced(), begun_.tables, traced_);
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
      if (begun_.rows) sum_what_is_ready(work);
      if (!work.begun()) {
        const int place = begun_.next++;
        if (place >= begun_.end) return;
        const int index = begun_.rows ? begun_.rows->sharp_wedge(place) : place;
        if (begun_.rows && take_kept(index)) continue;
        if (options_.before_wedge) options_.before_wedge(index);
        begin_wedge(work, index, far_m(index), begun_.rows ? nullptr : options_.observer);
      }
      if (!render_wedge(work, wants_states(work.wedge.index), may_go_on)) {
        if (!stopped()) paused_ = true;
        return;
      }
      if (begun_.rows) {
        take_sharp(std::move(work.wedge));
        sum_what_is_ready(work);
      } else {
        measure_coverage(plan_, work.wedge);
        deliver(std::move(work.wedge));
      }
    }
  }

  /// A beam looks at ground on either side, whose states nobody asks for; in a scan the next dwell may.
  bool wants_states(int index) const {
    if (!options_.states || !begun_.rows || options_.sharp) return options_.states;
    const EchoPlan& echo = *plan_.echo();
    const int first = index * kWedgeAzimuthBins - echo.first_azimuth;
    return first + kWedgeAzimuthBins > 0 && first < echo.n_azimuth * echo.azimuth_parts;
  }

  /// How far a wedge must see. A beam that looks steeply down is wider on the ground, so that of the outer
  /// sharp wedges only what is near counts. A scan's next dwell looks at them again: there only those beside
  /// the whole sector see less.
  double far_m(int index) const {
    if (!begun_.rows) return std::numeric_limits<double>::infinity();
    const EchoPlan& echo = *plan_.echo();
    return needed_range_m(echo, index, options_.sharp ? AzimuthRange{0, echo.n_azimuth} : begun_.outputs);
  }

  /// A sharp wedge of the dwell before.
  bool take_kept(int index) {
    SharpWedgePtr kept = options_.sharp ? options_.sharp->find(index, traced_.iq, options_.states) : nullptr;
    if (kept == nullptr) return false;
    begun_.rows->take(index, std::move(kept));
    return true;
  }

  void take_sharp(Wedge&& wedge) {
    const StageProbe probe(Stage::bin);
    auto sharp =
        std::make_shared<const SharpWedge>(*plan_.echo(), std::move(wedge.bins), wedge.stats, traced_.iq);
    if (options_.sharp) options_.sharp->keep(wedge.index, options_.states, sharp);
    begun_.rows->take(wedge.index, std::move(sharp));
  }

  /// Output wedges of which no sharp one is missing.
  void sum_what_is_ready(WedgeWork& work) {
    EchoRows::Ready ready;
    while (!stopped() && begun_.rows->next_ready(ready)) {
      Wedge wedge;
      {
        const StageProbe probe(Stage::bin);
        wedge.index = ready.wedge;
        wedge.bins = BinBlock(ready.azimuths.first, ready.azimuths.count, plan_.bins().n_range);
        wedge.stats = ready.stats;
        if (!work.sums) work.sums = std::make_unique<EchoSums>(*plan_.echo());
        work.sums->sum(ready.rows, options_.draw, options_.iq, wedge.bins);
        describe(wedge);
      }
      deliver(std::move(wedge));
    }
  }

  /// States and area of an output wedge, which its sharp ones know of themselves alone.
  void describe(Wedge& wedge) const {
    if (options_.states) count_states(wedge);
    wedge.stats.sector_area_m2 = wedge.stats.covered_area_m2 = 0;
    measure_coverage(plan_, wedge);
  }

  void deliver(Wedge&& wedge) {
    if (options_.receiver != nullptr) {
      const StageProbe probe(Stage::bin);
      options_.receiver->receive(wedge.bins, {options_.iq, options_.video8, options_.video16});
    }
    std::unique_lock lock(delivery_, std::defer_lock);
    {
      const StageProbe probe(Stage::wait);
      lock.lock();
    }
    if (options_.on_wedge && !failed_) options_.on_wedge(std::move(wedge));
  }

  const FramePlan& plan_;
  const RenderOptions& options_;
  RenderOptions traced_;  // of the wedges that are rendered
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
  if (!begun) begun = std::make_shared<BegunWedges>(plan, first, end, threads);
  const bool paused = WedgeThreads(plan, options, *begun).run();
  if (paused) options.pause->begun = std::move(begun);
  return !options.stop.stop_requested();
}

}  // namespace obliq
