#pragma once
#include <type_traits>

namespace obliq {

/// One of two numbers. Templates that work on one number and on eight side by side call it instead of `?:`,
/// which does not take the eight (server/radar/simd/lanes/lanes.h).
template <typename Real>
requires std::is_arithmetic_v<Real>
[[gnu::always_inline]] constexpr Real select(bool where, Real yes, Real no) { return where ? yes : no; }

}  // namespace obliq
