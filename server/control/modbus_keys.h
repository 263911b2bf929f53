#pragma once
#include <span>

#include "server/control/scene_keys.h"

namespace obliq {

class SectionReader;

/// Scalar keys of [modbus].
std::span<const Row<SceneConfig>> modbus_entries();

/// Reads modbus.allow, then looks at the section as a whole: off loopback it needs `unprotected` and a list.
void read_modbus_access(SectionReader& reader, ModbusConfig& config);

}  // namespace obliq
