#pragma once
// Lines of a report as data: the values that are measured, by name, and a table of templates that say them.
#include <initializer_list>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace obliq {

/// A number by fmt's format (".1f"), or, where that is a whole number, with so many digits (short_number).
/// One that rounds to zero has no minus, one that is not finite is "-".
std::string number_text(double value, const std::string& format);

struct NamedValue {
  const char* name;
  std::variant<double, std::string> value;
};
struct ValueName {
  const char* name;
  template <class T>
  NamedValue operator=(const T& value) const {
    if constexpr (std::is_arithmetic_v<T>)
      return {name, static_cast<double>(value)};
    else
      return {name, std::string(value)};
  }
};
inline ValueName operator""_is(const char* name, std::size_t /*length*/) { return {name}; }

/// values("loss_db"_is = 3.2, "rain"_is = "on").
using Values = std::vector<NamedValue>;
template <class... Named>
Values values(Named... named) {
  return {std::move(named)...};
}

/// A part of the row of that name, where it is said. Names in braces stand for values, numbers with their
/// format behind a colon: "{rain}: {loss_db:.1f} dB at {r_max_km:4} km".
struct Clause {
  const char* row;
  bool said;
  const char* text;
};

/// "noise", and what there is to say about it.
struct ReportRow {
  std::string name, text;
};

inline void append(std::vector<ReportRow>& rows, std::vector<ReportRow> more) {
  rows.insert(rows.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// The rows of which anything is said, in the table's order. Throws fmt::format_error when any clause, said
/// or not, has a name that there is not.
std::vector<ReportRow> rows_of(const Values& values, std::initializer_list<Clause> table);
/// What a table of one row says.
std::string text_of(const Values& values, std::initializer_list<Clause> table);

}  // namespace obliq
