#include "server/loading/cell_by_power.h"

#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/scene/scene.h"
#include "terrain/base/errors.h"
#include "terrain/base/memory_limit.h"
#include "terrain/base/process.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

/// A post's height, and its share of the ground's bounds (SceneMemory).
constexpr double kBytesAPost = 4.5;

/// The ground alone, of every step-th post.
World bare_ground(const World& world, int step) {
  World ground;
  ground.frame = world.frame;
  const HeightGrid& from = world.grid;
  HeightGrid& grid = ground.grid;
  grid.x0_m = from.x0_m;
  grid.z0_m = from.z0_m;
  grid.cell_m = from.cell_m * step;
  grid.nx = (from.nx - 1) / step + 1;
  grid.nz = (from.nz - 1) / step + 1;
  grid.y_m.reserve(static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.nz));
  for (int j = 0; j < grid.nz; ++j)
    for (int i = 0; i < grid.nx; ++i) grid.y_m.push_back(from.y_m[from.index(i * step, j * step)]);
  return ground;
}

/// What `draft` takes, of few bins, without beam, pulse and receiver.
SettingsPtr judging_settings(const RadarSettings& radar) {
  RadarSettings settings = sharp_settings(radar);
  settings.frustum = FrustumKind::sweep;
  settings.azimuth_bins = settings.range_bins = settings.pixel_columns = kJudgedBins;
  return std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1});
}

class PowerJudge {
 public:
  PowerJudge(const SceneConfig& config, const World& world, int threads, const Progress& progress)
      : config_(config), world_(world), threads_(threads), progress_(progress) {
    for (const RadarConfig& radar : config.radars) {
      std::vector<FieldError> errors;
      const auto pose = place_antenna(world, radar.pose, errors);
      if (pose && !std::isnan(pose->ground_y_m)) {
        radars_.push_back({radar.name, judging_settings(radar.settings), *pose});
      } else {
        left_out_ += (left_out_.empty() ? "" : ", ") + radar.name;
      }
    }
  }

  /// The cell to take, and its note.
  std::pair<double, std::string> run() {
    double cell_m = world_.grid.cell_m;
    if (radars_.empty()) return {cell_m, note("not judged by power: no radar stands over known ground")};
    const std::vector<double> first = totals(bare_ground(world_, 1));
    // Finer cells move a total by less than coarser ones did: these cost nothing.
    const Move coarser = moved(totals(bare_ground(world_, 2)), first);
    if (coarser.radar.empty()) return {cell_m, note("not judged by power: no radar sees ground")};
    if (coarser.share <= kMostPowerMove)
      return {cell_m,
              note(fmt::format("cells of {} m: {}", short_number(cell_m), text_of(coarser, "twice")))};
    std::vector<double> before = first;
    double posts = static_cast<double>(world_.grid.y_m.size());
    std::string taken;
    for (int halving = 0; halving < kMostHalvings; ++halving) {
      posts *= 4;
      if (const std::string limit = limit_met(posts); !limit.empty())
        return {cell_m, note(fmt::format("cells of {} m{}; half the size is not judged by power: {}",
                                         short_number(cell_m), taken, limit))};
      World finer;
      finer.frame = world_.frame;
      WorldSpec spec = config_.world;
      spec.terrain.cell_m = cell_m / 2;
      load_ground(finer, spec, progress_);
      const std::vector<double> after = totals(bare_ground(finer, 1));
      const Move move = moved(before, after);
      if (move.share <= kMostPowerMove)
        return {cell_m,
                note(fmt::format("cells of {} m{}: {}", short_number(cell_m), taken, text_of(move, "half")))};
      cell_m = finer.grid.cell_m;
      before = after;
      taken = " (" + text_of(move, "twice") + ")";
    }
    return {cell_m, note(fmt::format("cells of {} m{}; halved {} times, which is the most",
                                     short_number(cell_m), taken, kMostHalvings))};
  }

