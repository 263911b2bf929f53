#pragma once
// [log]: what the daemon writes on stderr.

namespace obliq {

struct Section;

enum class LogFormat { text, json };
enum class LogLevel { debug, info, warning, error };

/// What the daemon writes on stderr.
struct LogConfig {
  LogFormat format = LogFormat::text;
  LogLevel level = LogLevel::info;  ///< the least that is written
};

extern const Section kLogSection;

}  // namespace obliq
