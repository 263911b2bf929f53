#pragma once
// Lines of the daemon's log. Each source that calls spdlog's own functions with arguments compiles all of
// fmt's formatting, two seconds of GCC's: these compile it once.
#include <fmt/core.h>

#include "server/log/log_config.h"

namespace obliq {

/// Formats by fmt's rules where the log takes lines of that level. A line that cannot be formatted, as
/// without memory, is left out, which the log says.
void format_log(LogLevel level, fmt::string_view format, fmt::format_args arguments) noexcept;

template <typename... T>
void log_line(LogLevel level, fmt::format_string<T...> format, T&&... arguments) {
  format_log(level, format, fmt::make_format_args(arguments...));
}
template <typename... T>
void log_debug(fmt::format_string<T...> format, T&&... arguments) {
  format_log(LogLevel::debug, format, fmt::make_format_args(arguments...));
}
template <typename... T>
void log_info(fmt::format_string<T...> format, T&&... arguments) {
  format_log(LogLevel::info, format, fmt::make_format_args(arguments...));
}
template <typename... T>
void log_warning(fmt::format_string<T...> format, T&&... arguments) {
  format_log(LogLevel::warning, format, fmt::make_format_args(arguments...));
}
template <typename... T>
void log_error(fmt::format_string<T...> format, T&&... arguments) {
  format_log(LogLevel::error, format, fmt::make_format_args(arguments...));
}

}  // namespace obliq
