// The threads of a rendering: which of them renders which wedge, delivery. Wedges know nothing of each other,
// so the bits are the same for any number of threads.
#include <algorithm>
#include <atomic>
#include <bit>
#include <exception>
#include <functional>
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
#include "terrain/base/asking.h"
#include "terrain/base/hash.h"
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

/// A look stays as it is while the antenna does, as speckle of the ground does.
std::uint64_t look_key(const FramePlan& plan) {
  const PoseSettings& at = plan.pose().settings;
  std::uint64_t key = static_cast<std::uint64_t>(plan.settings().speckle_seed);
  for (const double x : {at.latitude_deg, at.longitude_deg, at.height_m, at.bearing_deg, at.tilt_deg})
    key = mix64(key) ^ std::bit_cast<std::uint64_t>(x);
  return mix64(key);
}

/// One call of render_wedges.
class WedgeThreads {
 public:
  /// Output wedges [first_wedge, end_wedge).
  WedgeThreads(const FramePlan& plan, int first_wedge, int end_wedge, const RenderOptions& options)
      : plan_(plan),
        options_(options),
        traced_(options),
        tables_(plan.traced()),
        look_key_(look_key(plan)),
        next_(first_wedge),
        end_(end_wedge) {
    if (plan.echo() == nullptr) return;
    if (options.sharp) options.sharp->fit(*plan.echo());
    rows_.emplace(*plan.echo(), first_wedge, end_wedge);
    outputs_ = {
        first_wedge * kWedgeAzimuthBins,
        std::min(end_wedge * kWedgeAzimuthBins, plan.echo()->n_azimuth) - first_wedge * kWedgeAzimuthBins};
    next_ = 0;
    end_ = rows_->n_sharp();
    if (plan.echo()->draws()) traced_.iq = false;
    look_ = wants_look(options, plan.settings());
    sharp_ = {traced_.iq, look_ && plan.echo()->speckle != SpeckleKind::independent, options.states};
  }

  /// False when stopped.
  bool run(int threads) {
    {
      Helpers helpers;
      for (int t = 1; t < threads; ++t) helpers.add([this] { work_until_done(); });
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
      WedgeWork work(plan_.traced(), tables_, traced_);
      while (render_next(work)) {
      }
    } catch (const Stopped&) {
      stopped_ = true;
    } catch (...) {
      if (!failed_.exchange(true)) failure_ = std::current_exception();
    }
  }

  /// False when nothing is left to render, or to go on for.
  bool render_next(WedgeWork& work) {
    if (rows_) sum_what_is_ready(work);
    const int place = next_++;
    if (place >= end_ || stopped() || failed_) return false;
    const int index = rows_ ? rows_->sharp_wedge(place) : place;
    if (rows_ && take_kept(index)) return true;
    if (options_.before_wedge) options_.before_wedge(index);
    render_wedge(work, index, far_m(index), wants_states(index), rows_ ? nullptr : options_.observer);
    if (rows_) {
      take_sharp(std::move(work.wedge));
      return true;
    }
    measure_coverage(plan_, work.wedge);
    deliver(std::move(work.wedge));
    return true;
  }

  /// A beam looks at ground on either side, whose states nobody asks for; in a scan the next dwell may.
  bool wants_states(int index) const {
    if (!options_.states || !rows_ || options_.sharp) return options_.states;
    const EchoPlan& echo = *plan_.echo();
    const int first = index * kWedgeAzimuthBins - echo.first_azimuth;
    return first + kWedgeAzimuthBins > 0 && first < echo.n_azimuth * echo.azimuth_parts;
  }

  /// How far a wedge must see. A beam that looks steeply down is wider on the ground, so that of the outer
  /// sharp wedges only what is near counts. A scan's next dwell looks at them again: there only those beside
  /// the whole sector see less.
  double far_m(int index) const {
    if (!rows_) return std::numeric_limits<double>::infinity();
    const EchoPlan& echo = *plan_.echo();
    return needed_range_m(echo, index, options_.sharp ? AzimuthRange{0, echo.n_azimuth} : outputs_);
  }

  /// A sharp wedge of the dwell before.
  bool take_kept(int index) {
    SharpWedgePtr kept = options_.sharp ? options_.sharp->find(index, sharp_) : nullptr;
    if (kept == nullptr) return false;
    rows_->take(index, std::move(kept));
    return true;
  }

  void take_sharp(Wedge&& wedge) {
    const StageProbe probe(Stage::bin);
    auto sharp = std::make_shared<const SharpWedge>(*plan_.echo(), std::move(wedge.bins), wedge.stats, sharp_,
                                                    look_key_);
    if (options_.sharp) options_.sharp->keep(wedge.index, sharp_, sharp);
    rows_->take(wedge.index, std::move(sharp));
  }

  /// Output wedges of which no sharp one is missing.
  void sum_what_is_ready(WedgeWork& work) {
    EchoRows::Ready ready;
    while (!stopped() && !failed_ && rows_->next_ready(ready)) {
      Wedge wedge;
      {
        const StageProbe probe(Stage::bin);
        wedge.index = ready.wedge;
        wedge.bins = BinBlock(ready.azimuths.first, ready.azimuths.count, plan_.bins().n_range);
        wedge.stats = ready.stats;
        if (!work.sums) work.sums = std::make_unique<EchoSums>(*plan_.echo());
        work.sums->sum(ready.rows, options_.draw, options_.iq, look_, wedge.bins);
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
  RenderOptions traced_;  // of the wedges that are rendered
  const FrameTables tables_;
  const std::uint64_t look_key_;
  std::optional<EchoRows> rows_;  // of a frame that is made from sharp wedges
  AzimuthRange outputs_{};        // that are made of them
  // Wedges to render: their own numbers, or places in the order of `rows_`.
  std::atomic<int> next_;
  int end_;
  std::atomic<bool> stopped_{false};
  bool look_ = false;  // video of several looks is wanted behind a beam or a pulse
  SharpPlanes sharp_;  // of the wedges that are rendered for it
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::mutex delivery_;
};

}  // namespace

bool render_wedges(const FramePlan& plan, AzimuthRange azimuths, const RenderOptions& options) {
  const int first = azimuths.first / kWedgeAzimuthBins;
  const int end = std::min(wedge_count(plan.settings().azimuth_bins),
                           (azimuths.first + azimuths.count + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins);
  return WedgeThreads(plan, first, end, options).run(thread_count(options.threads));
}

int thread_count(int threads) {
  return threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace obliq
