#pragma once
// Complex numbers of 16 bins.
#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq::OBLIQ_ISA {

struct ComplexLanes {
  f32x16 re, im;
};

OBLIQ_INLINE ComplexLanes times(ComplexLanes a, ComplexLanes b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

OBLIQ_INLINE f32x16 power_of(ComplexLanes v) { return v.re * v.re + v.im * v.im; }

/// Real and imaginary parts of 16 bins.
OBLIQ_INLINE ComplexLanes load_iq(const float* iq) {
  float re[kFloatLanes], im[kFloatLanes];
  for (int l = 0; l < kFloatLanes; ++l) {
    re[l] = iq[2 * l];
    im[l] = iq[2 * l + 1];
  }
  return {load_floats(re), load_floats(im)};
}
OBLIQ_INLINE void store_iq(float* iq, ComplexLanes v) {
  float re[kFloatLanes], im[kFloatLanes];
  store(re, v.re);
  store(im, v.im);
  for (int l = 0; l < kFloatLanes; ++l) {
    iq[2 * l] = re[l];
    iq[2 * l + 1] = im[l];
  }
}

}  // namespace obliq::OBLIQ_ISA
