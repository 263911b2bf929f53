#include "server/modbus/register_map.h"

#include <algorithm>
#include <array>

#include "server/modbus/encoding.h"

namespace obliq::modbus {
namespace {

using enum ModbusWords;
using View = StatusView;

template <class Integer>
double number(Integer value) {
  return static_cast<double>(value);
}

/// "OBLQ", as the stream has it (proto/PROTOCOL.md).
constexpr double kMagic = 0x4F424C51;

const std::array kStatus{
    StatusRegister{0, u32, 1, "magic", "", "4F42 4C51, \"OBLQ\": this is obliqd.",
                   [](const View&) { return kMagic; }},
    StatusRegister{2, u16, 1, "map_version", "",
                   "1. With any other value the registers below may mean something else.",
                   [](const View&) { return number(kMapVersion); }},
    StatusRegister{3, u16, 1, "radars", "", "Radars of this server: unit ids 1 to this.",
                   [](const View& v) { return number(v.unit.radars); }},
    StatusRegister{4, u16, 1, "unit_id", "", "The unit id of this request.",
                   [](const View& v) { return number(v.unit.unit_id); }},
    StatusRegister{5, u16, 1, "heartbeat", "",
                   "Rises about ten times a second and wraps from 65535 to 0; stops when the server stops.",
                   [](const View& v) { return number(v.radar.heartbeat & 0xFFFF); }},
    StatusRegister{100, u16, 1, "state", "",
                   "0 idle (no watchers), 1 running, 2 transmit off, 3 frozen, 4 fault.",
                   [](const View& v) { return number(state_of(v)); }},
    StatusRegister{101, u16, 100, "frame_rate", "Hz", "Frames rendered in the last second.",
                   [](const View& v) { return v.radar.rate_hz; }},
    StatusRegister{102, u32, 1e6, "frame_time", "s", "Rendering time of the newest frame.",
                   [](const View& v) { return v.radar.frame_time_s; }},
    StatusRegister{104, u32, 1, "rays", "", "Rays of the newest frame; the sweep has none.",
                   [](const View& v) { return number(v.radar.rays); }},
    StatusRegister{106, u32, 1, "hits", "", "Rays of the newest frame that hit something.",
                   [](const View& v) { return number(v.radar.hits); }},
    StatusRegister{108, u16, 1, "clients", "", "Clients of the server.",
                   [](const View& v) { return number(v.radar.clients); }},
    StatusRegister{109, u16, 1, "watchers", "", "Clients that watch this radar.",
                   [](const View& v) { return number(v.radar.watchers); }},
    StatusRegister{110, u32, 1, "frames_dropped", "",
                   "Frames dropped since start because clients were too slow.",
                   [](const View& v) { return number(v.radar.frames_dropped); }},
    StatusRegister{112, u16, 1e4, "coverage", "",
                   "Share of the newest frame's sector and range with known ground, 0 to 1.",
                   [](const View& v) { return v.radar.coverage; }},
    StatusRegister{113, u16, 1, "last_error", "", "See Errors; clear_faults sets it to 0.",
                   [](const View& v) { return number(static_cast<int>(last_error_of(v))); }},
    StatusRegister{114, u16, 1, "last_error_address", "",
                   "First register of the refused setpoint; 65535: no particular one.",
                   [](const View& v) { return number(v.unit.last_error_address); }},
    StatusRegister{115, u16, 1, "staged", "", "Setpoints written and not yet applied.",
                   [](const View& v) { return number(v.unit.staged); }},
    StatusRegister{116, u32, 1, "frames", "", "Frames rendered since start.",
                   [](const View& v) { return number(v.radar.frames & 0xFFFFFFFF); }},
    StatusRegister{118, u32, 1, "settings_version", "", "Rises with each change of the radar's settings.",
                   [](const View& v) { return number(v.radar.settings_version & 0xFFFFFFFF); }},
    StatusRegister{120, u32, 1, "uptime", "s", "Time since the server started.",
                   [](const View& v) { return v.radar.uptime_s; }},
};

constexpr std::array kFaults{
    FaultText{Fault::none, "none"},
    FaultText{Fault::out_of_range, "a setpoint was written with a value out of its limits"},
    FaultText{Fault::refused, "apply: the staged setpoints do not fit each other or the terrain"},
    FaultText{Fault::controlled, "apply: a client of the stream holds what a staged setpoint belongs to"},
    FaultText{Fault::no_answer, "apply or a coil: the server did not act on it within a second"},
    FaultText{Fault::cannot_render, "the radar cannot be rendered with its present settings"},
    FaultText{Fault::watchdog, "the console's heartbeat stopped and the radar was frozen"},
    FaultText{Fault::max_bins, "apply: the frame would have more bins than `server.max_bins`", "max_bins"},
    FaultText{Fault::max_pixels, "apply: the frame would have more pixels than `server.max_pixels`",
              "max_pixels"},
    FaultText{Fault::max_memory_mb, "apply: the frame would take more memory than `server.max_memory_mb`",
              "max_memory_mb"},
    FaultText{Fault::max_plan_taps,
              "apply: the plan of the frame's beam would have more weights than `server.max_plan_taps`",
              "max_plan_taps"},
};

constexpr std::array kCoilTexts{
    BitText{"transmit", "1: the radar is rendered. 0: it is not, and its watchers get no frames."},
    BitText{
        "freeze",
        "1: frames keep the pose and settings of this moment; later changes show when freeze returns to 0."},
    BitText{"apply", "Write 1 to put all staged setpoints into effect, or none. Reads 0."},
    BitText{"clear_faults", "Write 1 to set last_error to 0 and to retry a radar in fault. Reads 0."},
    BitText{"discard", "Write 1 to discard the staged setpoints. Reads 0."},
    BitText{"reset",
            "Write 1 to put the radar back to the settings, the pose and the switches of the scene file. "
            "Reads 0."},
    BitText{"exercise_freeze",
            "1: all radars of the server stand still, clock, antenna and noise, until it returns to 0."},
};
static_assert(kCoilTexts.size() == kCoils);

const std::array kDiscrete{
    DiscreteInput{{"ready", "The radar can be rendered and is not in fault."},
                  [](const View& v) { return state_of(v) != 4; }},
    DiscreteInput{
        {"fault", "The radar cannot be rendered with its present settings, or the watchdog has frozen it."},
        [](const View& v) { return state_of(v) == 4; }},
    DiscreteInput{{"stale_pose", "The pose is older than its stated validity."},
                  [](const View& v) { return v.radar.pose_stale; }},
    DiscreteInput{{"transmitting", "Same as the coil."}, [](const View& v) { return v.radar.transmit; }},
    DiscreteInput{{"frozen", "Frozen by the coil or by the watchdog."},
                  [](const View& v) { return v.radar.frozen; }},
    DiscreteInput{{"watchdog_tripped", "The console's heartbeat stopped; clear_faults resets this."},
                  [](const View& v) { return v.unit.watchdog_tripped; }},
    DiscreteInput{{"controlled",
                   "A client of the stream holds the settings; apply of a setpoint that is one, of the rate, "
                   "of bearing or tilt returns busy (06)."},
                  [](const View& v) { return !v.radar.settings_controller.empty(); }},
    DiscreteInput{{"staged", "Setpoints are written and not yet applied."},
                  [](const View& v) { return v.unit.staged > 0; }},
    DiscreteInput{
        {"flown",
         "A client of the stream holds the pose; apply of the antenna's other setpoints returns busy "
         "(06), and a bearing counts from the platform's heading."},
        [](const View& v) { return !v.radar.controller.empty(); }},
    DiscreteInput{{"gimbal_limit", "The antenna stands at its gimbal's limit, short of what is asked."},
                  [](const View& v) { return v.radar.at_gimbal_limit; }},
};

const Setpoint kRate{230,    u16,
                     100,    "rate_limit_hz",
                     "Hz",   "Most frames per second, whatever the watchers ask for; 0: no limit.",
                     nullptr};

}  // namespace

int state_of(const StatusView& view) {
  if (!view.radar.faults.empty() || view.unit.watchdog_tripped) return 4;
  if (!view.radar.transmit) return 2;
  if (view.radar.frozen) return 3;
  return view.radar.watchers > 0 ? 1 : 0;
}

Fault last_error_of(const StatusView& view) {
  if (view.unit.last_error != Fault::none) return view.unit.last_error;
  return view.radar.faults.empty() ? Fault::none : Fault::cannot_render;
}

Fault fault_of_limit(std::string_view limit) {
  const auto at = std::ranges::find(kFaults, limit, &FaultText::limit);
  return at == kFaults.end() || limit.empty() ? Fault::refused : at->fault;
}

std::span<const FaultText> fault_texts() { return kFaults; }
std::span<const StatusRegister> status_registers() { return kStatus; }
std::span<const BitText> coil_texts() { return kCoilTexts; }
std::span<const DiscreteInput> discrete_inputs() { return kDiscrete; }

std::span<const Setpoint> setpoints() {
  static const auto all = [] {
    std::vector<Setpoint> list{kRate};
    for (const Parameter& p : parameters()) {
      if (p.modbus.address < 0) continue;
      const bool wavelength = p.modbus.words == ModbusWords::wavelength;
      list.push_back({p.modbus.address, p.modbus.words, p.modbus.counts_per_unit, p.key.name,
                      wavelength ? "m" : p.key.unit, p.key.summary, &p});
    }
    std::ranges::sort(list, {}, &Setpoint::address);
    return list;
  }();
  return all;
}

const Setpoint* setpoint_at(int address) {
  for (const Setpoint& setpoint : setpoints())
    if (address >= setpoint.address && address < setpoint.address + width(setpoint.words)) return &setpoint;
  return nullptr;
}

std::vector<std::uint16_t> encode(const Setpoint& setpoint, const net::PanelStatus& radar) {
  if (setpoint.parameter != nullptr) return encode(*setpoint.parameter, radar.config);
  return encode_number(radar.rate_limit_hz, setpoint.words, setpoint.counts_per_unit);
}

bool decode(const Setpoint& setpoint, std::span<const std::uint16_t> words, net::PanelChange& change) {
  if (setpoint.parameter == nullptr) {
    const double rate_hz = words[0] / setpoint.counts_per_unit;
    change.rate_limit_hz = rate_hz;
    return rate_hz <= kMostRate_hz;  // a server may allow less, and says so to apply
  }
  auto value = decode(*setpoint.parameter, words);
  if (!value) return false;
  change.settings.push_back({setpoint.parameter, std::move(*value)});
  return true;
}

}  // namespace obliq::modbus
