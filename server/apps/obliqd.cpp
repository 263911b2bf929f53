// The daemon: loads a scene and serves its radars.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>
#include <utility>

#include "server/apps/daemon.h"
#include "server/apps/scene_arguments.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Serves radar ground maps of real terrain over TCP. The port is taken at once; until the terrain is "
      "loaded "
      "connections are refused (`obliq get --wait SECONDS` tries again).",
      "obliqd"};
  app.set_version_flag("--version", "obliqd " OBLIQ_VERSION);
  obliq::SceneArguments arguments;
  obliq::add_scene_arguments(app, "--config", arguments);
  const auto setting = [&](const char* key) {
    return [&arguments, key](const std::string& value) {
      arguments.set.push_back(std::string(key) + "=" + value);
    };
  };
  app.add_option_function<std::string>("--port", setting("server.port"), "Short for --set server.port");
  app.add_option_function<std::string>("--address", setting("server.address"),
                                       "Short for --set server.address");
  spdlog::set_default_logger(spdlog::stderr_color_mt("obliqd"));
  spdlog::flush_on(spdlog::level::info);
  obliq::heed_signals_before_start();
  try {
    app.parse(argc, argv);
    auto config = obliq::open_scene(arguments);
    if (config) obliq::run_daemon(std::move(*config));
    std::cout.flush();
    return std::cout ? 0 : 1;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::cerr << "obliqd: " << e.what() << " (`obliqd --help` lists what there is)\n";
  } catch (const std::exception& e) {
    std::cerr << "obliqd: " << e.what() << '\n';
  }
  return 1;
}
