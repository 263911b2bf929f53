#include "server/apps/commands/warning_changes.h"

#include <algorithm>
#include <cstdio>

namespace obliq {
namespace {

std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; });
  return text;
}

bool holds(const std::vector<std::string>& warnings, const std::string& warning) {
  return std::ranges::any_of(warnings, [&, text = without_numbers(warning)](const std::string& other) {
    return without_numbers(other) == text;
  });
}

}  // namespace

void WarningChanges::tell(std::vector<std::string> now, const std::string& where) {
  if (now == held_) return;
  for (const std::string& warning : now)
    if (!holds(held_, warning)) std::fprintf(stderr, "warning: %s%s\n", where.c_str(), warning.c_str());
  for (const std::string& warning : held_)
    if (!holds(now, warning)) std::fprintf(stderr, "over: %s%s\n", where.c_str(), warning.c_str());
  held_ = std::move(now);
}

}  // namespace obliq
