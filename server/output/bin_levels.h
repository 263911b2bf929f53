#pragma once
#include <string>
#include <vector>

#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
}

namespace obliq {

/// How bright each bin is. Planes that the frame does not have may be empty.
struct BinLevels {
  std::vector<float> db;  ///< 20 log10 |I&Q|, dB re unit; kNoValue where that is 0
  std::string unit;       ///< as the frame's descriptor says
  bool of_power = false;  ///< 10 log10 of the power, because the frame has no I&Q
  static constexpr float kNoValue = -9999;
};

/// Whether there is something to see in them: I&Q or power.
bool can_be_drawn(const BinBlock& bins);

BinLevels bin_levels(const wire::FrameDescriptor& descriptor, const BinBlock& bins);

/// A bin's BinState; kUnknown where nothing came back and the frame has no states.
std::uint8_t state_of(const BinBlock& bins, const BinLevels& levels, std::size_t bin);
constexpr std::uint8_t kUnknownState = 254;

}  // namespace obliq
