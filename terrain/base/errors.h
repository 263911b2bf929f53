#pragma once
#include <exception>
#include <iterator>
#include <new>
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

inline void append(std::vector<FieldError>& errors, std::vector<FieldError> more) {
  errors.insert(errors.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// What is wrong, in words: what the C++ library throws for lack of memory has none of its own.
inline std::string failure_text(const std::exception& failure) {
  if (dynamic_cast<const std::bad_alloc*>(&failure) != nullptr ||
      dynamic_cast<const std::length_error*>(&failure) != nullptr)
    return "there is not enough memory for it; less terrain, smaller frames or a coarser terrain.cell_m need "
           "less";
  return failure.what();
}

}  // namespace obliq
