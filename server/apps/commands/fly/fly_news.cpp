#include "server/apps/commands/fly/fly_news.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace obliq {
namespace {

using Clock = std::chrono::steady_clock;

void tell(const std::string& line) {
  if (!line.empty()) std::fprintf(stderr, "obliq: %s\n", line.c_str());
}

}  // namespace

void FlyNews::add(std::string text) {
  constexpr std::size_t kMostNews = 8;
  if (news_.size() < kMostNews && std::ranges::find(news_, text) == news_.end())
    news_.push_back(std::move(text));
}

void FlyNews::hear(std::vector<std::string> warnings) {
  for (const std::string& warning : warnings)
    if (std::ranges::find(warnings_, warning) == warnings_.end()) add("warning: " + warning);
  warnings_ = std::move(warnings);
}

void FlyNews::tell_news() {
  if (news_.empty()) return;
  std::string line;
  for (const std::string& one : news_) line += (line.empty() ? "" : "; ") + one;
  news_.clear();
  next_ = Clock::now() + kPause;
  tell(line);
}

void FlyNews::tell_what_is_due() {
  if (const std::string line = refused_.line(Clock::now()); !line.empty()) {
    tell(line);
    next_ = Clock::now() + kPause;
  } else if (Clock::now() >= next_) {
    tell_news();
  }
}

void FlyNews::tell_the_rest() {
  tell(refused_.rest());
  tell_news();
}

}  // namespace obliq
