#include "server/control/key.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <utility>

#include "terrain/base/units.h"

namespace obliq {

namespace {

constexpr std::string_view kAuto = "auto";

std::string number_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::array<char, 32> buffer{};
  const double size = std::abs(value);
  const bool plain = value == 0 || (size >= 1e-4 && size < 1e15);  // then without an exponent
  const auto format = plain ? std::chars_format::fixed : std::chars_format::scientific;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format).ptr;
  return {buffer.data(), end};
}

std::string with_unit(std::string text, std::string_view unit) {
  if (!unit.empty()) text.append(" ").append(unit);
  return text;
}

/// Of lengths and speeds (NIST SP 811, appendix B): the international foot, the nautical mile and the knot
/// are these numbers exactly.
struct NamedUnit {
  std::string_view of;  ///< the unit of the keys that may have it
  std::string_view name;
  double times;
  double over = 1;
};
constexpr NamedUnit kUnits[] = {
    {"m", "m", 1},     {"m", "km", 1000},         {"m", "ft", kFoot_m},       {"m", "nmi", 1852},
    {"m/s", "m/s", 1}, {"m/s", "kt", 1852, 3600}, {"m/s", "km/h", 1000, 3600}};

/// "m, km, ft, nmi"; empty: texts are no numbers there.
std::string units_of(const Key& key) {
  std::string names;
  for (const NamedUnit& unit : kUnits)
    if (unit.of == key.unit) names.append(names.empty() ? "" : ", ").append(unit.name);
  return names;
}

/// A number with its unit behind it, "9842 ft" or "9842ft", in the key's own.
std::optional<double> number_with_unit(const Key& key, std::string_view text) {
  double number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  std::string_view name = text.substr(static_cast<std::size_t>(rest - text.data()));
  while (name.starts_with(' ')) name.remove_prefix(1);
  for (const NamedUnit& unit : kUnits)
    if (unit.of == key.unit && unit.name == name) return number * unit.times / unit.over;
  return std::nullopt;
}

/// The value as T when that is exact and its type serves; enumerations are looked up by name.
template <class T>
std::optional<T> convert(const Key& key, const Value& value) {
  if constexpr (std::is_enum_v<T>) {
    const auto* name = std::get_if<std::string>(&value);
    if (name == nullptr) return std::nullopt;
    for (std::size_t i = 0; i < key.choices.size(); ++i)
      if (key.choices[i].name == *name) return static_cast<T>(i);
    return std::nullopt;
  } else if constexpr (std::is_same_v<T, std::optional<double>>) {
    if (value == Value(std::string(kAuto))) return std::optional<T>(std::in_place);
    const auto number = convert<double>(key, value);
    return number ? std::optional<T>(std::in_place, *number) : std::nullopt;
  } else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>) {
    const auto* same = std::get_if<T>(&value);
    return same != nullptr ? std::optional<T>(*same) : std::nullopt;
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    if (const auto* list = std::get_if<T>(&value)) return *list;
    const auto number = convert<double>(key, value);
    return number ? std::optional<T>(std::in_place, 1, *number) : std::nullopt;
  } else if constexpr (std::is_same_v<T, double>) {
    if (const auto* real = std::get_if<double>(&value)) return *real;
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
    if (const auto* whole = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*whole);
    const auto* text = std::get_if<std::string>(&value);
    return text != nullptr ? number_with_unit(key, *text) : std::nullopt;
  } else {
    if (const auto* whole = std::get_if<std::int64_t>(&value))
      return std::in_range<T>(*whole) ? std::optional<T>(static_cast<T>(*whole)) : std::nullopt;
    if (const auto* whole = std::get_if<std::uint64_t>(&value))
      return std::in_range<T>(*whole) ? std::optional<T>(static_cast<T>(*whole)) : std::nullopt;
    return std::nullopt;
  }
}

}  // namespace

std::string_view change_name(Change change) {
  return change == Change::live ? "live" : change == Change::reload ? "reload" : "restart";
}

std::string limits_text(const Limits& limits, std::string_view unit) {
  const bool has_low = std::isfinite(limits.low);
  const bool has_high = std::isfinite(limits.high);
  if (has_low && has_high && !limits.low_open && !limits.high_open)
    return with_unit(number_text(limits.low) + " to " + number_text(limits.high), unit);
  std::string text;
  if (has_low) text = (limits.low_open ? "above " : "at least ") + number_text(limits.low);
  if (has_high)
    text += (text.empty() ? "" : ", ") + std::string(limits.high_open ? "below " : "at most ") +
            number_text(limits.high);
  if (!has_high && !limits.high_open) text += " (inf included)";
  return text.empty() ? "any" : with_unit(text, unit);
}

std::string choices_text(std::span<const Choice> choices) {
  std::string text;
  for (const Choice& choice : choices)
    if (!choice.retired) text += (text.empty() ? "" : " | ") + toml_string(choice.name);
  return text;
}

bool Limits::contains(long double x) const {
  return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
}

