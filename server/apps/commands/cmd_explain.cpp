// `obliq explain`: what each ingredient of a scene changes in its bins, what it costs, and whether it is
// needed.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/commands.h"
#include "server/apps/scene_arguments.h"
#include "server/control/sections/targets.h"
#include "server/explain/explanation.h"
#include "server/loading/scene_loading.h"
#include "server/output/frame_files.h"

namespace obliq {
namespace {

struct ExplainArguments {
  SceneArguments scene;
  std::string radar;
  std::string out;
  int threads = 0;
};

void run(const SceneConfig& config, const ExplainArguments& arguments) {
  if (!arguments.out.empty()) prepare_output_folder(arguments.out);
  const RadarConfig& radar =
      arguments.radar.empty() ? config.radars.front() : choose_radar(config, arguments.radar);
  if (arguments.radar.empty() && config.radars.size() > 1)
    say_on_terminal("radar \"" + radar.name + "\", the first of the scene's; --radar chooses another");
  say_notes(config);
  say_accuracy_is_ignored(config, "explain");
  const Progress progress = terminal_progress();
  const auto print_loaded = [&](const World& world) {
    if (progress) progress("loaded", 1);  // ends the line that it would write into
    print_world_report(world);
  };
  ExplainInput input{config.name,
                     radar.name,
                     config.world,
                     config.materials,
                     radar.settings,
                     radar.pose,
                     arguments.threads > 0 ? arguments.threads : config.threads,
                     config.rays};
  input.targets = targets_of(config);
  for (const TargetConfig& target : config.targets) input.target_names.push_back(target.name);
  input.on_loaded = print_loaded;
  const Explanation explanation = explain_scene(input, progress);
  std::fputs(plain_report(explanation).c_str(), stdout);
  if (arguments.out.empty()) return;
  const std::filesystem::path folder = arguments.out;
  write_text(folder / "explain.md", markdown_report(explanation));
  write_text(folder / "explain.csv", csv_report(explanation));
}

}  // namespace

void add_explain(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "explain", "What each ingredient of a scene changes in its bins, what it costs, whether it is needed");
  auto arguments = std::make_shared<ExplainArguments>();
  add_scene_arguments(*command, "SCENE", arguments->scene);
  add_radar_argument(*command, arguments->radar);
  command->add_option("--out", arguments->out, "Folder for explain.md and explain.csv (made if missing)")
      ->type_name("DIR");
  command->add_option("--threads", arguments->threads, "Threads; 0: as in the scene file")
      ->check(whole_number_from(0, 1024));
  command->callback([arguments] {
    if (const auto config = open_scene(arguments->scene)) run(*config, *arguments);
  });
}

}  // namespace obliq
