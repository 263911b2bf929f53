#pragma once
#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "terrain/base/errors.h"

namespace obliq {

/// What is wrong with a configuration, collected so that all of it is reported at once.
class Complaints {
 public:
  void add(const std::string& where, const FieldError& error) { add(where + ": " + error.text()); }
  void add(std::string line) {
    if (std::ranges::find(lines_, line) == lines_.end()) lines_.push_back(std::move(line));
  }
  bool empty() const { return lines_.empty(); }

  /// Throws InputError, one complaint a line, if there is any.
  void throw_if_any() const {
    if (lines_.empty()) return;
    std::string text;
    for (const std::string& line : lines_) text += (text.empty() ? "" : "\n") + line;
    throw InputError(text);
  }

 private:
  std::vector<std::string> lines_;
};

/// The candidate that `word` is most likely a slip of, or empty if none is near.
std::string nearest_name(std::string_view word, std::span<const std::string> candidates);

}  // namespace obliq
