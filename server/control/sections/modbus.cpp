#include "server/control/sections/modbus.h"

#include <array>

#include "server/control/sections/section.h"
#include "server/control/sections/special_values.h"
#include "server/security/networks.h"

namespace obliq {
namespace {

using Modbus = RowsOf<Change::restart, &SceneConfig::modbus>;
constexpr std::array kRows{
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

void read_allow(const FoundKey& found, SceneConfig& config) {
  for (const ConfigNode* node : found.reader.texts(found.name)) {
    const auto& text = std::get<std::string>(node->value);
    if (security::is_network(text)) {
      config.modbus.allow.push_back(text);
    } else {
      found.reader.complain(*node, found.name, "an address or a network, such as \"10.0.0.0/24\"");
    }
  }
}

std::string printed_allow(const SceneConfig& config, const SceneConfig&) {
  const auto& allow = config.modbus.allow;
  return allow.empty() ? "" : toml_list(allow, toml_string);
}

const std::array kSpecial{
    special<SceneConfig>("modbus.allow", "", kAny,
                         "a list of addresses and networks, such as \"10.0.0.0/24\"",
                         "Addresses and networks that may connect to Modbus; empty: any that can reach it.",
                         read_allow, printed_allow, "[]", Change::restart),
};

/// Off loopback it needs `unprotected` and a list.
void check_access(SceneReading& scene, SectionReader& reader) {
  const ModbusConfig& config = scene.config.modbus;
  if (!config.enabled || security::is_loopback_address(config.address)) return;
  const ConfigNode* address = reader.table().find("address");
  if (address != nullptr && (!config.unprotected || config.allow.empty()))
    reader.complain(
        *address, "address",
        "a loopback address; any other only with modbus.unprotected = true and a list of permitted "
        "addresses in modbus.allow, since Modbus has no protection of its own");
}

}  // namespace

const Section kModbusSection{"modbus", {kRows, kSpecial}, check_access, true};

}  // namespace obliq
