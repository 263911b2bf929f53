#pragma once
// What sub-columns see of a part's walls and roof, as echoes.
#include "server/radar/simd/buildings/ground_under.h"

namespace obliq::OBLIQ_ISA {

/// sin e1 - sin e0 of two elevations by their slopes, roots[k] = sqrt(1 + slope^2): as part_of
/// (range_run.h).
template <int n>
OBLIQ_INLINE Floats<n> sine_step(Floats<n> slope0, Floats<n> root0, Floats<n> slope1, Floats<n> root1) {
  const Floats<n> roots = root0 * root1;
  return (slope1 - slope0) * (root0 + root1) / (roots * (roots + 1.0F + slope0 * slope1));
}

/// A wall or roof as lanes see it: each lane's light spread evenly over a stretch of ranges.
template <int n>
struct SeenFace {
  int edge;
  Floats<n> from, to;  ///< in range bins
  Floats<n> light_sr;  ///< 0: not seen
  float nearest, farthest;

  /// Of the lanes in `seen`, from range r0 to r1.
  OBLIQ_INLINE SeenFace(const SubColumns& columns, Where<n> seen, int of_edge, Floats<n> solid_angle_sr,
                        Floats<n> r0, Floats<n> r1)
      : edge(of_edge) {
    const float bins_per_m = 1 / columns.range_spacing_m;
    const Floats<n> none = in_all<n>(-1e30F);
    from = (min(r0, r1) - columns.r_min_m) * bins_per_m;
    to = (max(r0, r1) - columns.r_min_m) * bins_per_m;
    light_sr = select(seen, solid_angle_sr, Floats<n>{});
    const auto [before, behind] = greatest_of(select(seen, -from, none), select(seen, to, none));
    nearest = -before;
    farthest = behind;
  }

  /// One echo a range bin.
  OBLIQ_INLINE void add_echoes(const SubColumns& columns, Floats<n> tangent, PartEchoes& out) const {
    const auto n_range = static_cast<float>(columns.n_range);
    if (!(farthest >= 0) || !(nearest < n_range)) return;
    const float middle_m = columns.r_min_m + 0.5F * (nearest + farthest) * columns.range_spacing_m;
    const int first = static_cast<int>(nearest < 0 ? 0 : nearest);
    const int last = farthest >= n_range ? columns.n_range - 1 : static_cast<int>(farthest);
    if (first == last && nearest >= 0 && farthest < n_range) {
      const auto [sum, of_tangents] = sums_of(light_sr, light_sr * tangent);
      if (out.n < PartEchoes::kMost) out.echo[out.n++] = {first, edge, sum, middle_m, middle_m, of_tangents};
      return;
    }
    const Floats<n> length = max(to - from, in_all<n>(1e-3F));
    const Floats<n> a_bin = light_sr / length;
    for (int bin = first; bin <= last && out.n < PartEchoes::kMost; ++bin) {
      const auto edge0 = static_cast<float>(bin);
      const auto edge1 = static_cast<float>(bin + 1);
      const Floats<n> light =
          max(min(from + length, in_all<n>(edge1)) - max(from, in_all<n>(edge0)), Floats<n>{}) * a_bin;
      const auto [sum, of_tangents] = sums_of(light, light * tangent);
      const float both = max(nearest, edge0) + min(farthest, edge1);
      if (sum > 0)
        out.echo[out.n++] = {
            bin, edge, sum, columns.r_min_m + 0.5F * both * columns.range_spacing_m, middle_m, of_tangents};
    }
  }
};

}  // namespace obliq::OBLIQ_ISA
