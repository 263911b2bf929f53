#include "server/apps/parse_failure.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "server/control/complaints.h"

namespace obliq {
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
