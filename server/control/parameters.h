#pragma once
// THE table of radar parameters. Scene file, environment, flags and messages are read through it; validation,
// --print-config and the reference page come from it. A field of RadarSettings or PoseSettings that is not
// in it cannot be set at all (a test counts them).
#include <span>
#include <string_view>
#include <vector>

#include "server/control/key.h"
#include "server/control/sections/radar.h"

namespace obliq {

enum class WireMessage { radar_settings, pose };

/// How a value is coded in Modbus registers, the most significant word first.
enum class ModbusWords {
  u16,        ///< one register; of a choice: its place in the list; of a boolean: 0 or 1
  u32,        ///< two registers
  i32,        ///< two registers, two's complement
  i64,        ///< four registers, two's complement
  u64,        ///< four registers
  f32,        ///< two registers, IEEE 754
  wavelength  ///< as f32, in metres, of a parameter that is a frequency in GHz
};

/// A place in the Modbus register map (server/modbus/REGISTERS.md). Free ones: ADD_A_PARAMETER.md.
struct ModbusColumn {
  int address = -1;  ///< of the first register; -1: not in the map
  ModbusWords words = ModbusWords::u16;
  double counts_per_unit = 1;  ///< of integers: 1000 for a length in mm
};

/// What a parameter means, beside its value, to those that show a radar or its bins.
struct Meaning {
  std::string_view knob = {};   ///< its name among what an operator turns; empty: not there
  std::string_view modes = {};  ///< words of radar.mode that it matters to, "mti dbs"; empty: all
  bool of_programs = false;     ///< goes with each pose that a program sends: nothing for a form
  bool not_ideal = false;       ///< other than by default the bins are more than an ideal map's echoes
  bool aim = false;  ///< where the antenna looks from its platform: an operator's, though of a pose
};

struct Parameter {
  Key key;
  Change change;
  WireMessage message;          ///< which message carries it,
  std::string_view wire_field;  ///< and in which field
  ModbusColumn modbus;
  Slot (*slot)(RadarConfig&);
  Meaning meaning;

  std::string message_field() const;  ///< "RadarSettings.r_max_m"
};

/// Every parameter once, in the order of the reference page.
std::span<const Parameter> parameters();

/// The parameter of that name, or null.
const Parameter* find_parameter(std::string_view name);

/// A second name that files, variables and flags may use of a parameter.
struct KeyAlias {
  std::string_view alias;
  std::string_view name;
};
inline constexpr KeyAlias kKeyAliases[] = {{"radar.polarisation", "atmosphere.polarisation"}};

/// What both names allow where they are given together with other values.
inline constexpr std::string_view kOneOfTwoNames = "one of them: they are two names of one setting";

/// The parameter's value in a configuration.
Value value_of(const Parameter& parameter, RadarConfig config);

/// Every reason why a radar cannot run like this, empty if it can: limits, NaN and infinity, and how the
/// fields fit each other. What depends on the scene is plan_frame's and place_antenna's to say.
std::vector<FieldError> validate(const RadarConfig& config);
std::vector<FieldError> validate(const RadarSettings& settings);
std::vector<FieldError> validate(const PoseSettings& pose);

}  // namespace obliq
