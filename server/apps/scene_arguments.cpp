#include "server/apps/scene_arguments.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <vector>

#include "server/control/config_tree.h"
#include "server/control/scene_file.h"
#include "terrain/base/errors.h"

namespace obliq {

void add_repeatable(CLI::App& app, const std::string& name, std::vector<std::string>& to,
                    const std::string& text, const std::string& type) {
  app.add_option(name, to, text)->type_name(type)->expected(1)->take_all();
}

void add_radar_argument(CLI::App& app, std::string& radar) {
  app.add_option("--radar", radar, "Radar; default: the only one, or the one named main")->type_name("NAME");
}

void add_scene_arguments(CLI::App& app, const std::string& name, SceneArguments& arguments) {
  app.add_option(name, arguments.file, "Scene file (TOML)");
  add_repeatable(
      app, "--set", arguments.set,
      "KEY=VALUE, e.g. radar.r_max_m=50000, or RADAR:KEY=VALUE for one of several radars; beats file and "
      "environment (repeatable)");
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

namespace {

/// The sub-command that was recognised, or the program itself.
const CLI::App& recognised(const CLI::App& app) {
  const auto commands = app.get_subcommands();
  return commands.empty() ? app : *commands.front();
}

std::string program_of(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  return parent == nullptr ? app.get_name() : parent->get_name() + " " + app.get_name();
}

/// --NAME of every option, without the dashes.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::string unknown_option(const CLI::App& command, const std::string& word) {
  std::string name = word.substr(0, word.find('='));
  name.erase(0, name.find_first_not_of('-'));
  const std::vector<std::string> names = option_names(command);
  std::string near = nearest_name(name, names);
  // Clients name the place in one word; the daemon's port has an option of its own.
  if (name == "port" && std::ranges::find(names, "server") != names.end()) near = "server HOST:PORT";
  return fmt::format("{}: an unknown option of `{}`{}{} --help` lists them)", word, program_of(command),
                     near.empty() ? " (`" : "; did you mean --" + near + "? (`", program_of(command));
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  const std::string near = nearest_name(word, command_names(app));
  return fmt::format("{}: an unknown command{}{} --help` lists them)", word,
                     near.empty() ? " (`" : "; did you mean " + near + "? (`", program_of(app));
}

/// The first word of the line that no option took.
std::string first_left_over(const CLI::App& app, int argc, const char* const* argv) {
  const std::vector<std::string> left = app.remaining(true);
  for (int i = 1; i < argc; ++i)
    if (std::ranges::find(left, argv[i]) != left.end()) return argv[i];
  return left.empty() ? "" : left.front();
}

}  // namespace

std::string explain_parse_failure(const CLI::App& app, const CLI::ParseError& error, int argc,
                                  const char* const* argv) {
  const CLI::App& command = recognised(app);
  const std::string word = first_left_over(app, argc, argv);
  const bool left_over = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if (left_over && word.starts_with('-')) return unknown_option(command, word);
  if (left_over && &command == &app && !command_names(app).empty()) return unknown_command(app, word);
  if (left_over)
    return fmt::format("found \"{}\" where nothing more is expected (`{} --help` says what is)", word,
                       program_of(command));
  return std::string(error.what()) + " (`" + program_of(command) + " --help` lists what there is)";
}

}  // namespace obliq
