#include "server/log/service_log.h"

#include <fmt/core.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/log/log.h"

namespace obliq {

namespace {

std::string level_name(spdlog::level::level_enum level) {
  if (level <= spdlog::level::debug) return "debug";
  if (level == spdlog::level::info) return "info";
  return level == spdlog::level::warn ? "warning" : "error";
}

spdlog::level::level_enum spdlog_level(LogLevel level) {
  constexpr std::array kLevels{spdlog::level::debug, spdlog::level::info, spdlog::level::warn,
                               spdlog::level::err};
  return kLevels[static_cast<std::size_t>(level)];
}

class JsonFormatter : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    const std::string line =
        json_line(message.time, level_name(message.level), {message.payload.data(), message.payload.size()},
                  LogFields::current());
    out.append(line.data(), line.data() + line.size());
    out.push_back('\n');
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

bool is_from_peer() {
  return std::ranges::any_of(LogFields::current(), [](const LogField& f) { return f.name == "client"; });
}

/// Counts every line, leaves out what peers cause in masses, and hands the rest to stderr.
class ServiceSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  void set_json(bool json) {
    const std::lock_guard lock(mutex_);
    json_ = json;
    if (json) {
      stderr_.set_formatter(std::make_unique<JsonFormatter>());
    } else {
      stderr_.set_pattern("[%Y-%m-%d %H:%M:%S.%e] [obliqd] [%^%l%$] %v");
    }
  }
  void set_listener(std::function<void(const std::string&)> listener) {
    const std::lock_guard lock(mutex_);
    listener_ = std::move(listener);
  }
  void report() {
    const std::lock_guard lock(mutex_);
    begin_second();
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (listener_) listener_(level_name(message.level));
    if (is_from_peer()) {
      begin_second();
      Budget& budget = budgets_[message.level];
      if (budget.written >= kPeerLinesPerSecond) {
        ++budget.suppressed;
        return;
      }
      ++budget.written;
    }
    write(message);
  }
  void flush_() override { stderr_.flush(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Budget {
    int written = 0;
    std::uint64_t suppressed = 0;
  };

  void write(const spdlog::details::log_msg& message) {
    const std::size_t all = message.payload.size();
    std::string text(message.payload.data(), std::min(all, kLongestMessageBytes));
    if (text.size() < all) text += fmt::format("... and {} bytes more", all - text.size());
    if (!json_) text = visible(text);  // JSON has escapes of its own
    spdlog::details::log_msg copy = message;
    copy.payload = text;
    stderr_.log(copy);
  }

  void begin_second() {
    const auto now = Clock::now();
    if (now < second_ + std::chrono::seconds(1)) return;
    second_ = now;
    for (auto& [level, budget] : budgets_) {
      const Budget over = std::exchange(budget, {});
      if (over.suppressed == 0) continue;
      const std::string text = fmt::format(
          "{} more lines ({}) about clients were left out: if they continue, find the address with a packet "
          "filter's log or `ss -tn`, and block it",
          over.suppressed, level_name(level));
      write(spdlog::details::log_msg("", spdlog::level::warn, text));
    }
  }

  spdlog::sinks::stderr_color_sink_st stderr_;
  bool json_ = false;
  std::function<void(const std::string&)> listener_;
  Clock::time_point second_ = Clock::now();
  std::map<spdlog::level::level_enum, Budget> budgets_;
};

std::shared_ptr<ServiceSink> the_sink() {
  static const auto sink = std::make_shared<ServiceSink>();
  return sink;
}

std::vector<LogField>& fields_of_thread() {
  thread_local std::vector<LogField> fields;
  return fields;
}

}  // namespace

void open_log(const LogConfig& config) {
  the_sink()->set_json(config.format == LogFormat::json);
  static const auto logger = [] {
    auto made = std::make_shared<spdlog::logger>("obliqd", the_sink());
    spdlog::set_default_logger(made);
    return made;
  }();
  logger->set_level(spdlog_level(config.level));
  logger->flush_on(spdlog::level::debug);
}

void on_log_line(std::function<void(const std::string& level)> call) {
  the_sink()->set_listener(std::move(call));
}

void report_suppressed_lines() { the_sink()->report(); }

void format_log(LogLevel level, fmt::string_view format, fmt::format_args arguments) noexcept {
  const auto at = spdlog_level(level);
  if (!spdlog::should_log(at)) return;
  spdlog::logger& logger = *spdlog::default_logger_raw();
  try {
    logger.log(at, spdlog::string_view_t(fmt::vformat(format, arguments)));
  } catch (const std::exception&) {
    logger.log(at, spdlog::string_view_t("a line is missing: it could not be formatted"));
  }
}

LogFields::LogFields(std::initializer_list<LogField> fields) : before_(fields_of_thread().size()) {
  fields_of_thread().insert(fields_of_thread().end(), fields);
}

LogFields::~LogFields() { fields_of_thread().resize(before_); }

const std::vector<LogField>& LogFields::current() { return fields_of_thread(); }

std::string utc_text(std::chrono::system_clock::time_point time) {
  using namespace std::chrono;
  const auto whole = floor<seconds>(time);
  const std::time_t seconds_1970 = system_clock::to_time_t(whole);
  std::tm utc{};
  gmtime_r(&seconds_1970, &utc);
  std::array<char, 32> text{};
  const std::size_t n = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::array<char, 16> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%06dZ",
                static_cast<int>(duration_cast<microseconds>(time - whole).count()));
  return std::string(text.data(), n) + fraction.data();
}

std::string json_line(std::chrono::system_clock::time_point time, std::string_view level,
                      std::string_view message, const std::vector<LogField>& fields) {
  nlohmann::ordered_json line;
  line["time"] = utc_text(time);
  line["level"] = level;
  line["message"] = message;
  for (const LogField& field : fields)
    std::visit([&](const auto& value) { line[field.name] = value; }, field.value);
  return line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string visible(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string clean;
  clean.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n') {
      clean += "\\n";
    } else if (c == '\t') {
      clean += "\\t";
    } else if (byte < 0x20 || byte == 0x7f) {
      clean.append("\\x").append(1, kHex[byte >> 4]).append(1, kHex[byte & 15]);
    } else {
      clean += c;
    }
  }
  return clean;
}

}  // namespace obliq
