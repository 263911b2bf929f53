#include "server/apps/scene_arguments.h"

#include <CLI/CLI.hpp>
#include <iostream>

#include "server/control/print_config.h"
#include "server/control/scene_file.h"
#include "terrain/base/errors.h"

namespace obliq {

void add_scene_arguments(CLI::App& app, const std::string& name, SceneArguments& arguments) {
  app.add_option(name, arguments.file, "Scene file (TOML)");
  app.add_option(
         "--set", arguments.set,
         "KEY=VALUE, e.g. radar.r_max_m=50000, or RADAR:KEY=VALUE for one of several radars; beats file and "
         "environment (repeatable)")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  app.add_flag("--check-config", arguments.check, "Only check the scene file");
  app.add_flag("--print-config", arguments.print, "Only print the whole configuration, defaults included");
}

std::optional<SceneConfig> open_scene(const SceneArguments& arguments) {
  if (arguments.file.empty())
    throw InputError("found no scene file; allowed: a TOML file, such as deploy/scenes/demo.toml");
  SceneConfig config = load_scene_file(arguments.file, {arguments.set});
  if (arguments.print) std::cout << print_config(config);
  if (arguments.check && !arguments.print) std::cout << arguments.file << ": good\n";
  if (arguments.print || arguments.check) return std::nullopt;
  return config;
}

}  // namespace obliq
