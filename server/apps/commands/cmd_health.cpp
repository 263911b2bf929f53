// `obliq health`: asks a daemon of this machine over HTTP how it is; for health checks of containers.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/commands.h"
#include "server/apps/scene_arguments.h"
#include "server/control/scene_file.h"
#include "server/http/http_client.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

struct HealthArguments {
  std::string file;
  std::vector<std::string> set;
  bool ready = false;
  double timeout_s = 5;
};

/// Where a daemon that listens on all addresses can be asked on its own machine.
std::string own_address(const std::string& address) {
  if (address == "0.0.0.0" || address.empty()) return "127.0.0.1";
  return address == "::" ? "::1" : address;
}

void run(const HealthArguments& arguments) {
  if (arguments.file.empty()) throw InputError("found no scene file; allowed: that of the daemon to check");
  const SceneConfig config = load_scene_file(arguments.file, {arguments.set});
  if (!config.http.enabled)
    throw InputError("http.enabled: found false; allowed: true, for a daemon to check");
  if (config.http.port == 0)
    throw InputError(
        "http.port: found 0 (any free one); allowed: the port that the daemon has, by --set http.port=N");
  http::Question question;
  question.address = own_address(config.http.address);
  question.port = static_cast<std::uint16_t>(config.http.port);
  question.path = arguments.ready ? "/readyz" : "/healthz";
  question.tls = !config.server.tls_certificate.empty();
  question.timeout_s = arguments.timeout_s;
  const http::Answer answer = http::ask(question);
  const std::string where = fmt::format("{}{}:{}{}", question.tls ? "https://" : "http://", question.address,
                                        question.port, question.path);
  const std::string said = answer.body.substr(0, answer.body.find('\n'));
  if (answer.status == 0) throw InputError("not healthy: " + where + ": " + answer.error);
  if (answer.status != 200)
    throw InputError(fmt::format("not healthy: {} answered {} {}", where, answer.status, said));
  std::printf("healthy: %s: %s\n", where.c_str(), said.c_str());
}

}  // namespace

void add_health(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "health",
      "Check the health of a scene file's daemon on this machine: exit code 0 when it is healthy, else 1");
  auto arguments = std::make_shared<HealthArguments>();
  command->add_option("SCENE,--config", arguments->file,
                      "Scene file (TOML) of the daemon, whose [http] gives the address");
  add_repeatable(*command, "--set", arguments->set, "KEY=VALUE, as the daemon was given it (repeatable)");
  command->add_flag("--ready", arguments->ready, "Check that it serves (/readyz), not only that it runs");
  command->add_option("--timeout", arguments->timeout_s, "Seconds to wait for the answer")
      ->check(number_from(0.1, 3600))
      ->capture_default_str();
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
