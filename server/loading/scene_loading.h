#pragma once
// What render, frustum and mesh share: a scene file from the command line, loaded with progress on the
// terminal. The daemon logs the same report.
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "server/control/scene_config.h"
#include "server/control/sections/radar.h"
#include "server/radar/geometry/pose.h"
#include "server/scene/scene.h"
#include "terrain/base/parallel.h"

namespace obliq {

/// A line for the operator.
struct ReportLine {
  ReportLine(std::string line, bool is_warning = false) : text(std::move(line)), warns(is_warning) {}
  ReportLine(const char* line) : text(line) {}

  std::string text;
  bool warns = false;
};
using Say = std::function<void(const ReportLine&)>;

/// On stderr, warnings behind "warning: ".
void say_on_terminal(const ReportLine& line);

/// How far a long stage has come, on stderr: a line that is written over on a terminal, elsewhere a line now
/// and then, from the second second on. The time left is counted from where the fraction last fell.
Progress terminal_progress();

/// Of several radars, the one that is taken where none is named.
constexpr std::string_view kUsualRadar = "main";

/// Whether a radar, one of so many, is the one that is meant: the named one, or the only one, or kUsualRadar.
bool is_meant(const std::string& radar, const std::string& name, std::size_t radars);

/// The named radar, or the only one, or kUsualRadar. Throws InputError that lists the names.
const RadarConfig& choose_radar(const SceneConfig& config, const std::string& name);

/// Places the radar's antenna. Throws InputError with every reason why it cannot stand there.
Pose place_radar(const World& world, const RadarConfig& radar);

/// What was chosen for the user, a line each on stderr.
void say_notes(const SceneConfig& config);

/// A line on stderr where the scene has an [accuracy], or pixels that are to be found, for a program that has
/// no use for it.
void say_accuracy_is_ignored(const SceneConfig& config, const std::string& program);

/// What was loaded, a sentence or two each: grid, heights, voids, buildings with every count that is not
/// zero, notes, and warnings.
std::vector<ReportLine> world_report_lines(const World& world);

/// Prints those lines on stderr.
void print_world_report(const World& world);

/// What the scene takes in memory, and the process now and at its most.
std::string scene_memory_line(const Scene& scene);

/// Loads terrain and buildings and, when a radar's rays are traced, builds the ray-tracing scene; `say` gets
/// what was found, a sentence each.
std::shared_ptr<const Scene> build_scene(const SceneConfig& config, const Say& say, const Progress& progress);

/// Loads the same without a word, on the calling thread alone but for Embree's part, for which `threads` of
/// the configuration is taken as 1. New grids are not kept in the cache. Throws InputError soon after stop is
/// requested.
std::shared_ptr<const Scene> build_scene_behind(const SceneConfig& config, const std::stop_token& stop);

/// Loads terrain and buildings and prints what was found, one line per note, on stderr.
std::shared_ptr<const World> load_world_with_report(const SceneConfig& config);

/// When the scene has an [accuracy]: chooses each radar's pixels and, where it is "auto", the cell size, such
/// that median error and gaps, measured on a few wedges of the user's own view against the truth of the
/// finest sensible grid, stay within what is asked. `say` gets what was chosen and its measured error.
/// Without an [accuracy] it does nothing. Throws InputError, with the best that was reached, when nothing is
/// good enough.
void meet_accuracy(SceneConfig& config, const Say& say, const Progress& progress);

/// What bounds the search.
struct PixelLimits {
  std::int64_t most_pixels;  ///< of one frame (server.max_pixels)
  int threads;               ///< 0: all cores
};

/// For frustum.quality = "oblique": gives the radar about the fewest pixel columns and rows that leave no
/// more than kMostUnsampled of its lit bins without a sample, as counted in frames of the scene. `say` gets
/// what was found. Does nothing for other radars. Throws InputError, with the best that there is, where no
/// pixels do.
void find_pixels(const std::shared_ptr<const Scene>& scene, RadarConfig& radar, const PixelLimits& limits,
                 const Say& say, const Progress& progress);

}  // namespace obliq
