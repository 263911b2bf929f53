#pragma once
// The arguments that every program with a scene file shares.
#include <optional>
#include <string>
#include <vector>

#include "server/control/scene_config.h"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace obliq {

/// Adds an option that may be given several times, with one value each.
void add_repeatable(CLI::App& app, const std::string& name, std::vector<std::string>& to,
                    const std::string& text, const std::string& type = "KEY=VALUE");

/// Adds --radar.
void add_radar_argument(CLI::App& app, std::string& radar);

struct SceneArguments {
  std::string file;
  std::vector<std::string> set;  ///< KEY=VALUE
  bool check = false;
  bool print = false;
};

/// Adds the scene file (`name`: "SCENE" for a positional one, "SCENE,--config" for one that is an option,
/// too),
/// --set,
/// --check-config and --print-config. `arguments` must outlive the parsing.
void add_scene_arguments(CLI::App& app, const std::string& name, SceneArguments& arguments);

/// Loads the scene file. Nothing when --check-config or --print-config was asked for: that has then been
/// done, and the program is to end. Throws InputError.
std::optional<SceneConfig> open_scene(const SceneArguments& arguments);

// What to say of a command line that does not parse.

/// One sentence: the word that is not understood, what was likely meant, and where all of them stand. `app`
/// has parsed the line as far as it goes.
std::string explain_parse_failure(const CLI::App& app, const CLI::ParseError& error, int argc,
                                  const char* const* argv);

}  // namespace obliq
