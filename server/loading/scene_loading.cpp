#include "server/loading/scene_loading.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "server/loading/cell_by_power.h"
#include "server/radar/frame_plan.h"
#include "server/scene/scene_memory.h"
#include "terrain/base/errors.h"
#include "terrain/base/process.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

using Clock = std::chrono::steady_clock;

// What takes no longer needs no line in a log, nor a guess when it will end.
constexpr double kQuick_s = 1.5;
constexpr double kPause_s = 5;        // between two lines of one stage
constexpr double kLeastShare = 0.02;  // from which the time left is guessed

class ProgressLines {
 public:
  explicit ProgressLines(bool terminal) : terminal_(terminal) {}

  void tell(std::string_view stage, double fraction) {
    const auto now = Clock::now();
    if (fraction < fraction_) {
      start_ = now;
      start_fraction_ = fraction;
    }
    fraction_ = fraction;
    if (terminal_) return write_over(stage, now);
    const bool is_new = stage != stage_;
    stage_ = stage;
    if (to_seconds(now - start_) < kQuick_s || fraction >= 1) return;
    if (!is_new && to_seconds(now - written_) < kPause_s) return;
    written_ = now;
    std::fprintf(stderr, "%s\n", text(stage, now).c_str());
  }

 private:
  std::string text(std::string_view stage, Clock::time_point now) const {
    const std::string line = fmt::format("{} {:3.0f} %", stage, 100 * fraction_);
    const double spent_s = to_seconds(now - start_);
    const double done = fraction_ - start_fraction_;
    if (spent_s < kQuick_s || done < kLeastShare) return line;
    return line + fmt::format(", {:.0f} s left", spent_s / done * (1 - fraction_));
  }

  void write_over(std::string_view stage, Clock::time_point now) const {
    std::fprintf(stderr, "\r\033[K%s", fraction_ >= 1 ? "" : text(stage, now).c_str());
  }

  const bool terminal_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point written_;
  double start_fraction_ = 0;
  double fraction_ = 0;
  std::string stage_;
};

std::string source_error_line(const SourceError& error) {
  return fmt::format(
      "grid against its source, vertically, at {} posts: median {:.3g} m, 95 % within {:.3g} m, rms {:.3g} "
      "m, greatest {:.3g} m",
      error.posts, error.median_m, error.p95_m, error.rms_m, error.greatest_m);
}

/// Where the heights come from, in what unit, and how far they reach.
std::string elevation_line(const LoadReport& report) {
  std::string line =
      fmt::format("elevation: {:.5g} to {:.5g} m above the datum", report.lowest_m, report.highest_m);
  constexpr std::size_t kMost = 4;
  for (std::size_t n = 0; n < std::min(kMost, report.elevation.size()); ++n) {
    const ElevationSource& source = report.elevation[n];
    line += fmt::format("{}{} in {}{}", n == 0 ? ", from " : ", ", source.file, source.unit,
                        source.unit_assumed ? " (assumed, the file names no unit; terrain.unit does)" : "");
  }
  if (report.elevation.size() > kMost) line += fmt::format(" and {} more", report.elevation.size() - kMost);
  return line;
}

std::string heights_line(const BuildingHeights& heights) {
  std::string line = "buildings of " + heights.file + ":";
  if (heights.found > 0)
    line += fmt::format(" heights {:.3g} to {:.4g} m, median {:.3g} m, from {} in {}", heights.least_m,
                        heights.most_m, heights.median_m, heights.field, heights.unit);
  if (heights.by_default > 0)
    line += fmt::format("{} {} with the default height of {:g} m", heights.found > 0 ? "," : "",
                        heights.by_default, heights.default_m);
  return line;
}

}  // namespace

bool is_meant(const std::string& radar, const std::string& name, std::size_t radars) {
  return radar == name || (name.empty() && (radars == 1 || radar == kUsualRadar));
}

const RadarConfig& choose_radar(const SceneConfig& config, const std::string& name) {
  std::string names;
  for (const RadarConfig& radar : config.radars) {
    if (is_meant(radar.name, name, config.radars.size())) return radar;
    names += (names.empty() ? "" : ", ") + radar.name;
  }
  throw InputError("--radar: found " + (name.empty() ? "nothing" : "\"" + name + "\"") +
                   "; allowed: " + names);
}

Pose place_radar(const World& world, const RadarConfig& radar) {
  std::vector<FieldError> errors;
  const auto pose = place_antenna(world, radar.pose, errors);
  if (pose) return *pose;
  throw InputError("radar \"" + radar.name + "\": " + all_text(errors));
}

void say_notes(const SceneConfig& config) {
  for (const std::string& note : config.notes) say_on_terminal(note);
}

void say_accuracy_is_ignored(const SceneConfig& config, const std::string& program) {
  if (config.accuracy.asks())
    say_on_terminal(program + ": [accuracy] is ignored here; pixels and cells are those of the scene file");
  for (const RadarConfig& radar : config.radars)
    if (radar.finds_pixels)
      say_on_terminal(
          fmt::format("{}: radar \"{}\": the pixels of frustum.quality = \"oblique\" are found by render and "
                      "obliqd; here it has {} x {}",
                      program, radar.name, radar.settings.pixel_columns, radar.settings.pixel_rows));
}

