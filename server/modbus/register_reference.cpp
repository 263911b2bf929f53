#include "server/modbus/register_reference.h"

#include <cmath>

#include "server/modbus/encoding.h"
#include "server/modbus/register_map.h"

namespace obliq::modbus {
namespace {

std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return " " + text + " |";
}

std::string code(std::string_view text) { return "`" + std::string(text) + "`"; }

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
  return "1e-" + std::to_string(exponent) + (unit.empty() ? "" : " " + std::string(unit));
}

std::string name_text(const Setpoint& setpoint) {
  return setpoint.words == ModbusWords::wavelength ? "wavelength of `" + std::string(setpoint.name) + "`"
                                                   : code(setpoint.name);
}

std::string allowed(const Setpoint& setpoint) {
  if (setpoint.parameter == nullptr)
    return "number 0 to " + std::to_string(std::lround(kMostRate_hz)) + " Hz";
  const Key& key = setpoint.parameter->key;
  if (!key.choices.empty()) {
    std::string text;
    for (std::size_t i = 0; i < key.choices.size(); ++i)
      text += (i == 0 ? "" : ", ") + std::to_string(i) + " " + std::string(key.choices[i].name);
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
      n == 1 ? std::to_string(address) : std::to_string(address) + " to " + std::to_string(address + n - 1);
  return "|" + cell(registers) + cell(type) + cell(count) + cell(name) + cell(last) + "\n";
}

std::string status_rows(int from, int to) {
  std::string text;
  for (const StatusRegister& r : status_registers())
    if (r.address >= from && r.address < to)
      text += row(r.address, width(r.words), words_text(r.words), count_text(r.counts_per_unit, r.unit),
                  code(r.name), std::string(r.summary));
  return text;
}

std::string setpoint_rows() {
  std::string text;
  for (const Setpoint& s : setpoints())
    text += "|" + cell(std::to_string(s.address)) + cell(words_text(s.words)) +
            cell(count_text(s.counts_per_unit, s.unit)) + cell(name_text(s)) + cell(allowed(s)) +
            cell(std::string(s.summary)) + "\n";
  return text;
}

std::string bit_row(std::size_t address, const BitText& bit) {
  return "|" + cell(std::to_string(address)) + cell(code(bit.name)) + cell(std::string(bit.summary)) + "\n";
}

std::string bits() {
  std::string text =
      "\n## Coils\n\nFunctions 01, 05, 15. Those in one request are done as a whole or not at all.\n\n"
      "| coil | name | meaning |\n|---|---|---|\n";
  for (std::size_t i = 0; i < coil_texts().size(); ++i) text += bit_row(i, coil_texts()[i]);
  text += "\n## Discrete inputs\n\nFunction 02.\n\n| input | name | meaning |\n|---|---|---|\n";
  for (std::size_t i = 0; i < discrete_inputs().size(); ++i) text += bit_row(i, discrete_inputs()[i].text);
  return text;
}

std::string errors() {
  std::string text =
      "\n## Errors\n\n"
      "| exception | when |\n|---|---|\n"
      "| 01 | any other function code |\n"
      "| 02 | an address that is not in this map, a gap among them; a write to a register that can only be "
      "read |\n"
      "| 03 | a value out of limits; staged setpoints that apply cannot put into effect; a malformed request "
      "|\n"
      "| 06 | apply while a client of the stream holds control or another apply is under way; no answer in "
      "time |\n"
      "| 0B | a unit id that is no radar's, 0 and 255 among them |\n\n"
      "A refused request changes nothing but `last_error`, which says why; `last_error_address` says which "
      "setpoint:\n\n| last_error | meaning |\n|---|---|\n";
  for (const FaultText& fault : fault_texts())
    text += "|" + cell(std::to_string(static_cast<int>(fault.fault))) + cell(std::string(fault.text)) + "\n";
  return text;
}

constexpr auto kIntroduction =
    "# Modbus registers\n\n"
    "Written by `obliq parameters --modbus` from the tables in `register_map.cpp` and "
    "`server/control/parameters.cpp`; do not edit.\n\n"
    "`[modbus] enabled = true` makes obliqd a Modbus/TCP slave, on 127.0.0.1:1502 unless told otherwise. "
    "Unit id 1 "
    "is the\nfirst radar of the scene file, 2 the second, and so on. Numbers below are those in the frame, "
    "counted "
    "from 0: a\nmaster that counts from 1 adds 1, or 40001 to holding and 30001 to input registers. "
    "Functions 01 "
    "to 06, 15, 16, 22\nand 23 are understood. A value of several registers has its most significant word "
    "first "
    "(\"ABCD\"); f32 is IEEE 754.\n\n"
    "Modbus has no protection of its own: whoever reaches the port may set everything. Another address than "
    "loopback needs\n`modbus.unprotected = true` and a list of those who may come in `modbus.allow`. At most "
    "8 "
    "masters at a time.\n\n"
    "## How to set something\n\n"
    "1. Write setpoints into holding registers, in any order and any number of requests. They are *staged*: "
    "no "
    "radar sees them. A\n   value out of its limits is refused at once (03), with all that came in the same "
    "request. Half of a value may be\n   written by itself; it is looked at by apply.\n"
    "2. Write 1 to the coil `apply`. All that is staged goes into effect between two frames, or none of "
    "it.\n\n"
    "Holding registers show a setpoint as staged, or, when it is not, as it is in effect; input registers "
    "always as "
    "it is in\neffect. A setpoint that was not written keeps all its digits, also those that its registers "
    "cannot "
    "show. All masters\nshare what is staged for a unit. A refused apply leaves it staged: correct it and "
    "apply "
    "again, or `discard` it.\n\n"
    "While a client of the stream holds control of the radar, apply is refused (06); transmit, freeze and "
    "clear "
    "faults work\nall the same: they are the operator's.\n\n"
    "*Frozen*, a radar goes on sending frames, of the pose and the settings that it was frozen with. What "
    "clients and "
    "apply set\nmeanwhile is checked, kept, and shown from the thaw on. *Transmit off*, it is not rendered; "
    "its "
    "watchers stay, and a\nbegun frame is aborted. Both stand in `GetRadar` and `GetStatus`, too.\n\n"
    "*Heartbeats*: `heartbeat` rises as long as the server lives. A console that writes a changing number to "
    "the "
    "holding\nregister 300, and then leaves it alone for `modbus.watchdog_s`, has its radar frozen. Only "
    "clear faults "
    "and freeze = 0\nundo that. Without a first heartbeat there is no watchdog, and 0 s turns it off.\n\n"
    "## Identity\n\n"
    "Functions 03 and 04: status stands in input registers and, for masters that read nothing else, at the "
    "same "
    "numbers in\nholding registers, where it cannot be written.\n\n";

constexpr auto kStatusHeader = "| registers | type | count | name | meaning |\n|---|---|---|---|---|\n";

}  // namespace

std::string registers_markdown() {
  return kIntroduction + std::string(kStatusHeader) + status_rows(0, 100) +
         row(kNameAddress, kNameRegisters, "ASCII", "", "`name`",
             "The radar's name, two characters in a register, the first one high; zeros fill it up.") +
         "\n## Status\n\n" + kStatusHeader + status_rows(100, 200) +
         "\n## Setpoints\n\nLimits are in the unit, not in counts; they are those of "
         "`server/control/PARAMETERS.md`.\n\n"
         "| register | type | count | name | allowed | meaning |\n|---|---|---|---|---|---|\n" +
         setpoint_rows() + "\n## Console\n\n" + kStatusHeader +
         row(kConsoleHeartbeat, 1, "u16", "", "`console_heartbeat`",
             "Feeds the watchdog by changing. No setpoint: needs no apply.") +
         bits() + errors();
}

}  // namespace obliq::modbus