 private:
  struct Judged {
    std::string name;
    SettingsPtr settings;
    Pose pose;  ///< on the first ground: antennas do not rise and sink with the cells
  };
  struct Move {
    double share = 0;
    std::string radar;
  };

  /// Each radar's power, 0 where it cannot look.
  std::vector<double> totals(World ground) const {
    const auto scene = std::make_shared<const Scene>(std::make_shared<const World>(std::move(ground)),
                                                     config_.materials, threads_, config_.rays);
    std::vector<double> totals;
    for (const Judged& radar : radars_) {
      if (progress_) progress_("judging the ground's cells", 0);
      const PlanResult planned = plan_frame(scene, radar.settings, radar.pose);
      std::vector<double> wedges(static_cast<std::size_t>(wedge_count(kJudgedBins)));
      RenderOptions options;
      options.threads = threads_;
      options.iq = options.states = false;
      options.on_wedge = [&](Wedge&& wedge) {
        wedges[static_cast<std::size_t>(wedge.index)] =
            std::accumulate(wedge.bins.power_w.begin(), wedge.bins.power_w.end(), 0.0);
      };
      if (planned.plan) render_wedges(*planned.plan, {0, kJudgedBins}, options);
      totals.push_back(std::accumulate(wedges.begin(), wedges.end(), 0.0));
    }
    return totals;
  }

  /// The greatest of all radars.
  Move moved(const std::vector<double>& before, const std::vector<double>& after) const {
    Move most;
    for (std::size_t r = 0; r < radars_.size(); ++r) {
      if (!(before[r] > 0) || !(after[r] > 0)) continue;
      const double share = before[r] / after[r] - 1;
      if (most.radar.empty() || std::abs(share) > std::abs(most.share)) most = {share, radars_[r].name};
    }
    most.share = std::abs(most.share);
    return most;
  }

  static std::string text_of(const Move& move, const std::string& size) {
    return fmt::format(
        "with {} the size the power that radar \"{}\" sees is {:.2f} % off (allowed: {:.1f} %)", size,
        move.radar, 100 * move.share, 100 * kMostPowerMove);
  }

  std::string limit_met(double posts) const {
    const double most = config_.world.terrain.most_auto_posts;
    if (posts > most)
      return fmt::format(
          "it takes {:.3g} million posts, of {:.3g} million (a quarter of flight.max_megaposts)",
          1e-6 * posts, 1e-6 * most);
    const double most_mb = memory_limit_mb(config_.server.max_memory_mb);
    const double needed_mb = static_cast<double>(resident_bytes()) / 1e6 + posts * kBytesAPost / 1e6;
    if (needed_mb > most_mb)
      return fmt::format("it takes {:.0f} MB, of {:.0f} MB (server.max_memory_mb)", needed_mb, most_mb);
    return "";
  }

  std::string note(const std::string& what) const {
    std::string text = "terrain.cell_m = \"auto\", by power: " + what;
    if (!radars_.empty() && !left_out_.empty()) text += "; without known ground below: " + left_out_;
    return text + "; terrain.cell_m names another";
  }

  const SceneConfig& config_;
  const World& world_;
  int threads_;
  const Progress& progress_;
  std::vector<Judged> radars_;
  std::string left_out_;
};

}  // namespace

World load_judged_world(const SceneConfig& config, int threads, const Progress& progress) {
  World world = load_world(config.world, progress);
  // Made-up ground has the cells that the radars' sampling asks for.
  const TerrainSpec& terrain = config.world.terrain;
  if (terrain.cell_m || terrain.dem.empty() || config.radars.empty() || !(terrain.most_auto_posts > 0))
    return world;
  const auto [cell_m, note] = PowerJudge(config, world, threads, progress).run();
  if (cell_m != world.grid.cell_m) {
    WorldSpec spec = config.world;
    spec.terrain.cell_m = cell_m;
    world = load_world(spec, progress);
  }
  world.report.notes.push_back(note);
  return world;
}

}  // namespace obliq
