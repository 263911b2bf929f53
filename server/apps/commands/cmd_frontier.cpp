// `obliq frontier`: frame time against error, for every sampling, over one scene.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/commands.h"
#include "server/apps/scene_arguments.h"
#include "server/apps/version/version.h"
#include "server/frontier/frontier_run.h"
#include "server/loading/scene_loading.h"

namespace obliq {
namespace {

struct FrontierArguments {
  SceneArguments scene;
  FrontierOptions options;
  std::string out;
  std::string against = "truth";
  std::vector<std::string> kinds;
  bool quick = false;
};

/// A few samplings over the scene's own cells, compared on a few azimuths; options of their own win. The
/// truth behind a beam looks at eight azimuths for each, and as far to both sides as the beam reaches.
void make_quick(const CLI::App& command, bool is_blurred, FrontierOptions& options) {
  if (command.count("--pixels") == 0) options.range.pixels = {1024, 2048};
  options.range.sweeps = {1, 2, 4};
  if (command.count("--sub-columns") == 0) options.range.sub_columns = {64};
  options.scene_cell_only = true;
  if (command.count("--azimuths") == 0) options.azimuths = is_blurred ? 16 : 64;
  if (command.count("--truth-planes") == 0 && is_blurred) options.truth_planes = 8;
}

constexpr FrustumKind kKinds[] = {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep};

}  // namespace

void add_frontier(CLI::App& app) {
  CLI::App* command = app.add_subcommand("frontier",
                                         "Time and error of every way to sample a scene: a table and a "
                                         "picture. Resumes where it was interrupted");
  auto arguments = std::make_shared<FrontierArguments>();
  FrontierOptions& options = arguments->options;
  add_scene_arguments(*command, "SCENE", arguments->scene);
  add_radar_argument(*command, options.radar);
  command
      ->add_option("--out", arguments->out,
                   "Folder for table, report and pictures (made if missing); default: frontier_SCENE")
      ->type_name("DIR");
  command->add_flag(
      "--quick", arguments->quick,
      "Fewer samplings, the scene's cell size alone, truth on 64 azimuth bins (behind a beam or a pulse 16)");
  command
      ->add_option("--azimuths", options.azimuths,
                   "Azimuth bins to compare with the truth, in wedges spread evenly over the sector; 0: all. "
                   "Times are always of whole frames")
      ->check(whole_number_from(0, 8192));
  command
      ->add_option(
          "--against", arguments->against,
          "What frames are compared with. truth: the reference renderer. reference: the sweep with the "
          "planes of quality = \"reference\", where the truth would take hours")
      ->check(CLI::IsMember({"truth", "reference"}));
  command->add_option("--kinds", arguments->kinds, "Frusta to measure; without: all")
      ->delimiter(',')
      ->check(CLI::IsMember({"symmetric", "oblique", "sweep"}));
  command
      ->add_option("--pixels", options.range.pixels, "Sides of the symmetric and oblique frusta's pictures")
      ->delimiter(',')
      ->check(whole_number_from(1, kMostSide));
  command
      ->add_option("--sub-columns", options.range.sub_columns,
                   "Sub-columns that the sweep sees buildings by; 0: exact strands")
      ->delimiter(',')
      ->check(whole_number_from(0, 1024));
  command
      ->add_option("--cells", options.range.cells_m,
                   "Cell sizes in metres beside the scene's own; the truth takes the finest. Without: "
                   "twice and four times the scene's")
      ->delimiter(',')
      ->check(number_from(0.03125, 10000));
  command->add_option("--repeats", options.repeats, "Timed frames for each sampling")
      ->check(whole_number_from(1, 1000));
  command->add_option("--threads", options.threads, "Threads; 0: as in the scene file")
      ->check(whole_number_from(0, 1024));
  command->add_option("--truth-planes", options.truth_planes, "Planes in each azimuth bin to begin with")
      ->check(whole_number_from(1, 65536));
  command
      ->add_option("--truth-planes-limit", options.most_truth_planes,
                   "Most planes in each azimuth bin, however far the truth is from a tenth of the errors")
      ->check(whole_number_from(1, 65536));
  command->add_option("--truth-step", options.truth_step_m, "Longest step of the truth to begin with, m")
      ->check(number_from(0.001, 1000));
  command->add_option("--stop-after", options.stop_after, "Stop after that many samplings; 0: do all")
      ->check(whole_number_from(0, 100000));
  command->add_flag("--restart", options.restart, "Discard what an earlier run left in the folder");
  command->callback([arguments, command] {
    const auto config = open_scene(arguments->scene);
    if (!config) return;
    arguments->options.version = program_version();
    arguments->options.out = arguments->out.empty() ? "frontier_" + config->name : arguments->out;
    if (arguments->against == "reference") arguments->options.against = Against::reference;
    for (const FrustumKind kind : kKinds)
      if (std::ranges::find(arguments->kinds, frustum_name(kind)) != arguments->kinds.end())
        arguments->options.range.kinds.push_back(kind);
    if (arguments->quick)
      make_quick(*command, blurs(choose_radar(*config, arguments->options.radar).settings),
                 arguments->options);
    say_notes(*config);
    say_accuracy_is_ignored(*config, "frontier");
    run_frontier(*config, arguments->options);
  });
}

}  // namespace obliq
