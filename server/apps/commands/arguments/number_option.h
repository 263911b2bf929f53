#pragma once
// Checks of options that are numbers. CLI11 converts them as the C library does: -1 becomes 2^64 - 1, nan is
// within any range. These look at the text first, and refuse with what was found and what is allowed.
#include <cstdint>

namespace CLI {
class Validator;
}

namespace obliq {

CLI::Validator whole_number_from(std::uint64_t least, std::uint64_t most);
CLI::Validator number_from(double least, double most);

/// Of frames or samplings, where 0 is without end.
CLI::Validator a_count();
/// Frames a second: what a server may be asked for.
CLI::Validator a_rate();

}  // namespace obliq