std::optional<FieldError> store(const Key& key, const Slot& slot, const Value& value) {
  return std::visit(
      [&](auto* place) -> std::optional<FieldError> {
        const auto converted = convert<std::remove_pointer_t<decltype(place)>>(key, value);
        if (!converted) {
          const std::string units = std::holds_alternative<std::string>(value) ? units_of(key) : "";
          return FieldError{std::string(key.name), toml_text(value),
                            allowed_text(key, slot) + (units.empty() ? "" : "; or with a unit: " + units)};
        }
        *place = *converted;
        return std::nullopt;
      },
      slot);
}

std::optional<FieldError> check(const Key& key, const Slot& slot) {
  const bool good = std::visit(
      [&](const auto* place) {
        using T = std::remove_cvref_t<decltype(*place)>;
        if constexpr (std::is_enum_v<T>) {
          return static_cast<std::size_t>(*place) < key.choices.size();
        } else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>) {
          return true;
        } else if constexpr (std::is_same_v<T, std::optional<double>>) {
          return !*place || key.limits.contains(**place);
        } else if constexpr (std::is_same_v<T, std::vector<double>>) {
          return place->size() <= kMostNumbers &&
                 std::ranges::all_of(*place, [&](double number) { return key.limits.contains(number); });
        } else {
          return key.limits.contains(static_cast<long double>(*place));
        }
      },
      slot);
  if (good) return std::nullopt;
  const auto* list = std::get_if<std::vector<double>*>(&slot);
  const bool too_long = list != nullptr && (*list)->size() > kMostNumbers;
  return FieldError{std::string(key.name),
                    too_long ? std::to_string((*list)->size()) + " numbers" : toml_text(load(key, slot)),
                    allowed_text(key, slot)};
}

bool is_left_open(const Slot& slot) {
  const auto* place = std::get_if<std::optional<double>*>(&slot);
  return place != nullptr && !**place;
}

Value load(const Key& key, const Slot& slot) {
  return std::visit(
      [&](const auto* place) -> Value {
        using T = std::remove_cvref_t<decltype(*place)>;
        if constexpr (std::is_enum_v<T>) {
          const auto index = static_cast<std::size_t>(*place);
          return index < key.choices.size() ? std::string(key.choices[index].name)
                                            : "number " + std::to_string(index);
        } else if constexpr (std::is_same_v<T, int>) {
          return std::int64_t{*place};
        } else if constexpr (std::is_same_v<T, std::optional<double>>) {
          return *place ? Value(**place) : Value(std::string(kAuto));
        } else {
          return *place;
        }
      },
      slot);
}

std::string_view type_name(const Slot& slot) {
  return std::visit(
      [](const auto* place) -> std::string_view {
        using T = std::remove_cvref_t<decltype(*place)>;
        if constexpr (std::is_enum_v<T>) return "choice";
        if constexpr (std::is_same_v<T, bool>) return "boolean";
        if constexpr (std::is_same_v<T, std::string>) return "text";
        if constexpr (std::is_same_v<T, std::vector<double>>) return "list of numbers";
        if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>) return "number";
        return "integer";
      },
      slot);
}

std::string allowed_text(const Key& key, const Slot& slot) {
  if (!key.choices.empty()) return choices_text(key.choices);
  if (std::holds_alternative<bool*>(slot)) return "true | false";
  if (std::holds_alternative<std::string*>(slot)) return "a text in quotes";
  if (std::holds_alternative<std::optional<double>*>(slot))
    return toml_string(kAuto) + " or a number " + limits_text(key.limits, key.unit);
  const std::string limits = limits_text(key.limits, key.unit);
  if (std::holds_alternative<std::vector<double>*>(slot))
    return "a list of up to " + std::to_string(kMostNumbers) + " numbers, " + limits;
  const std::string kind = std::holds_alternative<double*>(slot) ? "number" : "integer";
  if (limits != "any") return kind + " " + limits;
  return (std::holds_alternative<std::uint64_t*>(slot) ? "non-negative " : "any ") + kind;
}

std::string toml_number(double value) {
  std::string text = number_text(value);
  // TOML tells a real number by its point or exponent.
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_string(std::string_view text) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted.append(1, '\\').append(1, c);
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted.append("\\u00").append(1, kHex[byte >> 4]).append(1, kHex[byte & 15]);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_key(std::string_view name) {
  constexpr std::string_view kBare = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  const bool bare = !name.empty() && name.find_first_not_of(kBare) == std::string_view::npos;
  return bare ? std::string(name) : toml_string(name);
}

std::string toml_text(const Value& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::remove_cvref_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>) {
          return v ? "true" : "false";
        } else if constexpr (std::is_same_v<T, std::string>) {
          return toml_string(v);
        } else if constexpr (std::is_same_v<T, double>) {
          return toml_number(v);
        } else if constexpr (std::is_same_v<T, std::vector<double>>) {
          std::string text;
          for (const double number : v) text += (text.empty() ? "" : ", ") + toml_number(number);
          return "[" + text + "]";
        } else {
          return std::to_string(v);
        }
      },
      value);
}

}  // namespace obliq
