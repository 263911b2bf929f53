#include "server/explain/row.h"

#include <fmt/args.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "terrain/base/text.h"

template <>
struct fmt::formatter<obliq::NamedValue> {
  std::string format_text;

  constexpr auto parse(format_parse_context& context) {
    const auto end = std::find(context.begin(), context.end(), '}');
    format_text.assign(context.begin(), end);
    return end;
  }
  template <class Context>
  auto format(const obliq::NamedValue& named, Context& context) const {
    const double* number = std::get_if<double>(&named.value);
    const std::string text =
        number ? obliq::number_text(*number, format_text) : std::get<std::string>(named.value);
    return std::ranges::copy(text, context.out()).out;  // fmt::format_to would compile all of fmt here
  }
};

namespace obliq {

std::string number_text(double value, const std::string& format) {
  if (!std::isfinite(value)) return "-";
  if (!format.empty() && format.find_first_not_of("0123456789") == std::string::npos)
    return short_number(value, std::stoi(format));
  std::string text = fmt::format(fmt::runtime("{:" + format + "}"), value);
  if (!text.starts_with('-') || text.find_first_of("123456789") != std::string::npos) return text;
  return (format.starts_with('+') ? "+" : "") + text.substr(1);
}

std::vector<ReportRow> rows_of(const Values& values, std::initializer_list<Clause> table) {
  fmt::dynamic_format_arg_store<fmt::format_context> arguments;
  for (const NamedValue& named : values) arguments.push_back(fmt::arg(named.name, named));
  std::vector<ReportRow> rows;
  for (const auto& [row, said, text] : table) {
    const std::string filled = fmt::vformat(text, arguments);
    if (!said) continue;
    if (rows.empty() || rows.back().name != row) rows.push_back({row, ""});
    rows.back().text += filled;
  }
  return rows;
}

std::string text_of(const Values& values, std::initializer_list<Clause> table) {
  std::string text;
  for (const ReportRow& row : rows_of(values, table)) text += row.text;
  return text;
}

}  // namespace obliq
