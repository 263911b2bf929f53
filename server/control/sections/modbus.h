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
  double idle_timeout_s = 60;  ///< a master that asks nothing for so long is disconnected
  double watchdog_s = 0;  ///< a radar whose console's heartbeat stands still for so long is frozen; 0: never
  bool unprotected = false;        ///< said by an operator who knows that Modbus has no protection of its own
  std::vector<std::string> allow;  ///< networks ("10.0.0.0/24") or addresses; empty: anybody who gets here
};

extern const Section kModbusSection;

}  // namespace obliq
