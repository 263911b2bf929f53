// Log lines: what a program reads from the JSON, and that nobody can forge a line.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "server/log/log.h"
#include "server/log/service_log.h"

namespace obliq::test::line_format_test {
namespace {

using std::chrono::system_clock;

TEST(LogLine, TheTimeIsUtcAsIso8601) {
  // 2^31 s after 1970 began (known from the year-2038 problem), and a quarter second.
  const auto time =
      system_clock::time_point(std::chrono::seconds(2147483648LL)) + std::chrono::milliseconds(250);
  EXPECT_EQ(utc_text(time), "2038-01-19T03:14:08.250000Z");
}

TEST(LogLine, JsonReadsBackWhatWasSaidWhateverTheBytes) {
  std::string every_byte;
  for (int c = 0; c < 128; ++c) every_byte += static_cast<char>(c);
  const std::string line =
      json_line(system_clock::time_point{}, "warning", every_byte,
                {{"client", std::string("\"}\n{\"level\":\"error\"")}, {"error", std::int64_t{9}}});
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const auto read = nlohmann::json::parse(line);
  EXPECT_EQ(read["message"], every_byte);
  EXPECT_EQ(read["level"], "warning");
  EXPECT_EQ(read["client"], "\"}\n{\"level\":\"error\"");
  EXPECT_EQ(read["error"], 9);
  EXPECT_EQ(read["time"], "1970-01-01T00:00:00.000000Z");
}

TEST(LogLine, BytesThatAreNoUtf8AreReplacedNotThrown) {
  std::string bytes;
  for (int c = 128; c < 256; ++c) bytes += static_cast<char>(c);
  const auto read = nlohmann::json::parse(json_line({}, "info", bytes, {{"client", bytes}}));
  EXPECT_NE(read["message"].get<std::string>().find("\xEF\xBF\xBD"), std::string::npos);
}

TEST(LogLine, ControlCharactersAreMadeVisibleInText) {
  EXPECT_EQ(visible("a\nb\tc\x1b[31m\r\x7f"), "a\\nb\\tc\\x1b[31m\\x0d\\x7f");
  EXPECT_EQ(visible("Z\xC3\xBCrich"), "Z\xC3\xBCrich");
}

TEST(LogFieldsTest, LastForTheirScopeAndBelongToTheirThread) {
  const LogFields outer{{"client", std::string("one")}};
  {
    const LogFields inner{{"radar", std::string("main")}};
    EXPECT_EQ(LogFields::current().size(), 2u);
    std::thread([] { EXPECT_TRUE(LogFields::current().empty()); }).join();
  }
  ASSERT_EQ(LogFields::current().size(), 1u);
  EXPECT_EQ(LogFields::current().front().name, "client");
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(ServiceLog, AMessageOfAMegabyteIsCut) {
  const std::string much(1'000'000, 'x');
  for (const LogFormat format : {LogFormat::json, LogFormat::text}) {
    testing::internal::CaptureStderr();
    LogConfig config;
    config.format = format;
    open_log(config);
    log_warning("{}", much);
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_LT(text.size(), kLongestMessageBytes + 200);
    EXPECT_NE(text.find("xxx... and 995904 bytes more"), std::string::npos) << text.substr(4000);
  }
}

TEST(ServiceLog, WhatAPeerCausesInMassesIsBoundedAndCounted) {
  std::map<std::string, int> heard;
  on_log_line([&](const std::string& level) { ++heard[level]; });
  testing::internal::CaptureStderr();
  LogConfig config;
  config.format = LogFormat::json;
  open_log(config);
  constexpr int kMany = 100'000;
  {
    const LogFields fields{{"client", std::string("a flood")}};
    for (int i = 0; i < kMany; ++i) log_warning("refused");
  }
  log_warning("the operator's own");
  std::string text = testing::internal::GetCapturedStderr();
  // Until the second of the last ones is over.
  while (text.find("more lines") == std::string::npos ||
         text.rfind("more lines") < text.rfind("the operator's own")) {
    testing::internal::CaptureStderr();
    usleep(50'000);
    report_suppressed_lines();
    text += testing::internal::GetCapturedStderr();
  }
  on_log_line({});
  int written = 0;
  int suppressed = 0;
  int own = 0;
  int reports = 0;
  for (const std::string& line : lines_of(text)) {
    const std::string message = nlohmann::json::parse(line)["message"];
    written += message == "refused" ? 1 : 0;
    own += message == "the operator's own" ? 1 : 0;
    const bool report = message.find(" more lines (warning)") != std::string::npos;
    reports += report ? 1 : 0;
    suppressed += report ? std::stoi(message) : 0;
  }
  EXPECT_EQ(own, 1) << "an operator's line is never left out";
  EXPECT_EQ(written + suppressed, kMany);
  EXPECT_LE(written, kPeerLinesPerSecond * (reports + 1));
  EXPECT_EQ(heard["warning"], kMany + 1) << "the metrics count every line";
}

}  // namespace
}  // namespace obliq::test::line_format_test