std::vector<ReportLine> world_report_lines(const World& world) {
  const HeightGrid& grid = world.grid;
  const LoadReport& report = world.report;
  std::vector<ReportLine> lines;
  std::string line =
      fmt::format("terrain: {} x {} posts of {:.5g} m ({:.1f} x {:.1f} km)", grid.nx, grid.nz, grid.cell_m,
                  (grid.nx - 1) * grid.cell_m / 1000, (grid.nz - 1) * grid.cell_m / 1000);
  const auto count = [&](std::uint64_t n, const char* what) {
    if (n > 0) line += fmt::format(", {} {}", n, what);
  };
  count(report.posts_filled, "void posts filled by interpolation");
  count(report.posts_absent, "without known ground");
  lines.push_back(line);
  if (!report.elevation.empty()) lines.push_back(elevation_line(report));
  if (report.water_m2 > 0)
    lines.push_back(
        fmt::format("water: {:.3g} km2 found in the elevation models (terrain.sea)", report.water_m2 / 1e6));
  if (report.source_error.posts > 0) lines.push_back(source_error_line(report.source_error));
  if (report.buildings_read > 0 || report.prisms_placed > 0) {
    line = fmt::format("buildings: {} in the scene", world.buildings.list.size());
    count(report.buildings_read, "outlines read");
    count(report.buildings_repaired, "repaired");
    count(report.buildings_zero_area, "skipped without area");
    count(report.buildings_duplicate, "skipped as duplicates");
    count(report.buildings_outside, "skipped outside the loaded area");
    count(report.buildings_around, "skipped as larger than the loaded area");
    count(report.buildings_too_complex, "skipped as too complex");
    count(report.buildings_too_wide, "skipped as wider than 8 km");
    count(report.buildings_no_ground, "skipped over unknown ground");
    count(report.buildings_unusable, "skipped as no usable polygon");
    count(report.buildings_slivers, "narrower than 10 cm");
    count(report.buildings_copies, "within half a metre of another of the same size");
    count(report.buildings_default_height, "with the default height");
    count(report.prisms_placed, "random prisms");
    lines.push_back(line);
  }
  for (const BuildingHeights& heights : report.building_heights) {
    if (heights.found > 0 || heights.by_default > 0) lines.push_back(heights_line(heights));
  }
  if (!gives_large_pages())
    lines.emplace_back(
        "memory: the kernel gives no pages of 2 MB (transparent_hugepage is neither always nor madvise); "
        "frames of large scenes take longer");
  lines.insert(lines.end(), report.notes.begin(), report.notes.end());
  for (const std::string& warning : report.warnings) lines.emplace_back(warning, true);
  return lines;
}

void print_world_report(const World& world) {
  for (const ReportLine& line : world_report_lines(world)) say_on_terminal(line);
}

std::string scene_memory_line(const Scene& scene) {
  const std::string text =
      fmt::format("; process {:.0f} MB, peak {:.0f} MB", static_cast<double>(resident_bytes()) / 1e6,
                  static_cast<double>(peak_resident_bytes()) / 1e6);
  return memory_line(scene) + text;
}

std::shared_ptr<const Scene> build_scene(const SceneConfig& config, const Say& say,
                                         const Progress& progress) {
  say("scene " + config.name + ": loading terrain");
  auto world = std::make_shared<const World>(load_judged_world(config, config.threads, progress));
  for (const ReportLine& line : world_report_lines(*world)) say(line);
  auto scene = std::make_shared<const Scene>(world, config.materials, config.threads, config.rays);
  if (std::ranges::any_of(config.radars, [&](const RadarConfig& radar) {
        return needs_tracer(*scene, radar.settings.frustum);
      })) {
    scene->tracer(progress);
    say(tracer_line(*scene));
  }
  say(scene_memory_line(*scene));
  return scene;
}

std::shared_ptr<const Scene> build_scene_behind(const SceneConfig& config, const std::stop_token& stop) {
  SceneConfig behind = config;
  behind.world.terrain.cache_keeps = false;  // windows of a flight do not come again
  auto world = std::make_shared<const World>(load_judged_world(behind, 1, [&](std::string_view, double) {
    if (stop.stop_requested()) throw InputError("given up");
  }));
  return std::make_shared<const Scene>(world, config.materials, 1, config.rays);
}

std::shared_ptr<const World> load_world_with_report(const SceneConfig& config) {
  auto world = std::make_shared<const World>(load_judged_world(config, config.threads, terminal_progress()));
  print_world_report(*world);
  return world;
}

void say_on_terminal(const ReportLine& line) {
  std::fprintf(stderr, "%s%s\n", line.warns ? "warning: " : "", line.text.c_str());
}

Progress terminal_progress() {
  const auto lines = std::make_shared<ProgressLines>(isatty(STDERR_FILENO) != 0);
  return [lines](std::string_view stage, double fraction) { lines->tell(stage, fraction); };
}

}  // namespace obliq
