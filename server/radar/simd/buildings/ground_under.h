#pragma once
// What lanes that lie near each other have below them: the ground's height, and numbers of planes' profiles.
#include <array>

#include "server/radar/simd/buildings/sub_columns.h"
#include "server/radar/simd/lanes/float_windows.h"

namespace obliq::OBLIQ_ISA {

/// plane_of.
template <int n>
OBLIQ_INLINE Numbers<n> planes_of(Numbers<n> number, int planes, int columns) {
  // Whole numbers over 2 n, lifted by less than half of what two of them differ by: no product is rounded to
  // below a whole number that it is.
  const float over = 1 / static_cast<float>(2 * columns);
  return truncated((floats_of((2 * number + 1) * planes) + 0.25F) * over);
}

/// Slant over ground distance.
template <int n>
OBLIQ_INLINE Floats<n> root_of(Floats<n> slope) {
  return sqrt(1.0F + slope * slope);
}

/// Heights above the antenna.
template <int n>
struct Heights {
  Floats<n> h;
  Where<n> known;
};

/// The heights of the corners of cells.
template <int n>
struct Corners {
  Floats<n> y00, y10, y01, y11;
};

template <int n>
OBLIQ_INLINE Corners<n> corners_anywhere(const GroundOfBin& ground, Numbers<n> i, Numbers<n> j) {
  const Numbers<n> at = j * ground.nx + i;
  return {gather(ground.y_m, at), gather(ground.y_m + 1, at), gather(ground.y_m + ground.nx, at),
          gather(ground.y_m + ground.nx + 1, at)};
}

#if defined(__AVX2__)

template <int n>
OBLIQ_INLINE Corners<n> corners_of(const GroundOfBin& ground, Numbers<n> i, Numbers<n> j) {
  constexpr int kRows = 4;
  const int first_i = window_around(i[0], kWindow, ground.nx);
  const int first_j = window_around(j[0], kRows, ground.nz);
  const Numbers<n> at = i - first_i;
  const Numbers<n> row = j - first_j;
  if (ground.nx < kWindow || ground.nz < kRows || !all_up_to(at, kWindow - 2) || !all_up_to(row, kRows - 2))
    return corners_anywhere(ground, i, j);
  const float* const y_m = ground.y_m + static_cast<std::ptrdiff_t>(first_j) * ground.nx + first_i;
  Floats<n> here[kRows], next[kRows];
  for (int k = 0; k < kRows; ++k) {
    const auto window = load_as<Window>(y_m + static_cast<std::ptrdiff_t>(k) * ground.nx);
    here[k] = taken(window, at);
    next[k] = taken(window, at + 1);
  }
  const Where<n> second = row == 1;
  const Where<n> third = row == 2;
  const auto of_row = [&](const Floats<n>* rows) __attribute__((always_inline)) {
    return select(third, rows[2], select(second, rows[1], rows[0]));
  };
  return {of_row(here), of_row(next), of_row(here + 1), of_row(next + 1)};
}

#else

template <int n>
OBLIQ_INLINE Corners<n> corners_of(const GroundOfBin& ground, Numbers<n> i, Numbers<n> j) {
  return corners_anywhere(ground, i, j);
}

#endif

template <int n>
OBLIQ_INLINE Heights<n> heights_at(const GroundOfBin& ground, Floats<n> u, Floats<n> v) {
  const auto last_u = static_cast<float>(ground.nx - 2);
  const auto last_v = static_cast<float>(ground.nz - 2);
  const Numbers<n> i = truncated(min(max(Floats<n>{}, u), in_all<n>(last_u)));
  const Numbers<n> j = truncated(min(max(Floats<n>{}, v), in_all<n>(last_v)));
  const auto [y00, y10, y01, y11] = corners_of(ground, i, j);
  const Floats<n> s = u - floats_of(i);
  const Floats<n> t = v - floats_of(j);
  const Floats<n> lower = y00 + s * (y10 - y00) + t * (y01 - y00);
  const Floats<n> upper = y11 + (1.0F - s) * (y01 - y11) + (1.0F - t) * (y10 - y11);
  const Floats<n> y = select(s + t <= 1.0F, lower, upper);
  return {y - ground.antenna_y_m, (u >= 0.0F) & (v >= 0.0F) & (u <= last_u + 1.0F) & (v <= last_v + 1.0F) &
                                      (y00 + y10 + y01 + y11 == y00 + y10 + y01 + y11)};
}

/// Numbers of planes' profiles between the nodes that lanes lie between.
template <int n>
struct BetweenNodes {
  const NodeProfiles& nodes;
  Numbers<n> plane, k;  ///< planes rise with the lanes
  Floats<n> past;       ///< of the way from node k to the next

  [[gnu::always_inline]] Floats<n> anywhere(const float* values) const {
    const Numbers<n> at = plane * nodes.stride + k;
    const Floats<n> here = gather(values, at);
    return here + past * (gather(values + 1, at) - here);
  }
#if defined(__AVX2__)
  [[gnu::always_inline]] std::array<Floats<n>, 2> of(const float* first, const float* second) const {
    const int plane0 = plane[0];
    const int plane1 = plane[n - 1];
    const int first_k = window_around(k[0], kWindow, nodes.stride);
    const Numbers<n> at = k - first_k;
    if (plane1 - plane0 > 1 || !all_up_to(at, kWindow - 2)) return {anywhere(first), anywhere(second)};
    const auto windowed = [&](const float* values) __attribute__((always_inline)) {
      const float* const from = values + static_cast<std::ptrdiff_t>(plane0) * nodes.stride + first_k;
      auto window = load_as<Window>(from);
      Floats<n> here = taken(window, at);
      Floats<n> next = taken(window, at + 1);
      if (plane1 != plane0) {
        window = load_as<Window>(from + nodes.stride);
        here = select(plane == plane1, taken(window, at), here);
        next = select(plane == plane1, taken(window, at + 1), next);
      }
      return here + past * (next - here);
    };
    return {windowed(first), windowed(second)};
  }
#else
  [[gnu::always_inline]] std::array<Floats<n>, 2> of(const float* first, const float* second) const {
    return {anywhere(first), anywhere(second)};
  }
#endif
};

}  // namespace obliq::OBLIQ_ISA
