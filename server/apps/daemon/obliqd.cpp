// The daemon: loads a scene and serves its radars.
#include <google/protobuf/stubs/logging.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <thread>
#include <utility>

#include "server/apps/daemon/daemon.h"
#include "server/apps/scene_arguments.h"
#include "server/apps/version/version.h"
#include "server/log/log.h"
#include "server/log/service_log.h"
#include "terrain/base/errors.h"

namespace {

/// Threads come and go with each frame, and the C library gives them heaps of their own, eight for each core,
/// which all keep what was ever freed in them: weeks on, that is a multiple of what is in use. One for each
/// core costs no time (mallopt(3), M_ARENA_MAX).
void keep_memory_together() {
  mallopt(M_ARENA_MAX, static_cast<int>(std::max(2u, std::thread::hardware_concurrency())));
}

/// What libraries would write on stderr by themselves goes to the log: protobuf says there what is wrong with
/// a peer's bytes, as often as the peer likes.
void take_over_library_logs() {
  google::protobuf::SetLogHandler(
      [](google::protobuf::LogLevel, const char*, int, const std::string& message) {
        obliq::log_debug("protobuf: {}", message);  // the request is answered with an Error, which is logged
      });
}

}  // namespace

int main(int argc, char** argv) {
  keep_memory_together();
  CLI::App app{
      "Serves radar ground maps of real terrain over TCP. The port is opened at once; connections are "
      "refused until the terrain is loaded (`obliq get --wait SECONDS` retries). SIGTERM and SIGINT shut it "
      "down cleanly, a second one at once; SIGHUP reads the scene file again.",
      "obliqd"};
  app.set_version_flag("--version", std::string("obliqd ") + obliq::program_version());
  obliq::SceneArguments arguments;
  obliq::add_scene_arguments(app, "SCENE,--config", arguments);
  const auto setting = [&](const char* key) {
    return [&arguments, key](const std::string& value) {
      arguments.set.push_back(std::string(key) + "=" + value);
    };
  };
  app.add_option_function<std::string>("--port", setting("server.port"), "Short for --set server.port");
  app.add_option_function<std::string>("--address", setting("server.address"),
                                       "Short for --set server.address");
  obliq::LogConfig log;
  obliq::open_log(log);
  take_over_library_logs();
  obliq::heed_signals_before_start();
  try {
    app.parse(argc, argv);
    auto config = obliq::open_scene(arguments);
    if (config) {
      log = config->log;
      obliq::open_log(log);
      obliq::run_daemon(std::move(*config), arguments);
    }
    std::cout.flush();
    return std::cout ? 0 : 1;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::cerr << "obliqd: " << obliq::explain_parse_failure(app, e, argc, argv) << '\n';
  } catch (const std::exception& e) {
    if (log.format == obliq::LogFormat::json) {
      obliq::log_error("{}", obliq::failure_text(e));
    } else {
      std::cerr << "obliqd: " << obliq::failure_text(e) << '\n';
    }
  }
  return 1;
}
