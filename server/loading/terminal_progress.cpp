#include "server/loading/terminal_progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "terrain/base/units.h"

namespace obliq {
namespace {

using Clock = std::chrono::steady_clock;

// What takes no longer needs no line in a log, nor a guess when it will end.
constexpr double kQuick_s = 1.5;
constexpr double kPause_s = 5;        // between two lines of one stage
constexpr double kLeastShare = 0.02;  // from which the time left is guessed

class ProgressLines {
 public:
  explicit ProgressLines(bool terminal) : terminal_(terminal) {}

  void tell(std::string_view stage, double fraction) {
    const auto now = Clock::now();
    if (fraction < fraction_) {
      start_ = now;
      start_fraction_ = fraction;
    }
    fraction_ = fraction;
    if (terminal_) return write_over(stage, now);
    const bool is_new = stage != stage_;
    stage_ = stage;
    if (to_seconds(now - start_) < kQuick_s || fraction >= 1) return;
    if (!is_new && to_seconds(now - written_) < kPause_s) return;
    written_ = now;
    std::fprintf(stderr, "%s\n", text(stage, now).c_str());
  }

 private:
  std::string text(std::string_view stage, Clock::time_point now) const {
    const std::string line = fmt::format("{} {:3.0f} %", stage, 100 * fraction_);
    const double spent_s = to_seconds(now - start_);
    const double done = fraction_ - start_fraction_;
    if (spent_s < kQuick_s || done < kLeastShare) return line;
    return line + fmt::format(", {:.0f} s left", spent_s / done * (1 - fraction_));
  }

  void write_over(std::string_view stage, Clock::time_point now) const {
    std::fprintf(stderr, "\r\033[K%s", fraction_ >= 1 ? "" : text(stage, now).c_str());
  }

  const bool terminal_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point written_;
  double start_fraction_ = 0;
  double fraction_ = 0;
  std::string stage_;
};

}  // namespace

void say_on_terminal(const ReportLine& line) {
  std::fprintf(stderr, "%s%s\n", line.warns ? "warning: " : "", line.text.c_str());
}

Progress terminal_progress() {
  const auto lines = std::make_shared<ProgressLines>(isatty(STDERR_FILENO) != 0);
  return [lines](std::string_view stage, double fraction) { lines->tell(stage, fraction); };
}

}  // namespace obliq
