#pragma once
// Modbus/TCP for the operator's console: a thread that listens, and one for each master.
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/control/sections/modbus.h"
#include "server/net/panel.h"
#include "server/net/tcp.h"

namespace obliq::modbus {

/// The port, taken early so that one in use is known before the terrain is loaded; nothing when Modbus is
/// off. Throws InputError when the address is unknown, the port in use, or the configuration unsafe.
std::optional<net::ReservedPort> reserve(const ModbusConfig& config);

/// A master that takes longer than this to send a request, or to take an answer, is disconnected.
constexpr std::chrono::milliseconds kFrameTime{5000};

/// Serves from construction to destruction, which waits for no master. The panel must outlive it.
class Service {
 public:
  /// Does nothing without a port. Throws InputError when it cannot listen.
  Service(const ModbusConfig& config, std::optional<net::ReservedPort> port, net::Panel& panel,
          std::chrono::milliseconds frame_time = kFrameTime);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  const std::string& address() const;  ///< "127.0.0.1:1502"; empty when Modbus is off
  std::uint16_t port() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::modbus
