#pragma once
#include <functional>
#include <string>

#include "terrain/base/parallel.h"

namespace obliq {

/// A line for the operator.
struct ReportLine {
  ReportLine(std::string line, bool is_warning = false) : text(std::move(line)), warns(is_warning) {}
  ReportLine(const char* line) : text(line) {}

  std::string text;
  bool warns = false;
};
using Say = std::function<void(const ReportLine&)>;

/// On stderr, warnings behind "warning: ".
void say_on_terminal(const ReportLine& line);

/// How far a long stage has come, on stderr: a line that is written over on a terminal, elsewhere a line now
/// and then, from the second second on. The time left is counted from where the fraction last fell.
Progress terminal_progress();

}  // namespace obliq
