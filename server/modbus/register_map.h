#pragma once
// THE register map: identity and status, setpoints (the modbus column of the parameter table, and the rate),
// coils and discrete inputs. Register numbers are the ones in the frame, counted from 0.
// server/modbus/REGISTERS.md is written from it.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/control/parameters.h"
#include "server/net/panel.h"

namespace obliq::modbus {

/// Raised when a register changes its meaning; new registers in gaps leave it alone.
constexpr std::uint16_t kMapVersion = 1;
/// Registers 0 to this, less one. Most of them are gaps.
constexpr int kRegisters = 512;

/// Why a console's last request was refused, or a radar is not well.
enum class Fault : std::uint16_t {
  none = 0,
  out_of_range = 1,   ///< a setpoint's value, when it was written
  refused = 2,        ///< staged setpoints, by apply: the radar cannot run like that
  controlled = 3,     ///< by a client of the stream
  no_answer = 4,      ///< the server was too busy
  cannot_render = 5,  ///< the radar as it is set
  watchdog = 6,       ///< the console's heartbeat stood still, the radar was frozen
  max_bins = 7,       ///< by apply, as are the next three: a limit of the server
  max_pixels = 8,
  max_memory_mb = 9,
  max_plan_taps = 10
};
struct FaultText {
  Fault fault;
  std::string_view text;
  std::string_view limit{};  ///< of the server, that was exceeded
};
std::span<const FaultText> fault_texts();
/// What apply is refused with when the limit of that name is exceeded.
Fault fault_of_limit(std::string_view limit);

constexpr std::uint16_t kNoAddress = 0xFFFF;

/// What a console itself has brought about on a unit.
struct UnitFacts {
  int unit_id = 1;
  int radars = 1;  ///< of the server
  Fault last_error = Fault::none;
  std::uint16_t last_error_address = kNoAddress;  ///< of the setpoint, if it was one
  int staged = 0;                                 ///< setpoints written and not yet applied
  bool watchdog_tripped = false;

  void tell(Fault error, int address = kNoAddress) {
    last_error = error;
    last_error_address = static_cast<std::uint16_t>(address);
  }
};

struct StatusView {
  const net::PanelStatus& radar;
  const UnitFacts& unit;
};

/// 0 idle (no client watches), 1 running, 2 transmit off, 3 frozen, 4 fault.
int state_of(const StatusView& view);
Fault last_error_of(const StatusView& view);

/// A number in registers that can only be read.
struct StatusRegister {
  int address;
  ModbusWords words;
  double counts_per_unit;
  std::string_view name;
  std::string_view unit;
  std::string_view summary;
  double (*value)(const StatusView&);
};
std::span<const StatusRegister> status_registers();

/// The radar's name, two characters of ASCII in a register, filled up with zeros.
constexpr int kNameAddress = 8;
constexpr int kNameRegisters = 8;

/// A value that a console may set.
struct Setpoint {
  int address;
  ModbusWords words;
  double counts_per_unit;
  std::string_view name;
  std::string_view unit;
  std::string_view summary;
  const Parameter* parameter;  ///< null: the limit of the rate
};
/// By rising address.
std::span<const Setpoint> setpoints();
/// The one that holds the register, or null.
const Setpoint* setpoint_at(int address);

/// As the registers show it now.
std::vector<std::uint16_t> encode(const Setpoint& setpoint, const net::PanelStatus& radar);
/// Puts what the registers say into a change. False when it is out of the setpoint's limits.
bool decode(const Setpoint& setpoint, std::span<const std::uint16_t> words, net::PanelChange& change);

/// Of the limit of the rate.
constexpr double kMostRate_hz = 100;

/// The console's heartbeat: writes of a value other than the last keep the watchdog quiet.
constexpr int kConsoleHeartbeat = 300;

enum Coil { kTransmit, kFreeze, kApply, kClearFaults, kDiscard, kReset, kExerciseFreeze, kCoils };
struct BitText {
  std::string_view name;
  std::string_view summary;
};
/// In the order of their addresses, from 0.
std::span<const BitText> coil_texts();

struct DiscreteInput {
  BitText text;
  bool (*value)(const StatusView&);
};
std::span<const DiscreteInput> discrete_inputs();

/// The page server/modbus/REGISTERS.md.
std::string registers_markdown();

}  // namespace obliq::modbus
