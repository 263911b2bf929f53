#include "server/control/modbus_keys.h"

#include <array>

#include "server/control/section_reader.h"
#include "server/security/networks.h"

namespace obliq {
namespace {

using Modbus = RowsOf<&SceneConfig::modbus>;
const std::array kModbus{
    Modbus::row<&ModbusConfig::enabled>("modbus.enabled", "Listen for Modbus/TCP masters."),
    Modbus::row<&ModbusConfig::address>("modbus.address", "Address for Modbus to bind to."),
    Modbus::row<&ModbusConfig::port>("modbus.port", closed(0, 65535),
                                     "TCP port for Modbus; 0: any free one."),
    Modbus::row<&ModbusConfig::max_masters>("modbus.max_masters", closed(1, 8), "Most masters at a time."),
    Modbus::row<&ModbusConfig::idle_timeout_s>(
        "modbus.idle_timeout_s", "s", closed(0.1, 86400),
        "A master that sends no request for this long is disconnected."),
    Modbus::row<&ModbusConfig::watchdog_s>(
        "modbus.watchdog_s", "s", closed(0, 3600),
        "A radar is frozen when its console's heartbeat has not changed for this long; 0: never."),
    Modbus::row<&ModbusConfig::unprotected>(
        "modbus.unprotected", "Allow an address other than loopback: Modbus has no protection of its own."),
};

}  // namespace

std::span<const Row<SceneConfig>> modbus_entries() { return kModbus; }

void read_modbus_access(SectionReader& reader, ModbusConfig& config) {
  for (const ConfigNode* node : reader.texts("allow")) {
    const auto& text = std::get<std::string>(node->value);
    if (is_network(text)) {
      config.allow.push_back(text);
    } else {
      reader.complain(*node, "allow", "an address or a network, such as \"10.0.0.0/24\"");
    }
  }
  if (!config.enabled || is_loopback_address(config.address)) return;
  const ConfigNode* address = reader.table().find("address");
  if (address != nullptr && (!config.unprotected || config.allow.empty())) {
    reader.complain(*address, "address",
                    "a loopback address; any other only with modbus.unprotected = true and a list of who may "
                    "come in modbus.allow, since Modbus has no protection of its own");
  }
}

}  // namespace obliq
