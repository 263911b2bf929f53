#pragma once
// The daemon's log on stderr: text for people, or a JSON object a line for programs.
#include <chrono>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/log/log_config.h"

namespace obliq {

/// Lines that peers cause (see LogFields) are written up to a limit per second and level; the others are
/// counted and the count is written.
constexpr int kPeerLinesPerSecond = 20;

/// Of a line's message; what is longer is cut. The daemon's own words are a tenth of it.
constexpr std::size_t kLongestMessageBytes = 4096;

/// Becomes spdlog's default logger. Control characters in a line are made visible, so that no client can
/// forge another line, and a long message is cut, so that none fills the disk. Call again to change format or
/// level.
void open_log(const LogConfig& config);

/// Receives the level of every line, also of those left out: "debug", "info", "warning" or "error". From the
/// thread that logs; must not log. Empty: none.
void on_log_line(std::function<void(const std::string& level)> call);

/// Writes the count of the lines left out, if there are any and their second is over. Once a second or so.
void report_suppressed_lines();

/// A named value of a log line, beside its words.
struct LogField {
  std::string name;
  std::variant<std::string, std::int64_t> value;
};

/// What the lines carry that this thread logs while the object lives; JSON lines show it. A line with a field
/// "client" is one that a peer has caused, and of those only so many are written a second. Never across a
/// co_await: another coroutine would log under these fields.
class LogFields {
 public:
  LogFields(std::initializer_list<LogField> fields);
  ~LogFields();
  LogFields(const LogFields&) = delete;
  LogFields& operator=(const LogFields&) = delete;

  /// Of this thread; of fields with one name the last counts.
  static const std::vector<LogField>& current();

 private:
  std::size_t before_;
};

/// "2026-11-20T12:00:00.123456Z".
std::string utc_text(std::chrono::system_clock::time_point time);

/// One JSON object without a line break: time, level, message, then the fields; of fields with one name the
/// last. Bytes that are no UTF-8 become U+FFFD.
std::string json_line(std::chrono::system_clock::time_point time, std::string_view level,
                      std::string_view message, const std::vector<LogField>& fields);

/// The text with control characters as \n, \t, \x1b and so on.
std::string visible(std::string_view text);

}  // namespace obliq
