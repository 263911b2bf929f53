#include "server/radar/targets/fluctuation.h"

#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

double exponential(std::uint64_t hash) { return -log_of_positive(uniform_of_hash(hash)); }

}  // namespace

std::uint64_t target_key(std::uint64_t seed, std::uint64_t id, std::uint64_t draw) {
  return mix64(mix64(mix64(seed) ^ id) ^ draw);
}

Fluctuation fluctuation(int swerling, std::uint64_t id, const TargetDraw& draw) {
  const bool by_dwell = swerling == 2 || swerling == 4;
  std::uint64_t look = by_dwell ? mix64(draw.frame) ^ draw.dwell : draw.frame;
  if (by_dwell && draw.pulse != 0) look = mix64(look + draw.pulse);
  const std::uint64_t key = target_key(draw.seed, id, look);
  const std::uint64_t own = by_dwell ? key : target_key(draw.seed, id, 0);
  Fluctuation result;
  result.phase_turns = turns_of_hash(mix64(own + 2));
  if (swerling == 1 || swerling == 2) result.power = exponential(mix64(key));
  if (swerling == 3 || swerling == 4)
    result.power = (exponential(mix64(key)) + exponential(mix64(key + 1))) / 2;
  return result;
}

}  // namespace obliq
