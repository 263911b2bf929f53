#include "server/frontier/frontier_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>

#include "server/accuracy/radar_truth.h"
#include "server/accuracy/truth_bins.h"
#include "server/accuracy/truth_search.h"
#include "server/control/parameters.h"
#include "server/control/quality_presets.h"
#include "server/control/scene_file.h"
#include "server/frontier/frontier_table.h"
#include "server/loading/scene_loading.h"
#include "server/output/frame_files.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/scene/embree_tracer.h"
#include "terrain/base/errors.h"
#include "terrain/base/process.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr int kProbeAzimuths = 64;  ///< on which the truth's own error is measured

/// Ground of one cell size with the radar's antenna on it.
struct Ground {
  std::shared_ptr<const Scene> scene;
  Pose pose;

  const World& world() const { return scene->world(); }
  double cell_m() const { return world().grid.cell_m; }
};

class FrontierRun {
 public:
  FrontierRun(const SceneConfig& config, const FrontierOptions& options)
      : config_(config),
        options_(options),
        radar_(choose_radar(config, options.radar)),
        threads_(thread_count(options.threads > 0 ? options.threads : config.threads)) {}

  bool run() {
    prepare_output_folder(options_.out);
    load_first_grounds();
    find_cases();
    open_table();
    options_.against == Against::truth ? make_truth() : make_reference();
    if (!truth_.lit()) say_on_terminal("nothing is lit here: nothing to compare");
    const bool complete = measure_all();
    report();
    return complete;
  }

 private:
  std::filesystem::path file(const char* name) const { return options_.out / name; }

  Ground load_ground(std::optional<double> cell_m) const {
    SceneConfig config = config_;
    if (cell_m) config.world.terrain.cell_m = *cell_m;
    const auto world = load_world_with_report(config);
    Ground ground;
    ground.pose = place_radar(*world, radar_);
    ground.scene = std::make_shared<const Scene>(world, config.materials, threads_, config.rays);
    const auto& kinds = options_.range.kinds;
    const bool sweeps_alone = !kinds.empty() && std::ranges::all_of(kinds, [](FrustumKind kind) {
      return kind == FrustumKind::sweep;
    });
    if (!sweeps_alone && needs_tracer(*ground.scene, FrustumKind::oblique))
      ground.scene->tracer(terminal_progress());  // not while a frame is timed
    return ground;
  }

