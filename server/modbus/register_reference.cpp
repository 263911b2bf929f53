#include <fmt/core.h>

#include <cmath>

#include "server/control/parameter_reference.h"
#include "server/modbus/encoding.h"
#include "server/modbus/register_map.h"

namespace obliq::modbus {
namespace {

std::string words_text(ModbusWords words) {
  switch (words) {
    case ModbusWords::u16:
      return "u16";
    case ModbusWords::u32:
      return "u32";
    case ModbusWords::i32:
      return "i32";
    case ModbusWords::i64:
      return "i64";
    case ModbusWords::u64:
      return "u64";
    default:
      return "f32";
  }
}

/// What one count is worth: "1e-07 deg".
std::string count_text(double counts_per_unit, std::string_view unit) {
  if (counts_per_unit == 1) return std::string(unit);
  const int exponent = static_cast<int>(std::lround(std::log10(counts_per_unit)));
  return fmt::format("1e-{}{}", exponent, (unit.empty() ? "" : " " + std::string(unit)));
}

std::string name_text(const Setpoint& setpoint) {
  return setpoint.words == ModbusWords::wavelength ? "wavelength of `" + std::string(setpoint.name) + "`"
                                                   : markdown_code(setpoint.name);
}

std::string allowed(const Setpoint& setpoint) {
  if (setpoint.parameter == nullptr) return fmt::format("number 0 to {} Hz", std::lround(kMostRate_hz));
  const Key& key = setpoint.parameter->key;
  if (!key.choices.empty()) {
    std::string text;
    for (std::size_t i = 0; i < key.choices.size(); ++i)
      text += fmt::format("{}{} {}{}", (i == 0 ? "" : ", "), i, key.choices[i].name,
                          key.choices[i].retired ? " (refused)" : "");
    return text;
  }
  RadarConfig any;
  const Slot slot = setpoint.parameter->slot(any);
  if (std::holds_alternative<bool*>(slot)) return "0 no, 1 yes";
  return allowed_text(key, slot);
}

std::string row(int address, int n, const std::string& type, const std::string& count,
                const std::string& name, const std::string& last) {
  const std::string registers =
      n == 1 ? std::to_string(address) : fmt::format("{} to {}", address, address + n - 1);
  return markdown_row({registers, type, count, name, last});
}

std::string status_rows(int from, int to) {
  std::string text;
  for (const StatusRegister& r : status_registers())
    if (r.address >= from && r.address < to)
      text += row(r.address, width(r.words), words_text(r.words), count_text(r.counts_per_unit, r.unit),
                  markdown_code(r.name), std::string(r.summary));
  return text;
}

std::string setpoint_rows() {
  std::string text;
  for (const Setpoint& s : setpoints())
    text += markdown_row({std::to_string(s.address), words_text(s.words),
                          count_text(s.counts_per_unit, s.unit), name_text(s), allowed(s), s.summary});
  return text;
}

std::string bit_row(std::size_t address, const BitText& bit) {
  return markdown_row({std::to_string(address), markdown_code(bit.name), bit.summary});
}

std::string bits() {
  std::string text =
      "\n## Coils\n\nFunctions 01, 05, 15. The coils in one request take effect together or not at all.\n\n| "
      "coil | name | meaning |\n|---|---|---|\n";
  for (std::size_t i = 0; i < coil_texts().size(); ++i) text += bit_row(i, coil_texts()[i]);
  text += "\n## Discrete inputs\n\nFunction 02.\n\n| input | name | meaning |\n|---|---|---|\n";
  for (std::size_t i = 0; i < discrete_inputs().size(); ++i) text += bit_row(i, discrete_inputs()[i].text);
  return text;
}

std::string errors() {
  std::string text =
      "\n## Errors\n\n| exception | when |\n|---|---|\n| 01 | any other function code |\n| 02 | an address "
      "outside this map; a read of a gap alone (across gaps, they are read as 0); a write to a gap or to a "
      "read-only register |\n| 03 | a value out of "
      "limits; staged setpoints that apply cannot put into effect; a malformed request |\n| 06 | apply while "
      "a client of the stream holds what a staged setpoint belongs to, or another apply is in progress; no "
      "answer from the server in "
      "time |\n| 0B | a unit id without a radar, including 0 and 255 |\n\nA refused request changes only "
      "`last_error`, which gives the reason, and `last_error_address`, which gives the setpoint:\n\n| "
      "last_error | meaning |\n|---|---|\n";
  for (const FaultText& fault : fault_texts())
    text += markdown_row({std::to_string(static_cast<int>(fault.fault)), fault.text});
  return text;
}

constexpr auto kIntroduction =
    "# Modbus registers\n\nWritten by `cmake --build --preset release --target generated` from the tables "
    "in `register_map.cpp` and `server/control/sections/`; do not edit.\n\n`[modbus] enabled = true` makes "
    "obliqd a "
    "Modbus/TCP "
    "slave, by default on 127.0.0.1:1502. Unit id 1 is the first radar\nof the scene file, 2 the second, and "
    "so on. Addresses below are those in the frame, counted from 0: a master that\ncounts from 1 adds 1, or "
    "40001 for holding and 30001 for input registers. The functions are 01 to 06, 15, 16, 22 and 23.\nA "
    "value of several registers has its most significant word first (\"ABCD\"); f32 is IEEE 754.\n\nModbus "
    "has no protection of its own: any master that reaches the port can set everything. An address other "
    "than loopback\nneeds `modbus.unprotected = true` and a list of permitted addresses in `modbus.allow`. "
    "At most 8 masters can connect at a time.\n\n## How to set something\n\n1. Write setpoints into holding "
    "registers, in any order, in any number of requests. They are *staged*: the radar does not see them yet. "
    "A\n   value outside its limits is refused at once (03), with everything in the same request. A request "
    "may write half of a\n   value; apply checks it.\n2. Write 1 to the coil `apply`. All staged setpoints "
    "take effect between two frames, or none does.\n\nHolding registers show the staged value of a setpoint, "
    "or the value in effect if none is staged; input registers always\nshow the value in effect. A setpoint "
    "that was not written keeps its full precision, even where its registers cannot show\nit. All masters "
    "share the staged setpoints of a unit. After a refused apply they stay staged: correct them and "
    "apply\nagain, or `discard` them.\n\nWhat a client of the stream holds, apply is refused "
    "(06): its pose (a host that flies it, `flown`), or its settings with rate,\nbearing and tilt "
    "(`controlled`). "
    "So a host may fly the radar while the console turns its knobs; `antenna.bearing_deg` then counts from "
    "the\nplatform's heading. A radar that rides on a platform refuses the antenna's other setpoints (03): "
    "its pose is the "
    "platform's.\nTransmit, freeze, clear_faults, reset and exercise_freeze belong to the "
    "operator and always work.\nWhere \"auto\" is allowed it is the count -2147483648.\n\nA "
    "*frozen* "
    "radar goes on sending frames with the pose and settings of the moment when it was frozen. Settings from "
    "clients\nand from apply are checked and kept meanwhile, and take effect when freeze ends. With "
    "*transmit off* a radar is not\nrendered: its watchers stay, and the frame in progress is aborted. "
    "`GetRadar` and `GetStatus` report both.\n\n*Heartbeats*: `heartbeat` rises while the server runs. When "
    "a console has written a changing number to holding register\n300 and then stops for "
    "`modbus.watchdog_s`, its radar is frozen. Only clear_faults and freeze = 0 undo that. The "
    "watchdog\nstarts with the first heartbeat; `modbus.watchdog_s = 0` turns it off.\n\n## "
    "Identity\n\nFunctions 03 and 04. Status is in input registers and, for masters that read only holding "
    "registers, at the same\naddresses there, read-only.\n\n";

constexpr auto kStatusHeader = "| registers | type | count | name | meaning |\n|---|---|---|---|---|\n";

}  // namespace

std::string registers_markdown() {
  return kIntroduction + std::string(kStatusHeader) + status_rows(0, 100) +
         row(kNameAddress, kNameRegisters, "ASCII", "", "`name`",
             "The radar's name, two characters per register, the first in the high byte, padded with "
             "zeros.") +
         "\n## Status\n\n" + kStatusHeader + status_rows(100, 200) +
         "\n## Setpoints\n\nLimits are in units, not in counts, and are the same as in "
         "`server/control/PARAMETERS.md`.\n\n| register | type | count | name | allowed | meaning "
         "|\n|---|---|---|---|---|---|\n" +
         setpoint_rows() + "\n## Console\n\n" + kStatusHeader +
         row(kConsoleHeartbeat, 1, "u16", "", "`console_heartbeat`",
             "Each change feeds the watchdog. Not a setpoint: it needs no apply.") +
         bits() + errors();
}

}  // namespace obliq::modbus
