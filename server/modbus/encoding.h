#pragma once
// Values in 16-bit registers. The most significant word comes first, always ("ABCD"). Written out here
// because libmodbus 3.1.6 cannot be trusted with it: its modbus_set_float_abcd() of 1.0f gives 803F 0000.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/control/parameters.h"

namespace obliq::modbus {

/// Registers that a value takes.
int width(ModbusWords words);

/// A number as status registers show it: scaled, rounded, and held at the ends of its type.
std::vector<std::uint16_t> encode_number(double value, ModbusWords words, double counts_per_unit);

/// A parameter's value as its registers show it.
std::vector<std::uint16_t> encode(const Parameter& parameter, const RadarConfig& config);

/// What the registers say, fit for store(). Nothing when a choice or a yes-or-no has no such number, or when
/// the value is out of the key's limits. `words` are as many as the parameter has.
std::optional<Value> decode(const Parameter& parameter, std::span<const std::uint16_t> words);

}  // namespace obliq::modbus
