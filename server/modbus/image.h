#pragma once
// The register image of all units: what consoles have staged, and what they are shown.
#include <array>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <vector>

#include "server/modbus/register_map.h"
#include "server/modbus/request.h"

namespace obliq::modbus {

/// A unit's registers and bits as they are at one moment.
struct Registers {
  std::array<std::uint16_t, kRegisters> holding{};
  std::array<std::uint16_t, kRegisters> input{};
  std::array<std::uint8_t, 16> coils{};
  std::array<std::uint8_t, 16> discrete{};
};

/// Holding registers hold setpoints as staged, input registers as they are in effect; all else is the same in
/// both. A setpoint that is not staged follows the one in effect, and apply leaves it alone: it keeps all its
/// digits. Safe from any thread. The mutex is never held during a wait for the radars or for a
/// network.
class Image {
 public:
  using Clock = std::chrono::steady_clock;

  /// watchdog_s 0: none.
  Image(net::Panel& panel, double watchdog_s);

  /// Does what a request asks and fills in the registers to answer it from. A request that is refused has
  /// changed nothing but last_error.
  Exception perform(const Request& request, Registers& registers);

  /// Looks after the watchdogs. To be called a few times a second.
  void tick(Clock::time_point now);

 private:
  struct Staged {
    std::array<std::uint16_t, kRegisters> words{};
    std::vector<bool> dirty;  ///< by setpoint
  };
  struct Unit {
    Staged staged;
    UnitFacts facts;
    bool applying = false;
    std::uint16_t beat = 0;  ///< the console's newest
    bool armed = false;      ///< it has begun to beat
    Clock::time_point last_beat;
  };

  Exception write_registers(std::size_t radar, const Request& request);
  Exception write_coils(std::size_t radar, const Request& request);
  Exception change(std::size_t radar, bool apply, net::PanelChange change);
  bool collect(std::size_t radar, Staged& staged, net::PanelChange& change);
  void fill(std::size_t radar, Registers& registers);
  /// Lays what is in effect under what is staged.
  void follow(std::size_t radar, Staged& staged) const;
  static int count(const Staged& staged);

  net::Panel& panel_;
  double watchdog_s_;
  std::mutex mutex_;
  std::vector<Unit> units_;  ///< guarded by mutex_
};

}  // namespace obliq::modbus
