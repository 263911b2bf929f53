#include "server/radar/simd/receiver/pulse_sums.h"

#include "server/radar/simd/lanes/complex_lanes.h"
#include "server/radar/simd/lanes/exact_math.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// exp(j 2 pi turns[] s) of 16 bins, each reduced in double.
OBLIQ_INLINE ComplexLanes phasors(const double* turns, double s) {
  float re[kFloatLanes], im[kFloatLanes];
  for (int half = 0; half < kFloatLanes; half += kLanes) {
    const SinCosOf<f64x8> at = sincos_turns(load(turns + half) * s);
    to_memory(re + half, converted<float>(at.cos));
    to_memory(im + half, converted<float>(at.sin));
  }
  return {load_floats(re), load_floats(im)};
}

/// Pulses [begin, end) of a row whose phasor is z at the first; gains: of each, or null.
OBLIQ_INLINE void add_pulses(const PulseSum& sum, int begin, int end, ComplexLanes z, ComplexLanes step,
                             const float* gains) {
  float* re = sum.out_re + static_cast<std::size_t>(begin) * sum.stride + sum.first;
  float* im = sum.out_im + static_cast<std::size_t>(begin) * sum.stride + sum.first;
  for (int k = begin; k < end; ++k, re += sum.stride, im += sum.stride) {
    const ComplexLanes x = gains == nullptr ? z : ComplexLanes{z.re * gains[k], z.im * gains[k]};
    store(re, load_floats(re) + x.re);
    store(im, load_floats(im) + x.im);
    z = times(z, step);
  }
}

}  // namespace

void pulse_sum(const PulseSum& sum) {
  for (int r = 0; r < sum.n_rows; ++r) {
    const double* const hz = sum.hz[r] + sum.first;
    const ComplexLanes v{load_floats(sum.re[r] + sum.first), load_floats(sum.im[r] + sum.first)};
    const ComplexLanes step = phasors(hz, sum.step_s);
    const float* const gains = sum.gains[r];
    for (int begin = 0; begin < sum.n_pulses; begin += PulseSum::kRenewed) {
      const ComplexLanes z = times(v, phasors(hz, sum.start_s + begin * sum.step_s));
      const int end = begin + PulseSum::kRenewed < sum.n_pulses ? begin + PulseSum::kRenewed : sum.n_pulses;
      if (sum.has_gain_a_pulse) {
        add_pulses(sum, begin, end, z, step, gains);
      } else {
        add_pulses(sum, begin, end, {z.re * gains[0], z.im * gains[0]}, step, nullptr);
      }
    }
  }
}

void turn_row(const TurnedRow& row) {
  for (int k = 0; k < row.n; k += kFloatLanes) {
    const ComplexLanes z =
        times({load_floats(row.re + k), load_floats(row.im + k)}, phasors(row.turns + k, row.times));
    store(row.re + k, z.re);
    store(row.im + k, z.im);
  }
}

}  // namespace obliq::OBLIQ_ISA
