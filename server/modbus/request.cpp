#include "server/modbus/request.h"

namespace obliq::modbus {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kUnitAt = 6;
constexpr std::size_t kDataAt = kFunctionAt + 1;

// The most that a request may ask for (V1.1b3, section 6).
constexpr int kMostBitsRead = 2000;
constexpr int kMostBitsWritten = 1968;
constexpr int kMostRegistersRead = 125;
constexpr int kMostRegistersWritten = 123;
constexpr int kMostRegistersWrittenAndRead = 121;

std::uint16_t word(Bytes data, std::size_t at) {
  return static_cast<std::uint16_t>(data[at] << 8 | data[at + 1]);
}

bool read_span(Bytes data, std::size_t at, int most, Span& span) {
  span = {word(data, at), word(data, at + 2)};
  return span.count >= 1 && span.count <= most;
}

/// Data that says its own length: count of bytes, then registers.
bool read_registers(Bytes data, std::size_t at, Request& request) {
  const auto bytes = static_cast<std::size_t>(request.write.count) * 2;
  if (data.size() != at + 1 + bytes || data[at] != bytes) return false;
  for (std::size_t i = 0; i < bytes; i += 2) request.values.push_back(word(data, at + 1 + i));
  return true;
}

bool read_coils(Bytes data, Request& request) {
  const auto count = static_cast<std::size_t>(request.write.count);
  const std::size_t bytes = (count + 7) / 8;
  if (data.size() != 5 + bytes || data[4] != bytes) return false;
  for (std::size_t i = 0; i < count; ++i)
    request.values.push_back(static_cast<std::uint16_t>(data[5 + i / 8] >> (i % 8) & 1));
  return true;
}

bool write_one_coil(Bytes data, Request& request) {
  request.write = {word(data, 0), 1};
  const std::uint16_t value = word(data, 2);
  request.values = {static_cast<std::uint16_t>(value == 0 ? 0 : 1)};
  return value == 0 || value == 0xFF00;
}

bool mask_write(Bytes data, Request& request) {
  if (data.size() != 6) return false;
  request.write = {word(data, 0), 1};
  request.and_mask = word(data, 2);
  request.or_mask = word(data, 4);
  return true;
}

bool is_known(std::uint8_t function) {
  return (function >= 1 && function <= 6) || function == 15 || function == 16 || function == 22 ||
         function == 23;
}

bool parse_data(Bytes data, Request& request) {
  if (data.size() < 4) return false;
  const bool four = data.size() == 4;
  switch (request.function) {
    case Function::read_coils:
    case Function::read_discrete_inputs:
      return four && read_span(data, 0, kMostBitsRead, request.read);
    case Function::read_holding:
    case Function::read_input:
      return four && read_span(data, 0, kMostRegistersRead, request.read);
    case Function::write_coil:
      return four && write_one_coil(data, request);
    case Function::write_register:
      request.write = {word(data, 0), 1};
      request.values = {word(data, 2)};
      return four;
    case Function::write_coils:
      return read_span(data, 0, kMostBitsWritten, request.write) && data.size() > 4 &&
             read_coils(data, request);
    case Function::write_registers:
      return read_span(data, 0, kMostRegistersWritten, request.write) && data.size() > 4 &&
             read_registers(data, 4, request);
    case Function::mask_write_register:
      return mask_write(data, request);
    case Function::write_and_read_registers:
      return data.size() > 8 && read_span(data, 0, kMostRegistersRead, request.read) &&
             read_span(data, 4, kMostRegistersWrittenAndRead, request.write) &&
             read_registers(data, 8, request);
  }
  return false;
}

}  // namespace

std::size_t bytes_to_come(std::span<const std::uint8_t, kHeadBytes> head) {
  const std::uint16_t protocol = word(head, 2);
  const std::size_t length = word(head, 4);
  // At least unit id and function; protocol 0 is Modbus.
  return protocol == 0 && length >= 2 && length <= kMostBytes - kHeadBytes ? length : 0;
}

Exception parse(Bytes frame, Request& request) {
  request = {};
  if (frame.size() < kDataAt) return Exception::illegal_value;
  request.unit = frame[kUnitAt];
  const std::uint8_t function = frame[kFunctionAt];
  if (!is_known(function)) return Exception::illegal_function;
  request.function = static_cast<Function>(function);
  return parse_data(frame.subspan(kDataAt), request) ? Exception::none : Exception::illegal_value;
}

}  // namespace obliq::modbus
