#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "server/accuracy/sampling_case.h"
#include "server/accuracy/truth_search.h"
#include "server/loading/scene_loading.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"
#include "terrain/grid_area.h"

namespace obliq {
namespace {

constexpr int kProbeAzimuths = 32;          ///< four wedges
constexpr double kMostProbeNodes = 0x1p25;  ///< of the truth's grid: 0.3 GB with its tree, seconds to load
constexpr ReferenceSampling kFirstTruth{32, 2.0, 0};
constexpr int kMostTruthPlanes = 512;
constexpr int kMostCoarser = 4;  ///< the cells grow at most 2^4-fold

/// One radar's part of the probe.
struct ProbedRadar {
  RadarConfig* radar;
  TruthBins truth;
  SamplingCase chosen;
  BinErrors errors;  ///< with the chosen sampling, over the chosen ground
};

class AccuracySearch {
 public:
  AccuracySearch(SceneConfig& config, const Say& say, const Progress& progress)
      : config_(config),
        limit_{config.accuracy.max_power_error_db, config.accuracy.max_gap_fraction},
        say_(say),
        progress_(progress) {}

  void run() {
    load_finest();
    for (RadarConfig& radar : config_.radars) probe(radar);
    double cell_m = ground_->world().grid.cell_m;
    source_error_ = ground_->world().report.source_error;
    if (!config_.world.terrain.cell_m) cell_m = coarsest_good_cell_m();
    config_.world.terrain.cell_m = cell_m;
    for (const ProbedRadar& p : radars_) {
      say_what_changes(p.radar->settings, p.chosen);
      p.radar->settings = with_sampling(p.radar->settings, p.chosen);
      p.radar->finds_pixels = false;
      report(p, cell_m);
    }
  }

 private:
  std::shared_ptr<const Scene> load(double cell_m) const {
    WorldSpec spec = config_.world;
    spec.terrain.cell_m = cell_m;
    const auto world = std::make_shared<const World>(load_world(spec, progress_));
    return std::make_shared<const Scene>(world, config_.materials, config_.threads, config_.rays);
  }

  /// The source's own posting; half a range bin of made-up ground, which has none. Coarser where that is more
  /// nodes than a probe is worth.
  void load_finest() {
    const SourcePosting source = source_posting(config_.world);
    double cell_m = source.posting_m > 0 ? source.posting_m : half_range_bin_m();
    const auto& given = config_.world.terrain.cell_m;
    if (given) cell_m = std::min(cell_m, *given);
    const double least_m = std::sqrt(source.area_m2 / kMostProbeNodes);
    if (cell_m < least_m) {
      say_(fmt::format(
          "accuracy: measured against ground of {} m cells, since {} m would take more than {} million posts",
          short_number(least_m), short_number(cell_m), short_number(kMostProbeNodes / 1e6)));
      cell_m = least_m;
    }
    finest_ = load(round_to_quantum_m(cell_m));
    truth_cell_m_ = finest_->world().grid.cell_m;
    // A cell size of the user's own stays, whatever the truth's.
    ground_ = given && *given != truth_cell_m_ ? load(*given) : finest_;
  }

  double half_range_bin_m() const {
    double least_m = std::numeric_limits<double>::infinity();
    for (const RadarConfig& radar : config_.radars)
      least_m = std::min(least_m, range_bins(radar.settings).spacing_m / 2);
    return std::max(1.0, least_m);
  }

  View view_of(const std::shared_ptr<const Scene>& scene, const RadarConfig& radar,
               const RadarSettings& settings) const {
    return {scene, std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}),
            place_radar(scene->world(), radar)};
  }

  BinErrors measure(const ProbedRadar& p, const SamplingCase& sampling,
                    const std::shared_ptr<const Scene>& scene) {
    const auto match = match_buildings(finest_->world().buildings, scene->world().buildings);
    return measure_errors(
               view_of(scene, *p.radar, with_sampling(sharp_settings(p.radar->settings), sampling)), p.truth,
               match, config_.threads)
        .errors[static_cast<int>(Returns::all)]
        .bins;
  }

  void probe(RadarConfig& radar) {
    ProbedRadar p{&radar, {}, {}, {}};
    const View view =
        view_of(finest_, radar, settings_for_truth(sharp_settings(radar.settings), config_.materials));
    const PlanResult planned = plan_frame(view.scene, view.settings, view.pose);
    if (!planned.plan) throw InputError("radar \"" + radar.name + "\": " + all_text(planned.errors));
    const AzimuthRuns runs = choose_azimuths(radar.settings.azimuth_bins, kProbeAzimuths);
    // What is asked stands for the smallest error shown: the truth is to be ten times better.
    const auto asked = [&](const TruthBins&) {
      SmallestErrors smallest;
      FrameMeasurement wish;
      BinErrors& e = wish.errors[static_cast<int>(Returns::all)].bins;
      e.median_db = std::isfinite(limit_.median_db) ? limit_.median_db : 0;
      e.lit = 1000000;
      e.gaps = limit_.gap_fraction < 1 ? static_cast<std::uint64_t>(limit_.gap_fraction * 1e6) : 0;
      smallest.add(wish);
      return smallest;
    };
    ReferenceSampling first = kFirstTruth;
    first.threads = config_.threads;
    const TruthQuality quality = search_truth(*planned.plan, runs, first, kMostTruthPlanes, asked, progress_);
    p.truth = integrate_truth(*planned.plan, runs, quality.sampling, progress_);
    if (!p.truth.lit())
      throw InputError("accuracy: radar \"" + radar.name + "\": nothing is lit here: nothing to compare");

    const std::vector<SamplingCase> ladder = sampling_ladder(radar.settings, ground_->world().grid.cell_m);
    int tried_so_far = 0;
    const auto tried = climb(ladder, limit_, [&](const SamplingCase& sampling) {
      if (progress_)
        progress_("trying samplings",
                  static_cast<double>(++tried_so_far) / static_cast<double>(ladder.size()));
      return measure(p, sampling, ground_);
    });
    if (progress_) progress_("trying samplings", 1);
    if (tried.empty() || !limit_.met_by(tried.back().errors)) refuse(radar, tried);
    p.chosen = tried.back().sampling;
    p.errors = tried.back().errors;
    radars_.push_back(std::move(p));
  }

