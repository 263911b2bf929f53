// The `obliq` command: parses the line, runs one sub-command, turns any failure into one line on stderr.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "server/apps/commands.h"
#include "terrain/errors.h"

namespace {

constexpr auto kCommands = {
    obliq::add_render,
    obliq::add_frustum,
    obliq::add_mesh,
    obliq::add_parameters,
};

int complain(const char* what) {
  std::cerr << "obliq: " << what << '\n';
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Radar ground maps of real terrain: azimuth x range bins of complex I&Q, and pictures of them.",
      "obliq"};
  app.set_version_flag("--version", "obliq " OBLIQ_VERSION);
  app.require_subcommand(1);
  app.footer("`obliq COMMAND --help` explains a command.");
  try {
    for (const auto add : kCommands) add(app);
    app.parse(argc, argv);
    std::cout.flush();
    if (!std::cout)
      return complain("standard output: cannot be written (disk full, or its reader has gone?)");
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help and --version arrive here too
    return complain((std::string(e.what()) + " (`obliq --help` lists what there is)").c_str());
  } catch (const std::exception& e) {  // InputError above all; a bad_alloc deserves its line as well
    return complain(e.what());
  }
}
