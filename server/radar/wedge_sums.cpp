#include "server/radar/wedge_sums.h"

#include <algorithm>
#include <bit>
#include <deque>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "server/radar/beam/seen_rows.h"
#include "server/radar/wedge_work.h"
#include "terrain/base/hash.h"
#include "terrain/base/stage_clock.h"

namespace obliq {
namespace {

/// A look stays as it is while the antenna does, as speckle of the ground does.
std::uint64_t look_key(const FramePlan& plan) {
  const PoseSettings& at = plan.pose().settings;
  std::uint64_t key = static_cast<std::uint64_t>(plan.settings().speckle_seed);
  for (const double x : {at.latitude_deg, at.longitude_deg, at.height_m, at.bearing_deg, at.tilt_deg})
    key = mix64(key) ^ std::bit_cast<std::uint64_t>(x);
  return mix64(key);
}

/// Without beam and pulse: the wedges themselves.
class SharpSums : public WedgeSums {
 public:
  SharpSums(const FramePlan& plan, int first, int end, const RenderOptions& options)
      : plan_(plan), options_(options), first_(first), n_(end - first) {}

  int n_wedges() const override { return n_; }
  int wedge(int k) const override { return first_ + k; }
  bool needs_iq() const override { return options_.iq; }
  Needed needed(int) const override {
    return {.states = options_.states, .returns = options_.labels, .observer = options_.observer};
  }
  bool take_kept(int) override { return false; }
  void take(Wedge&& wedge) override {
    measure_coverage(plan_, wedge);
    if (options_.labels) decide_labels(wedge.bins);
    const std::lock_guard lock(mutex_);
    ready_.push_back(std::move(wedge));
  }
  bool next(std::unique_ptr<EchoSums>&, Wedge& wedge) override {
    const std::lock_guard lock(mutex_);
    if (ready_.empty()) return false;
    wedge = std::move(ready_.front());
    ready_.pop_front();
    return true;
  }

 private:
  const FramePlan& plan_;
  const RenderOptions& options_;
  const int first_;
  const int n_;
  std::mutex mutex_;
  std::deque<Wedge> ready_;
};

/// Behind a beam or a pulse: of rows of sharp bins.
class RowSums : public WedgeSums {
 public:
  /// window, wedges: what is made of rows; outputs: the azimuths that it is.
  RowSums(const FramePlan& plan, const RenderOptions& options, const RowWindow& window,
          std::vector<int> wedges, AzimuthRange outputs, const SharpPlanes& planes)
      : plan_(plan),
        sum_(*plan.sum()),
        options_(options),
        planes_(planes),
        look_key_(look_key(plan)),
        rows_(sum_, window, std::move(wedges), planes, look_key_),
        outputs_(outputs) {
    if (options.sharp == nullptr) return;
    options.sharp->fit(sum_);
    outputs_ = {0, sum_.n_azimuth};  // now or in the next dwell
  }

  int n_wedges() const override { return rows_.looks_at().n_sharp(); }
  int wedge(int k) const override { return rows_.looks_at().sharp_wedge(k); }
  bool needs_iq() const override { return planes_.iq; }

  /// A beam that looks steeply down is wider on the ground, so that of the outer sharp wedges only what is
  /// near counts, and nobody asks for their states. A scan's next dwell looks at them again: there only those
  /// beside the whole sector see less.
  Needed needed(int wedge) const override {
    const int first = wedge * kWedgeAzimuthBins - sum_.first_azimuth;
    const bool own =
        sum_.ground || (first + kWedgeAzimuthBins > 0 && first < sum_.n_azimuth * sum_.azimuth_parts);
    return {.far_m = needed_range_m(sum_, wedge, outputs_),
            .states = options_.states && (own || options_.sharp != nullptr),
            .returns = options_.labels && (own || options_.sharp != nullptr)};
  }

  /// Of the dwell before.
  bool take_kept(int wedge) override {
    SharpWedgePtr kept = options_.sharp ? options_.sharp->find(wedge, planes_) : nullptr;
    if (kept == nullptr) return false;
    rows_.take(wedge, std::move(kept));
    return true;
  }