  [[noreturn]] void refuse(const RadarConfig& radar, const std::vector<TriedSampling>& tried) const {
    std::string best = fmt::format("no sampling within {} pixels", kMostSide);
    if (!tried.empty()) {
      const auto& b = *std::ranges::min_element(tried, {}, [](const TriedSampling& t) {
        return std::tuple(t.errors.compared() == 0, t.errors.median_db, t.errors.gap_fraction());
      });
      const std::string error = b.errors.compared() == 0
                                    ? "not one lit bin with a return"
                                    : "a median error of " + short_number(b.errors.median_db) +
                                          " dB and gaps of " + short_number(b.errors.gap_fraction());
      best = fmt::format("at best {}, by {} over cells of {} m", error, sampling_text(b.sampling),
                         short_number(b.sampling.cell_m));
    }
    throw InputError(
        fmt::format("accuracy: radar \"{}\": found {}; allowed: {}, so ask for a larger error or take "
                    "another frustum.kind",
                    radar.name, asked_text(), best));
  }

  std::string asked_text() const {
    std::string text;
    if (std::isfinite(limit_.median_db)) text = "max_power_error_db = " + short_number(limit_.median_db);
    if (limit_.gap_fraction < 1)
      text += (text.empty() ? "" : " and ") + ("max_gap_fraction = " + short_number(limit_.gap_fraction));
    return text;
  }

  /// Doubles the cells for as long as every radar stays within the limit.
  double coarsest_good_cell_m() {
    double good_m = ground_->world().grid.cell_m;
    for (int k = 0; k < kMostCoarser; ++k) {
      std::vector<BinErrors> errors;
      SourceError source_error;
      const double cell_m = 2 * good_m;
      try {
        const auto scene = load(cell_m);
        source_error = scene->world().report.source_error;
        for (const ProbedRadar& p : radars_) {
          errors.push_back(measure(p, p.chosen, scene));
          if (!limit_.met_by(errors.back())) return good_m;
        }
      } catch (const InputError&) {
        return good_m;  // the antenna would stand in a coarser hill, or no node is left
      }
      for (std::size_t r = 0; r < radars_.size(); ++r) radars_[r].errors = errors[r];
      good_m = cell_m;
      source_error_ = source_error;
    }
    return good_m;
  }

  /// Pixels that the scene names, or its quality, do not override [accuracy]; the change is reported.
  void say_what_changes(const RadarSettings& named, const SamplingCase& chosen) const {
    const bool sweep = chosen.kind == FrustumKind::sweep;
    if (named.pixel_columns == chosen.columns && (sweep || named.pixel_rows == chosen.rows)) return;
    const auto sides = [&](int columns, int rows) {
      return std::to_string(columns) + (sweep ? "" : fmt::format(" x {}", rows));
    };
    say_(fmt::format("{}{} -> {} (chosen by [accuracy])",
                     sweep ? "frustum.pixel_columns " : "frustum.pixels ",
                     sides(named.pixel_columns, named.pixel_rows), sides(chosen.columns, chosen.rows)));
  }

  void report(const ProbedRadar& p, double cell_m) const {
    say_(fmt::format(
        "accuracy: radar \"{}\": {} over cells of {} m: median error {} dB, gaps {} of the lit bins (asked: "
        "{}), measured on {} of {} azimuth bins against the truth of {} m cells{}",
        p.radar->name, sampling_text(p.chosen), short_number(cell_m), short_number(p.errors.median_db),
        percent_text(p.errors.gap_fraction()), asked_text(), azimuth_count(p.truth.runs),
        p.radar->settings.azimuth_bins, short_number(truth_cell_m_),
        source_error_.posts > 0
            ? fmt::format("; the ground grid lies a median of {} m from its source, 95 % within {} m",
                          short_number(source_error_.median_m), short_number(source_error_.p95_m))
            : ""));
  }

  SceneConfig& config_;
  AccuracyLimit limit_;
  const Say& say_;
  const Progress& progress_;
  std::shared_ptr<const Scene> finest_;  ///< the truth's
  std::shared_ptr<const Scene> ground_;  ///< of the samplings that are tried
  double truth_cell_m_ = 0;
  SourceError source_error_;  ///< of the ground that was chosen
  std::vector<ProbedRadar> radars_;
};

}  // namespace

void meet_accuracy(SceneConfig& config, const Say& say, const Progress& progress) {
  if (config.accuracy.asks()) AccuracySearch(config, say, progress).run();
}

}  // namespace obliq
