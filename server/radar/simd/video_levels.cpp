#include "server/radar/simd/video_levels.h"

#include "server/radar/simd/exact_math.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr double kDb_of_log = 4.3429448190325182765;  // 10 / ln(10)

}  // namespace

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