  void take(Wedge&& wedge) override {
    const StageProbe probe(Stage::bin);
    auto sharp =
        std::make_shared<const SharpWedge>(sum_, std::move(wedge.bins), wedge.stats, planes_, look_key_);
    if (options_.sharp) options_.sharp->keep(wedge.index, planes_, sharp);
    rows_.take(wedge.index, std::move(sharp));
  }

 protected:
  const FramePlan& plan_;
  const EchoPlan& sum_;
  const RenderOptions& options_;
  const SharpPlanes planes_;  // that the sums need
  const std::uint64_t look_key_;
  SeenRows rows_;

 private:
  AzimuthRange outputs_;  // that are made of the sharp wedges
};

/// The bins of a display.
class BeamSums : public RowSums {
 public:
  BeamSums(const FramePlan& plan, int first, int end, const RenderOptions& options)
      : RowSums(plan, options, *plan.sum(), wedges_between(first, end), azimuths_of(plan, first, end),
                planes_of(plan, options)),
        look_(wants_look(options, plan.settings())) {}

  bool next(std::unique_ptr<EchoSums>& buffers, Wedge& wedge) override {
    EchoRows::Ready ready;
    if (!rows_.next_ready(ready)) return false;
    {
      const StageProbe probe(Stage::bin);
      wedge.index = ready.wedge;
      wedge.bins = BinBlock(ready.azimuths.first, ready.azimuths.count, plan_.bins().n_range);
      wedge.stats = ready.stats;
      if (!buffers) buffers = std::make_unique<EchoSums>(sum_);
      buffers->sum(ready.rows, options_.draw, options_.iq, look_, wedge.bins);
      if (options_.labels) buffers->sum_labels(ready.rows, wedge.bins);
      if (!options_.labels) wedge.bins.labels.returns.clear();
      if (options_.states) count_states(wedge);
      wedge.stats.sector_area_m2 = wedge.stats.covered_area_m2 = 0;
    }
    measure_coverage(plan_, wedge);
    return true;
  }

 private:
  static std::vector<int> wedges_between(int first, int end) {
    std::vector<int> wedges(static_cast<std::size_t>(end - first));
    std::iota(wedges.begin(), wedges.end(), first);
    return wedges;
  }
  static AzimuthRange azimuths_of(const FramePlan& plan, int first, int end) {
    const int azimuth = first * kWedgeAzimuthBins;
    return {azimuth, std::min(end * kWedgeAzimuthBins, plan.sum()->n_azimuth) - azimuth};
  }
  static SharpPlanes planes_of(const FramePlan& plan, const RenderOptions& options) {
    const EchoPlan& sum = *plan.sum();
    return {options.iq && !sum.draws(),
            wants_look(options, plan.settings()) && sum.speckle != SpeckleKind::independent, options.states,
            plan.label_parts(options.labels)};
  }

  const bool look_;  // video of several looks is wanted
};

/// Rows alone.
class PlainRows : public RowSums {
 public:
  PlainRows(const FramePlan& plan, const RowWindow& window, AzimuthRange azimuths,
            const RenderOptions& options)
      : RowSums(plan, options, window, {0}, azimuths,
                {.iq = !plan.sum()->draws(), .labels = plan.label_parts(false)}) {}

  bool next(std::unique_ptr<EchoSums>&, Wedge&) override { return false; }
  EchoRows::Ready ready() {
    EchoRows::Ready ready;
    rows_.next_ready(ready);
    return ready;
  }
};

}  // namespace

std::unique_ptr<WedgeSums> make_wedge_sums(const FramePlan& plan, int first, int end,
                                           const RenderOptions& options) {
  if (plan.sum() == nullptr) return std::make_unique<SharpSums>(plan, first, end, options);
  return std::make_unique<BeamSums>(plan, first, end, options);
}

std::optional<EchoRows::Ready> look_at_rows(const FramePlan& plan, const RowWindow& window,
                                            AzimuthRange azimuths, const RenderOptions& options) {
  RenderOptions quiet = options;
  quiet.states = quiet.labels = quiet.video8 = quiet.video16 = false;
  quiet.observer = nullptr;
  PlainRows rows(plan, window, azimuths, quiet);
  if (!look_at_wedges(plan, rows, quiet)) return std::nullopt;
  return rows.ready();
}

}  // namespace obliq
