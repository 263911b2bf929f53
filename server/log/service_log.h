#pragma once
// The daemon's log on stderr: text for people, or a JSON object a line for programs.
#include <functional>
#include <string>

#include "server/control/sections/log.h"

namespace obliq {

/// Lines that peers cause (see LogFields) are written up to so many a second and level; the others are
/// counted and the count is written.
constexpr int kPeerLinesPerSecond = 20;

/// Becomes spdlog's default logger. Control characters in a line are made visible, so that no client can
/// forge another line. Call again to change format or level.
void open_log(const LogConfig& config);

/// Hears the level of every line, also of those left out: "debug", "info", "warning" or "error". From the
/// thread that logs; must not log. Empty: none.
void on_log_line(std::function<void(const std::string& level)> call);

/// Writes the count of the lines left out, if there are any and their second is over. Once a second or so.
void report_suppressed_lines();

}  // namespace obliq
