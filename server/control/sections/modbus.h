#pragma once
// [modbus]: the operator's console.
#include <string>
#include <vector>

namespace obliq {

struct Section;

/// The operator's console: where the daemon listens for Modbus/TCP masters, and which.
struct ModbusConfig {
  bool enabled = false;
  std::string address = "127.0.0.1";
  int port = 1502;  ///< 0: any free one
  int max_masters = 8;
  double idle_timeout_s = 60;  ///< a master that sends no request for this long is disconnected
  double watchdog_s =
      0;  ///< a radar is frozen after this long without a change of its console's heartbeat; 0: never
  bool unprotected = false;  ///< allows an address other than loopback
  std::vector<std::string>
      allow;  ///< networks ("10.0.0.0/24") or addresses; empty: any that can reach the port
};

extern const Section kModbusSection;

}  // namespace obliq
