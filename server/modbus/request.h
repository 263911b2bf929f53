#pragma once
// A Modbus/TCP request, taken apart before libmodbus sees it. libmodbus 3.1.6 trusts counts more than it
// should, waits half a second over a malformed frame, and writes before the values have been checked.
#include <cstdint>
#include <span>
#include <vector>

namespace obliq::modbus {

/// Of the Modbus application protocol specification V1.1b3, section 7.
enum class Exception : std::uint8_t {
  none = 0,
  illegal_function = 1,
  illegal_address = 2,
  illegal_value = 3,
  busy = 6,
  no_such_unit = 11  ///< gateway target device failed to respond
};

enum class Function : std::uint8_t {
  read_coils = 1,
  read_discrete_inputs = 2,
  read_holding = 3,
  read_input = 4,
  write_coil = 5,
  write_register = 6,
  write_coils = 15,
  write_registers = 16,
  mask_write_register = 22,
  write_and_read_registers = 23
};

struct Span {
  int address = 0;
  int count = 0;
};

struct Request {
  std::uint8_t unit = 0;
  Function function = Function::read_coils;
  Span read;                          ///< count 0: reads nothing
  Span write;                         ///< count 0: writes nothing
  std::vector<std::uint16_t> values;  ///< of registers, or 0 and 1 of coils; write.count of them
  std::uint16_t and_mask = 0;         ///< of mask_write_register, which has no values
  std::uint16_t or_mask = 0;
};

/// Bytes before the length field's count begins, and the longest frame (MODBUS Messaging on TCP/IP
/// V1.0b, 3.1.3).
constexpr std::size_t kHeadBytes = 6;
constexpr std::size_t kMostBytes = 260;
constexpr std::size_t kFunctionAt = 7;  ///< after the unit id

/// Bytes that follow the six of the head, or 0 when these cannot begin a Modbus/TCP frame.
std::size_t bytes_to_come(std::span<const std::uint8_t, kHeadBytes> head);

/// Takes a whole frame apart: MBAP header, unit id, function and data. Every length and count is checked
/// against the specification; addresses are not.
Exception parse(std::span<const std::uint8_t> frame, Request& request);

}  // namespace obliq::modbus
