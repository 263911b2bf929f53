#pragma once
// Complex numbers of 16 bins.
#include "server/radar/simd/float_lanes.h"

namespace obliq::OBLIQ_ISA {

struct ComplexLanes {
  f32x16 re, im;
};

OBLIQ_INLINE ComplexLanes times(ComplexLanes a, ComplexLanes b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

}  // namespace obliq::OBLIQ_ISA
