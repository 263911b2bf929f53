#include "server/log/log_fields.h"

#include <array>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>

namespace obliq {

namespace {

std::vector<LogField>& fields_of_thread() {
  thread_local std::vector<LogField> fields;
  return fields;
}

}  // namespace

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
  for (const LogField& field : fields) {
    std::visit([&](const auto& value) { line[field.name] = value; }, field.value);
  }
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
