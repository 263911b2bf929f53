#include "server/scene/tracer_isa.h"

namespace obliq {

bool has_isa(TracerIsa isa) {
  switch (isa) {
    case TracerIsa::sse42:
      return __builtin_cpu_supports("sse4.2") != 0;
    case TracerIsa::avx:
      return __builtin_cpu_supports("avx") != 0;
    case TracerIsa::avx2:  // Embree's set includes fused multiply-add and the bit manipulations
      return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
             __builtin_cpu_supports("bmi2") != 0;
    case TracerIsa::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
             __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
             __builtin_cpu_supports("avx512vl") != 0;
    case TracerIsa::best:
      break;
  }
  return true;
}

}  // namespace obliq
