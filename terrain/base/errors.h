#pragma once
#include <stdexcept>
#include <string>
#include <vector>

namespace obliq {

/// An operator's mistake (configuration, missing or damaged file). The message names the file, key or
/// field, what was found and what is allowed. main() catches it once, prints one line, exits with 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One refused value: the key or field, what was found there, what is allowed.
struct FieldError {
  std::string field;
  std::string found;
  std::string allowed;

  std::string text() const { return field + ": found " + found + "; allowed: " + allowed; }
};

/// All of them in one line.
inline std::string all_text(const std::vector<FieldError>& errors) {
  std::string text;
  for (const FieldError& error : errors) text += (text.empty() ? "" : "; ") + error.text();
  return text;
}

}  // namespace obliq
