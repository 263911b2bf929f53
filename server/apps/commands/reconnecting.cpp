#include "server/apps/commands/reconnecting.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include "server/apps/commands/number_option.h"

namespace obliq {
namespace {

// Long enough for a daemon that is restarted and loads a large scene.
constexpr int kPatience_s = 300;
constexpr int kMaxPatience_s = 86400;

}  // namespace

void add_reconnect_argument(CLI::App& app, int& patience_s) {
  app.add_option("--reconnect", patience_s,
                 "After losing the connection, try for this long to reconnect; 0: end at once")
      ->type_name("SECONDS")
      ->default_val(kPatience_s)
      ->check(whole_number_from(0, kMaxPatience_s));
}

client::ResumeOptions reconnecting(int patience_s) {
  client::ResumeOptions options;
  options.patience = std::chrono::seconds(patience_s);
  options.on_lost = [patience_s](const client::Status& why) {
    std::fprintf(stderr, "obliq: connection lost: %s; retrying for at most %d s\n", why.sentence().c_str(),
                 patience_s);
  };
  options.on_resumed = [](std::chrono::duration<double> after) {
    std::fprintf(stderr, "obliq: connected again, %.1f s after the connection was lost\n", after.count());
  };
  return options;
}

}  // namespace obliq
