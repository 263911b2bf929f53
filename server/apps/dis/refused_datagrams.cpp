#include "server/apps/dis/refused_datagrams.h"

#include <fmt/core.h>

#include <algorithm>

namespace obliq {
namespace {

constexpr std::chrono::seconds kPause{1};
constexpr std::size_t kMostReasons = 8;  // of a line

}  // namespace

void RefusedDatagrams::add(const std::string& why) {
  ++all_;
  newest_ = why;
  if (waiting_.empty() && why == told_) return;
  const auto known = std::ranges::find(waiting_, why, [](const auto& reason) { return reason.first; });
  if (known != waiting_.end()) {
    ++known->second;
  } else if (waiting_.size() < kMostReasons) {
    waiting_.emplace_back(why, 1);
  } else {
    ++waiting_others_;
  }
}

std::string RefusedDatagrams::line(Clock::time_point now) {
  if (waiting_.empty() || now < next_) return {};
  next_ = now + kPause;
  return rest();
}

std::string RefusedDatagrams::rest() {
  if (waiting_.empty()) return {};
  std::uint64_t count = waiting_others_;
  std::string reasons;
  for (const auto& [why, times] : waiting_) {
    count += times;
    reasons += (reasons.empty() ? "" : " / ") + (times == 1 ? "" : std::to_string(times) + " x ") + why;
  }
  if (waiting_others_ > 0) reasons += fmt::format(" / {} for other reasons", waiting_others_);
  waiting_.clear();
  waiting_others_ = 0;
  told_ = newest_;
  return fmt::format("{} {}: {}", count, count == 1 ? "datagram is no pose" : "datagrams are no poses",
                     reasons);
}

}  // namespace obliq
