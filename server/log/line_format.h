#pragma once
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "server/log/log_fields.h"

namespace obliq {

/// "2026-11-20T12:00:00.123456Z".
std::string utc_text(std::chrono::system_clock::time_point time);

/// One JSON object without a line break: time, level, message, then the fields; of fields with one name the
/// last. Bytes that are no UTF-8 become U+FFFD.
std::string json_line(std::chrono::system_clock::time_point time, std::string_view level,
                      std::string_view message, const std::vector<LogField>& fields);

/// The text with control characters as \n, \t, \x1b and so on.
std::string visible(std::string_view text);

}  // namespace obliq
