#pragma once
#include <cstdint>

namespace obliq {

/// What a look makes of a target's mean cross section.
struct Fluctuation {
  double power = 1;        ///< what it is multiplied by, of mean 1
  double phase_turns = 0;  ///< of the voltage, beside that of the way
};

/// What makes looks at targets repeat.
struct TargetDraw {
  std::uint64_t seed = 1;
  std::uint64_t frame = 0;  ///< names the frame, of a scan the pass
  std::uint64_t dwell = 0;  ///< names the dwell within it
  std::uint64_t pulse = 0;  ///< and the pulse within that, from 1 on; 0: all of them
};

/// A hash of its own for each target and look.
std::uint64_t target_key(std::uint64_t seed, std::uint64_t id, std::uint64_t draw);

/// Swerling's cases (Swerling 1960; Skolnik 2008, section 2.7). 0: steady. 1 and 2: exponential, of many
/// scatterers. 3 and 4: chi-square of four degrees of freedom, one large scatterer among many. 1 and 3 stay
/// as they are over a frame or a pass, 2 and 4 over a dwell or a pulse. The phase follows the draws of 2 and
/// 4; that of the others is the target's own.
Fluctuation fluctuation(int swerling, std::uint64_t id, const TargetDraw& draw);

}  // namespace obliq
