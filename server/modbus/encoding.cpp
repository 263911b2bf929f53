#include "server/modbus/encoding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "terrain/base/units.h"

namespace obliq::modbus {
namespace {

/// Speed of light over 1 GHz, m. SI Brochure, 9th edition, 2019: c = 299,792,458 m/s.
constexpr double kWavelengthOfGigahertz_m = kSpeedOfLight_m_s / 1e9;

std::vector<std::uint16_t> split(std::uint64_t bits, int n) {
  std::vector<std::uint16_t> words;
  for (int i = n - 1; i >= 0; --i) words.push_back(static_cast<std::uint16_t>(bits >> (16 * i)));
  return words;
}

std::uint64_t join(std::span<const std::uint16_t> words) {
  std::uint64_t bits = 0;
  for (const std::uint16_t word : words) bits = bits << 16 | word;
  return bits;
}

template <class Integer>
std::uint64_t held(double value) {
  constexpr auto kLow = static_cast<double>(std::numeric_limits<Integer>::min());
  constexpr auto kHigh = static_cast<double>(std::numeric_limits<Integer>::max());
  if (!(value == value)) return 0;
  return static_cast<std::uint64_t>(static_cast<Integer>(std::clamp(std::round(value), kLow, kHigh)));
}

/// What store() takes for the key: whole numbers of integer slots stay whole.
std::optional<Value> number(const Parameter& parameter, double value) {
  if (!parameter.key.limits.contains(value)) return std::nullopt;
  return value;
}

/// As number(), of a value that came as a float: a limit that has no float of its own is met by the nearest
/// one.
std::optional<Value> number_of_float(const Parameter& parameter, double value) {
  constexpr double kStep = std::numeric_limits<float>::epsilon();
  const Limits& limits = parameter.key.limits;
  const double held = std::clamp(value, limits.low, limits.high);
  return number(parameter, std::abs(value - held) <= kStep * std::abs(held) ? held : value);
}

/// What stands in the registers of a number that is left open, far beyond its limits.
constexpr std::int32_t kLeftOpen = std::numeric_limits<std::int32_t>::min();
constexpr auto kAuto = "auto";

bool may_be_open(const Parameter& parameter) {
  RadarConfig any;
  return std::holds_alternative<std::optional<double>*>(parameter.slot(any));
}

bool is_real(const Parameter& parameter) {
  RadarConfig any;
  return std::holds_alternative<double*>(parameter.slot(any)) || may_be_open(parameter);
}

bool is_yes_or_no(const Parameter& parameter) {
  RadarConfig any;
  return std::holds_alternative<bool*>(parameter.slot(any));
}

std::optional<Value> decode_integer(const Parameter& parameter, std::int64_t count) {
  if (count == kLeftOpen && may_be_open(parameter)) return std::string(kAuto);
  const auto index = static_cast<std::uint64_t>(count);
  if (!parameter.key.choices.empty()) {
    if (index >= parameter.key.choices.size() || parameter.key.choices[index].retired) return std::nullopt;
    return std::string(parameter.key.choices[index].name);
  }
  if (is_yes_or_no(parameter))
    return count == 0 || count == 1 ? std::optional<Value>(count == 1) : std::nullopt;
  // A division, not a product with 1e-7, which is no binary number: 351234567 / 1e7 is the double nearest to
  // 35.1234567.
  if (is_real(parameter))
    return number(parameter, static_cast<double>(count) / parameter.modbus.counts_per_unit);
  if (!parameter.key.limits.contains(static_cast<long double>(count))) return std::nullopt;
  return count;
}

}  // namespace

int width(ModbusWords words) {
  switch (words) {
    case ModbusWords::u16:
      return 1;
    case ModbusWords::i64:
    case ModbusWords::u64:
      return 4;
    default:
      return 2;
  }
}

std::vector<std::uint16_t> encode_number(double value, ModbusWords words, double counts_per_unit) {
  const double counts = value * counts_per_unit;
  switch (words) {
    case ModbusWords::u16:
      return split(held<std::uint16_t>(counts), 1);
    case ModbusWords::u32:
      return split(held<std::uint32_t>(counts), 2);
    case ModbusWords::i32:
      return split(held<std::int32_t>(counts), 2);
    case ModbusWords::wavelength:
      return split(std::bit_cast<std::uint32_t>(static_cast<float>(kWavelengthOfGigahertz_m / value)), 2);
    default:
      return split(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 2);
  }
}

std::vector<std::uint16_t> encode(const Parameter& parameter, const RadarConfig& config) {
  const Value value = value_of(parameter, config);
  const ModbusColumn& column = parameter.modbus;
  if (value == Value(kAuto) && may_be_open(parameter))
    return split(static_cast<std::uint32_t>(kLeftOpen), width(column.words));
  if (const auto* name = std::get_if<std::string>(&value)) {
    const auto at = std::ranges::find(parameter.key.choices, *name, &Choice::name);
    return {static_cast<std::uint16_t>(at - parameter.key.choices.begin())};
  }
  if (const auto* yes = std::get_if<bool>(&value)) return {static_cast<std::uint16_t>(*yes ? 1 : 0)};
  if (const auto* real = std::get_if<double>(&value))
    return encode_number(*real, column.words, column.counts_per_unit);
  const std::uint64_t bits = std::holds_alternative<std::uint64_t>(value)
                                 ? std::get<std::uint64_t>(value)
                                 : static_cast<std::uint64_t>(std::get<std::int64_t>(value));
  return split(bits, width(column.words));
}

std::optional<Value> decode(const Parameter& parameter, std::span<const std::uint16_t> words) {
  const std::uint64_t bits = join(words);
  switch (parameter.modbus.words) {
    case ModbusWords::u64:
      return parameter.key.limits.contains(static_cast<long double>(bits)) ? std::optional<Value>(bits)
                                                                           : std::nullopt;
    case ModbusWords::i64:
      return decode_integer(parameter, static_cast<std::int64_t>(bits));
    case ModbusWords::f32:
      return number_of_float(parameter,
                             static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits))));
    case ModbusWords::wavelength:
      return number_of_float(parameter, kWavelengthOfGigahertz_m / static_cast<double>(std::bit_cast<float>(
                                                                       static_cast<std::uint32_t>(bits))));
    case ModbusWords::i32:
      return decode_integer(parameter, static_cast<std::int32_t>(static_cast<std::uint32_t>(bits)));
    default:
      return decode_integer(parameter, static_cast<std::int64_t>(bits));
  }
}

}  // namespace obliq::modbus
