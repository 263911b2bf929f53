#pragma once
// What the daemon's log is like: [log] of a scene file sets it.

namespace obliq {

enum class LogFormat { text, json };
enum class LogLevel { debug, info, warning, error };

struct LogConfig {
  LogFormat format = LogFormat::text;
  LogLevel level = LogLevel::info;  ///< the least that is written
};

}  // namespace obliq
