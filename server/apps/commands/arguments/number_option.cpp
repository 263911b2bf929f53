#include "server/apps/commands/arguments/number_option.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <string>
#include <system_error>

#include "server/net/options.h"

namespace obliq {
namespace {

constexpr std::uint64_t kMostCounted = 1'000'000'000'000;

std::string text_of(double value) { return fmt::format("{:.10g}", value); }

/// All of the text as a number between the limits; nan is between none.
template <typename Number>
bool is_within(const std::string& text, Number least, Number most) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end && value >= least && value <= most;
}

template <typename Number>
CLI::Validator check(Number least, Number most, const std::string& allowed) {
  return {[least, most, allowed](std::string& found) {
            if (is_within(found, least, most)) return std::string();
            return "found \"" + found + "\"; allowed: " + allowed;
          },
          ""};
}

}  // namespace

CLI::Validator whole_number_from(std::uint64_t least, std::uint64_t most) {
  return check(least, most, fmt::format("a whole number from {} to {}", least, most));
}

CLI::Validator number_from(double least, double most) {
  return check(least, most, "a number from " + text_of(least) + " to " + text_of(most));
}

CLI::Validator a_count() { return whole_number_from(0, kMostCounted); }
CLI::Validator a_rate() { return number_from(net::kLeastRate_hz, net::ServerOptions{}.max_rate_hz); }

}  // namespace obliq