  View view_of(const Ground& ground, const RadarSettings& settings) const {
    return {ground.scene, std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}),
            ground.pose};
  }

  /// The scene's own cell size is known once its ground is loaded; the truth takes the finest of all.
  void load_first_grounds() {
    finest_ = load_ground(std::nullopt);
    scene_cell_m_ = finest_.cell_m();
    range_ = options_.range;
    std::vector<double> others = range_.cells_m;
    if (others.empty() && !options_.scene_cell_only) others = {2 * scene_cell_m_, 4 * scene_cell_m_};
    std::ranges::sort(others);
    range_.cells_m.assign(1, scene_cell_m_);
    for (const double cell_m : others)
      if (cell_m != range_.cells_m.back() && cell_m != scene_cell_m_) range_.cells_m.push_back(cell_m);
    const double finest_m = *std::ranges::min_element(range_.cells_m);
    if (finest_m < scene_cell_m_) finest_ = load_ground(finest_m);
    here_ = finest_;
  }

  void find_cases() {
    const RadarSettings& s = radar_.settings;
    if (finest_.world().buildings.list.empty()) range_.sub_columns.resize(1);
    cases_ = frontier_cases(s, range_);
    header_.view = fmt::format("{:.4g} to {:.4g} km, {:.4g} degrees, {} x {} bins", s.r_min_m / 1000,
                               s.r_max_m / 1000, s.sector_deg, s.azimuth_bins, s.range_bins);
    if (s.beam.pattern != BeamPattern::off)
      header_.view += fmt::format(", behind a beam of {} degrees", short_number(s.beam.width_deg));
    if (s.pulse.kind != PulseKind::off) header_.view += ", after a pulse";
    header_.version = options_.version;
    header_.scene = config_.name;
    header_.radar = radar_.name;

    header_.cpu = processor_name();
    header_.threads = threads_;
    header_.tracer = EmbreeTracer::version();
    header_.repeats = options_.repeats;
    header_.azimuth_bins = s.azimuth_bins;
    header_.range_bins = s.range_bins;
    runs_ = choose_azimuths(s.azimuth_bins, options_.azimuths);
    header_.azimuths_compared = azimuth_count(runs_);
    header_.buildings = static_cast<int>(finest_.world().buildings.list.size());
    header_.scene_cell_m = scene_cell_m_;
    header_.truth_cell_m = finest_.cell_m();
    header_.against = options_.against;
    if (options_.against == Against::reference) {
      header_.truth = {find_quality("reference")->columns_for(s.azimuth_bins) / s.azimuth_bins, 0, threads_};
      std::erase(cases_, exact_sweep(header_.truth.planes_per_bin));
    }

    key_ = frontier_key(config_, radar_.name, options_, header_, cases_, finest_.world());
    header_.key = fmt::format("{:016x}", key_);
  }

  void open_table() {
    const auto table = file("frontier.csv");
    if (options_.restart)
      for (const char* name : {"frontier.csv", "frontier.json", "truth.bin"})
        std::filesystem::remove(file(name));
    const auto earlier = read_frontier_header(file("frontier.json"));
    const bool has_table = std::filesystem::exists(table);
    if (!earlier && !has_table) return;
    if (!earlier || earlier->key != header_.key)
      throw InputError(options_.out.string() +
                       ": found the table of another run (other scene, settings, options, machine or "
                       "version); allowed: another folder, or --restart to discard that table");
    resumed_ = true;
    header_ = *earlier;
    if (has_table) rows_ = read_frontier_csv(table);
    drop_half_done();
    if (!rows_.empty())
      say_on_terminal(fmt::format("resuming after {} lines of {}", rows_.size(), table.string()));
  }

  /// A sampling whose lines were not all written is measured again.
  void drop_half_done() {
    if (!rows_.empty() && rows_.back().possible() && header_.buildings > 0) {
      const SamplingCase last = rows_.back().sampling;
      if (!find_row(rows_, last, Returns::buildings))
        std::erase_if(rows_, [&](const FrontierRow& row) { return row.sampling == last; });
    }
    std::string text = csv_header();
    for (const FrontierRow& row : rows_) text += csv_line(row);
    write_text(file("frontier.csv"), text);
  }

  std::shared_ptr<const FramePlan> plan_for_truth() const {
    const View view = view_of(finest_, settings_for_truth(radar_.settings, config_.materials));
    const PlanResult planned = plan_frame(view.scene, view.settings, view.pose);
    if (!planned.plan) throw InputError("radar \"" + radar_.name + "\": " + all_text(planned.errors));
    return planned.plan;
  }

  /// The header is complete with them.
  void keep_checks(std::vector<TruthCheck> checks, const AzimuthRuns& runs) {
    header_.truth_checks = std::move(checks);
    header_.truth_check_azimuths = azimuth_count(runs);
    write_frontier_header(file("frontier.json"), header_);
  }

  /// Behind a beam and a pulse one bin gathers so many planes that they need not be searched for: a finer
  /// truth tells how good they are.
  void make_radar_truth() {
    const auto plan = plan_for_truth();
    header_.truth = {options_.truth_planes, options_.truth_step_m, threads_};
    truth_ = integrate_radar_truth(*plan, runs_, header_.truth, terminal_progress());
    if (resumed_) return;
    const ReferenceSampling finer{2 * options_.truth_planes, options_.truth_step_m / 2, threads_};
    const TruthBins check = integrate_radar_truth(*plan, runs_, finer, terminal_progress());
    keep_checks(check_truth(truth_, check, range_bins(radar_.settings), {}), runs_);
    print_truth();
  }

  void make_truth() {
    if (blurs(radar_.settings)) return make_radar_truth();
    const auto plan = plan_for_truth();
    const ReferenceSampling start{options_.truth_planes, options_.truth_step_m, threads_};
    if (!resumed_) {
      const AzimuthRuns probe = choose_azimuths(radar_.settings.azimuth_bins, kProbeAzimuths);
      const TruthQuality quality = search_truth(
          *plan, probe, start, options_.most_truth_planes,
          [&](const TruthBins& truth) { return pilot(truth); }, terminal_progress());
      header_.truth = quality.sampling;
      keep_checks(quality.checks, probe);
    }
    header_.truth.threads = threads_;
    print_truth();
    truth_ =
        integrate_truth_in_file(file("truth.bin"), key_, *plan, runs_, header_.truth, terminal_progress());
  }

  /// The sweep with so many planes in each azimuth bin and exact strands, over the truth's ground.
  SamplingCase exact_sweep(int planes_per_bin) const {
    return {
        FrustumKind::sweep, PlateKind::spread, planes_per_bin * header_.azimuth_bins, 0, finest_.cell_m(), 0};
  }

  TruthBins render_exact(int planes_per_bin, const AzimuthRuns& runs) const {
    const RadarSettings settings = with_sampling(radar_.settings, exact_sweep(planes_per_bin));
    const std::vector<FieldError> errors = validate(settings);
    if (!errors.empty()) throw InputError("frontier: --against reference: " + all_text(errors));
    return render_truth(view_of(finest_, settings), runs, threads_);
  }

  /// Rendered anew in each run: that takes seconds.
  void make_reference() {
    const int planes = header_.truth.planes_per_bin;
    say_on_terminal(
        fmt::format("reference: the sweep with {} planes in each azimuth bin and exact strands", planes));
    truth_ = render_exact(planes, runs_);
    if (resumed_) return;
    if (exact_sweep(2 * planes).columns > kMostSide) return keep_checks({}, {});
    const AzimuthRuns probe = choose_azimuths(header_.azimuth_bins, kProbeAzimuths);
    keep_checks(check_truth(render_exact(planes, probe), render_exact(2 * planes, probe),
                            range_bins(radar_.settings), {}),
                probe);
  }

  /// The errors that the finest samplings will show.
  SmallestErrors pilot(const TruthBins& truth) const {
    SmallestErrors smallest;
    const Progress progress = terminal_progress();
    say_on_terminal("rendering the finest samplings once, for the errors that the truth is held to");
    std::size_t looked_at = 0;
    const auto match = match_buildings(finest_.world().buildings, finest_.world().buildings);
    for (const SamplingCase& c : cases_) {
      if (progress)
        progress("first frames", static_cast<double>(looked_at++) / static_cast<double>(cases_.size()));
      if (c.cell_m != finest_.cell_m()) continue;
      const bool outdone = std::ranges::any_of(cases_, [&](const SamplingCase& other) {
        return other.kind == c.kind && other.plates == c.plates && other.cell_m == c.cell_m &&
               other.columns >= c.columns && other.rows >= c.rows && other != c;
      });
      if (outdone || (c.kind != FrustumKind::sweep && c.plates == PlateKind::nearest)) continue;
      try {
        smallest.add(
            measure_errors(view_of(finest_, with_sampling(radar_.settings, c)), truth, match, threads_));
      } catch (const InputError&) {
        // Cannot see this scene: the table will say so.
      }
    }
    if (progress) progress("first frames", 1);
    return smallest;
  }

  void print_truth() const {
    say_on_terminal(
        fmt::format("truth: {} planes in each azimuth bin, steps of {} m, grid of {} m; its own error, to be "
                    "a tenth of the smallest shown:",
                    header_.truth.planes_per_bin, short_number(header_.truth.step_m),
                    short_number(header_.truth_cell_m)));
    for (const TruthCheck& check : header_.truth_checks)
      say_on_terminal(fmt::format("  {}: {}, smallest shown {}{}", check.measure, short_number(check.own),
                                  short_number(check.smallest), check.holds() ? "" : "  NOT HELD"));
  }

  bool measure_all() {
    std::ofstream table(file("frontier.csv"), std::ios::app);
    if (rows_.empty() && std::filesystem::file_size(file("frontier.csv")) == 0) table << csv_header();
    table.flush();
    double work = 0;
    for (const SamplingCase& c : cases_) work += is_done(c) ? 0 : weight(c);
    double done = 0;
    int measured = 0;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < cases_.size(); ++k) {
      if (is_done(cases_[k])) continue;
      if (options_.stop_after > 0 && measured == options_.stop_after) {
        say_on_terminal(fmt::format("stopped after {}; the same command resumes from here", measured));
        return false;
      }
      const std::vector<FrontierRow> rows = measure(cases_[k]);
      for (const FrontierRow& row : rows) table << csv_line(row);
      table.flush();
      if (!table) throw InputError(file("frontier.csv").string() + ": cannot be written (disk full?)");
      rows_.insert(rows_.end(), rows.begin(), rows.end());
      ++measured;
      done += weight(cases_[k]);
      const double spent_s = seconds_since(start);
      say_on_terminal(
          fmt::format("[{}/{}] {}{}", k + 1, cases_.size(), row_text(rows.front()),
                      done < work ? "; " + duration_text(spent_s / done * (work - done)) + " left" : ""));
    }
    return true;
  }

  bool is_done(const SamplingCase& c) const { return find_row(rows_, c, Returns::all) != nullptr; }

  /// Work of a sampling, in pixels; a sweep's azimuth counts like a column of as many rows as range bins.
  double weight(const SamplingCase& c) const {
    const double rows = c.kind == FrustumKind::sweep ? header_.range_bins / 4.0 : c.rows;
    return 5e5 + c.columns * rows;
  }

  static std::string row_text(const FrontierRow& row) {
    const std::string text =
        sampling_text(row.sampling) + ", cell " + short_number(row.sampling.cell_m) + " m: ";
    if (!row.possible()) return text + "not possible here: " + row.not_possible;
    return fmt::format(
        "{}{} ms, E {}, energy {:+.2g}, gaps {}, false light {}, {:.0f} of {:.0f} buildings missed", text,
        short_number(row.frame_ms), short_number(row.power_error), row.energy_error,
        percent_text(row.gap_fraction), percent_text(row.false_light_fraction), row.buildings_missed,
        row.buildings_visible);
  }

  std::vector<FrontierRow> measure(const SamplingCase& c) {
    if (c.cell_m != here_.cell_m()) {
      here_ = {};  // one ground at a time beside the truth's
      here_ = c.cell_m == finest_.cell_m() ? finest_ : load_ground(c.cell_m);
      match_.clear();
    }
    if (match_.empty()) match_ = match_buildings(finest_.world().buildings, here_.world().buildings);
    const RadarSettings settings = with_sampling(radar_.settings, c);
    const double load = load_average();
    try {
      const std::vector<FieldError> errors = validate(settings);
      if (!errors.empty()) throw InputError(all_text(errors));
      return rows_of(c, measure_frame(view_of(here_, settings), truth_, match_, {threads_, options_.repeats}),
                     load);
    } catch (const InputError& e) {
      return {impossible_row(c, e.what())};
    }
  }

  void report() {
    const std::vector<FrontierRow> rows = read_frontier_csv(file("frontier.csv"));
    write_text(file("frontier.md"), frontier_markdown(header_, rows));
    draw_frontier(options_.out, header_, rows);
    const auto done = std::ranges::count_if(cases_, [&](const SamplingCase& c) { return is_done(c); });
    std::printf("%s: frontier.csv, frontier.md, frontier.svg, frontier.png (%td of %zu samplings)\n",
                options_.out.c_str(), done, cases_.size());
  }

  const SceneConfig& config_;
  const FrontierOptions& options_;
  const RadarConfig& radar_;
  int threads_;
  Ground finest_;  ///< the truth's
  Ground here_;    ///< of the sampling at work
  double scene_cell_m_ = 0;
  FrontierRange range_;
  std::vector<SamplingCase> cases_;
  FrontierHeader header_;
  std::uint64_t key_ = 0;
  AzimuthRuns runs_;
  bool resumed_ = false;
  std::vector<FrontierRow> rows_;
  TruthBins truth_;
  std::vector<std::uint32_t> match_;  ///< from the truth's buildings to those here
};

}  // namespace

bool run_frontier(const SceneConfig& config, const FrontierOptions& options) {
  return FrontierRun(config, options).run();
}

}  // namespace obliq
