#pragma once
// How the commands that stay connected tell of a lost connection.
#include <cstdint>

#include "client/resuming_client.h"

namespace CLI {
class App;
}

namespace obliq {

/// Errors below this number end the connection, those above concern a radar that may recover.
constexpr std::uint32_t kFirstErrorOfRadar = 100;

/// Adds --reconnect. `patience_s` must outlive the parsing.
void add_reconnect_argument(CLI::App& app, int& patience_s);

/// Says on stderr when the connection is lost and when it is back.
client::ResumeOptions reconnecting(int patience_s);

}  // namespace obliq
