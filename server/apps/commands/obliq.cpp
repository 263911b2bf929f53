// The `obliq` command: parses the line, runs one sub-command, turns any failure into one line on stderr.
#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>

#include "server/apps/commands/commands.h"
#include "server/apps/scene_arguments.h"
#include "server/apps/version/version.h"
#include "terrain/base/errors.h"

namespace {

constexpr auto kCommands = {
    obliq::add_render,   obliq::add_frontier, obliq::add_frustum, obliq::add_explain,    obliq::add_get,
    obliq::add_watch,    obliq::add_record,   obliq::add_replay,  obliq::add_pose,       obliq::add_fly,
    obliq::add_set,      obliq::add_targets,  obliq::add_status,  obliq::add_query,      obliq::add_exercise,
    obliq::add_bookmark, obliq::add_cat240,   obliq::add_health,  obliq::add_parameters,
};

constexpr int kFailed = 1;
constexpr int kPartlyDone = 2;

/// One line for each thing that is wrong (a scene file may have several).
int complain(std::string what, int code = kFailed) {
  for (std::size_t at = 0; (at = what.find('\n', at)) != std::string::npos;) what.insert(++at, "obliq: ");
  std::cerr << "obliq: " << what << '\n';
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  // A file that may grow no further (ulimit -f) is reported by its writer, not by the signal's
  // default, which is to die without a word.
  (void)std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app{
      "Radar ground maps of real terrain: azimuth x range bins of complex I&Q, and pictures of them.",
      "obliq"};
  app.set_version_flag("--version", std::string("obliq ") + obliq::program_version());
  app.require_subcommand(0, 1);  // none is refused below, by a better sentence
  app.footer("`obliq COMMAND --help` explains a command.");
  try {
    for (const auto add : kCommands) add(app);
    app.parse(argc, argv);
    if (app.get_subcommands().empty())
      return complain("found no command; allowed: one that `obliq --help` lists");
    std::cout.flush();
    if (!std::cout)
      return complain("standard output: cannot be written (disk full, or its reader has gone?)");
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help and --version arrive here too
    return complain(obliq::explain_parse_failure(app, e, argc, argv));
  } catch (const obliq::PartlyDone& e) {
    return complain(e.what(), kPartlyDone);
  } catch (const std::exception& e) {  // InputError above all; a bad_alloc deserves its line as well
    return complain(obliq::failure_text(e));
  }
}
