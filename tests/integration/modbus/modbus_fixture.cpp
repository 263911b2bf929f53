#include "tests/integration/modbus/modbus_fixture.h"

#include <chrono>
#include <span>
#include <thread>

namespace obliq::test {
namespace {

void put(Octets& bytes, int word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word & 0xFF));
}

}  // namespace

RawMaster::RawMaster(std::uint16_t port) {
  EXPECT_TRUE(is_ok(client::Socket::connect({"127.0.0.1", port}, kLong, socket_)));
}

void RawMaster::send(const Octets& bytes) { (void)socket_.send(std::as_bytes(std::span(bytes)), kLong).ok(); }

Octets RawMaster::receive() {
  Octets head(6);
  if (!socket_.receive(std::as_writable_bytes(std::span(head)), kLong).ok()) return {};
  Octets rest(static_cast<std::size_t>(head[4] << 8 | head[5]));
  if (!socket_.receive(std::as_writable_bytes(std::span(rest)), kLong).ok()) return {};
  EXPECT_EQ(head[0] << 8 | head[1], transaction_);
  return Octets(rest.begin() + 1, rest.end());
}

Octets frame_of(const Octets& function_and_data, std::uint8_t unit, std::uint16_t transaction) {
  Octets frame;
  put(frame, transaction);
  put(frame, 0);
  put(frame, static_cast<int>(function_and_data.size()) + 1);
  frame.push_back(unit);
  frame.insert(frame.end(), function_and_data.begin(), function_and_data.end());
  return frame;
}

Octets RawMaster::ask(const Octets& function_and_data, std::uint8_t unit) {
  send(frame_of(function_and_data, unit, ++transaction_));
  return receive();
}

int exception_of(const Octets& answer) {
  if (answer.empty()) return -1;
  return (answer[0] & 0x80) != 0 ? answer.at(1) : 0;
}

std::vector<std::uint16_t> RawMaster::read(std::uint8_t function, int address, int count, std::uint8_t unit) {
  Octets request{function};
  put(request, address);
  put(request, count);
  const Octets answer = ask(request, unit);
  EXPECT_EQ(exception_of(answer), 0) << "function " << int{function} << " at " << address;
  std::vector<std::uint16_t> words;
  for (std::size_t i = 2; i + 1 < answer.size(); i += 2)
    words.push_back(static_cast<std::uint16_t>(answer[i] << 8 | answer[i + 1]));
  EXPECT_EQ(words.size(), static_cast<std::size_t>(count));
  words.resize(static_cast<std::size_t>(count));
  return words;
}

int RawMaster::write(int address, const std::vector<std::uint16_t>& values, std::uint8_t unit) {
  Octets request{16};
  put(request, address);
  put(request, static_cast<int>(values.size()));
  request.push_back(static_cast<std::uint8_t>(2 * values.size()));
  for (const std::uint16_t value : values) put(request, value);
  return exception_of(ask(request, unit));
}

int RawMaster::coil(int address, bool on, std::uint8_t unit) {
  Octets request{5};
  put(request, address);
  put(request, on ? 0xFF00 : 0);
  return exception_of(ask(request, unit));
}

bool RawMaster::bit(std::uint8_t function, int address) {
  Octets request{function};
  put(request, address);
  put(request, 1);
  const Octets answer = ask(request);
  EXPECT_EQ(answer.size(), 3u);
  return answer.size() == 3 && answer[2] == 1;
}

bool RawMaster::reaches(int address, std::uint16_t value) {
  const auto end = std::chrono::steady_clock::now() + kLong;
  while (std::chrono::steady_clock::now() < end) {
    if (input(address) == value) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

ModbusConfig modbus_on_any_port() {
  ModbusConfig config;
  config.enabled = true;
  config.port = 0;
  return config;
}

}  // namespace obliq::test
