#pragma once
#include <string>

namespace obliq::modbus {

/// The page server/modbus/REGISTERS.md.
std::string registers_markdown();

}  // namespace obliq::modbus
