#pragma once

namespace obliq {

enum class LogFormat { text, json };
enum class LogLevel { debug, info, warning, error };

/// What the daemon writes on stderr.
struct LogConfig {
  LogFormat format = LogFormat::text;
  LogLevel level = LogLevel::info;  ///< the least that is written
};

}  // namespace obliq
