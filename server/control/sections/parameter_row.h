#pragma once
// How the tables of parameters are written.
#include <array>
#include <span>
#include <string_view>
#include <type_traits>

#include "server/control/parameters.h"
#include "server/control/row.h"

namespace obliq {

/// The row of a member of RadarSettings, of one of its parts or of PoseSettings: what it accepts, the field
/// of its message, its place in the Modbus map, its sentence, what it means to others.
template <auto member, auto... inner>
Parameter parameter(std::string_view name, std::string_view unit, Accepts accepts, std::string_view field,
                    ModbusColumn modbus, std::string_view summary, Meaning meaning = {}) {
  constexpr bool of_pose = std::is_same_v<decltype(owner_of(member)), PoseSettings>;
  return {{name, unit, accepts.limits, accepts.choices, summary},
          Change::live,
          of_pose ? WireMessage::pose : WireMessage::radar_settings,
          field,
          modbus,
          [](RadarConfig& radar) -> Slot {
            if constexpr (of_pose)
              return &(radar.pose.*member);
            else
              return &((radar.settings.*member).*....*inner);
          },
          meaning};
}

/// Of antennas and targets.
inline constexpr std::array kHeightReferences{Choice{"datum", "DATUM"}, Choice{"ground", "GROUND"},
                                              Choice{"ellipsoid", "ELLIPSOID"}};

inline constexpr std::array kPolarisations{Choice{"horizontal", "HORIZONTAL"},
                                           Choice{"vertical", "VERTICAL"}};

/// The rows of [beam] and [pulse].
std::span<const Parameter> beam_parameters();
/// The rows of [receiver], [video] and [atmosphere].
std::span<const Parameter> receiver_parameters();

}  // namespace obliq
