#pragma once
// A server with the stand-in renderer, its Modbus service, and a master that handles bytes alone.
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "server/modbus/service.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test {

using Octets = std::vector<std::uint8_t>;

/// A connection to the service. Frames are written out as the specification has them.
class RawMaster {
 public:
  explicit RawMaster(std::uint16_t port);

  void send(const Octets& bytes);
  /// One answer from its function code on; empty: the connection has ended.
  Octets receive();
  /// Sends function and data to a unit, in a frame of their own, and receives.
  Octets ask(const Octets& function_and_data, std::uint8_t unit = 1);

  std::vector<std::uint16_t> read(std::uint8_t function, int address, int count, std::uint8_t unit = 1);
  std::uint16_t input(int address, std::uint8_t unit = 1) { return read(4, address, 1, unit).at(0); }
  /// Function 16. The exception, 0 for none.
  int write(int address, const std::vector<std::uint16_t>& values, std::uint8_t unit = 1);
  /// Function 5. The exception, 0 for none.
  int coil(int address, bool on, std::uint8_t unit = 1);
  bool coil_is(int address) { return bit(1, address); }
  bool discrete(int address) { return bit(2, address); }

  /// Polls an input register until it holds the value; gives up after 20 s.
  bool reaches(int address, std::uint16_t value);

 private:
  bool bit(std::uint8_t function, int address);

  client::Socket socket_;
  std::uint16_t transaction_ = 0;
};

/// The exception in an answer, 0 when it is none, -1 when there is no answer.
int exception_of(const Octets& answer);
Octets frame_of(const Octets& function_and_data, std::uint8_t unit = 1, std::uint16_t transaction = 1);

ModbusConfig modbus_on_any_port();

struct ModbusServer {
  explicit ModbusServer(const ModbusConfig& config = modbus_on_any_port(),
                        const net::ServerOptions& options = small_options())
      : server(options), service(config, modbus::reserve(config), server.panel()) {}

  TestServer server;
  modbus::Service service;
};

}  // namespace obliq::test
