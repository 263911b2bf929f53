#include "server/radar/simd/video_levels.h"

#include "server/radar/simd/exact_math.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr double kDb_of_log = 4.3429448190325182765;  // 10 / ln(10)

}  // namespace

// Marsaglia and Tsang, "A simple method for generating gamma variables", ACM TOMS 26 (2000), for a shape of
// at least 1: exact, and one trial in twenty or fewer is thrown away.
void mean_of_looks(const LooksRun& run) {
  const u64x8 lane = lane_numbers<std::uint64_t, kLanes>();
  const double d = run.looks - 1.0 / 3;
  const double c = 1 / __builtin_sqrt(9 * d);
  for (int k = 0; k < run.n; k += kLanes) {
    u64x8 hash = mix_words(run.key ^ (lane + (run.cell + static_cast<std::uint64_t>(k))));
    f64x8 found{};
    mask8 open = lane < 8;
    do {
      // A normal number by Box and Muller; the uniform one from the next hash.
      const SinCosOf<f64x8> at = sincos_turns(turns_of_hash(hash));
      const f64x8 x = sqrt(-2.0 * log_of_positive(uniform_of_hash(hash))) * at.cos;
      hash = mix_words(hash);
      const f64x8 u = uniform_of_hash(hash);
      hash = mix_words(hash ^ run.key);
      const f64x8 root = 1.0 + c * x;
      const mask8 possible = root > 0.0;
      const f64x8 v = select(possible, root * root * root, broadcast(1));
      const f64x8 x2 = x * x;
      mask8 taken = possible & (u < 1.0 - 0.0331 * (x2 * x2));
      if (any(open & possible & inverse(taken)))
        taken = possible & (log_of_positive(u) < 0.5 * x2 + d - d * v + d * log_of_positive(v));
      found = select(open & taken, v * (d / run.looks), found);
      open = open & inverse(taken);
    } while (any(open));
    store(run.mean + k, found);
  }
}

void video_levels(const VideoRun& run) {
  for (int k = 0; k < run.n; k += kLanes) {
    const f64x8 power = load(run.power + k);
    const mask8 some = power > 0.0;
    const f64x8 db = kDb_of_log * log_of_positive(max(power, broadcast(0x1p-1022)));
    const f64x8 steps = clamp(run.steps_a_db * (db - run.floor_db), broadcast(0), broadcast(run.most - 1));
    store_i32(run.level + k, select(some, 1.0 + nearest_integer(steps), broadcast(0)));
  }
}

}  // namespace obliq::OBLIQ_ISA
