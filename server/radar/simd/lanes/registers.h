#pragma once
// Numbers that go through the same operations side by side: Lanes<T, n> is as many registers of the
// instruction set as n of them take, halved down to one. The compiler's own vectors do not do: GCC 12 takes
// those that are wider than a register apart into single numbers where two are compared or one of two is
// chosen. Every operation is a plain IEEE one, lane by lane, so that the bits are the same whatever the set.
// Included in files that are compiled once for each set (OBLIQ_ISA), whose namespace the type has: nothing is
// shared between them.
#include <immintrin.h>

#include <cstdint>
#include <type_traits>
#include <utility>

namespace obliq::OBLIQ_ISA {

#if defined(__AVX512F__)
constexpr int kRegisterBytes = 64;
#elif defined(__AVX2__)
constexpr int kRegisterBytes = 32;
#else
constexpr int kRegisterBytes = 16;
#endif

template <typename T, int n, bool one = (sizeof(T) * static_cast<unsigned>(n) <= kRegisterBytes)>
struct Lanes;

/// One register, or a part of one.
template <typename T, int n>
struct Lanes<T, n, true> {
  typedef T Register __attribute__((vector_size(sizeof(T) * n)));
  Register v;

  [[gnu::always_inline]] T operator[](int lane) const { return v[lane]; }
};

/// Several.
template <typename T, int n>
struct Lanes<T, n, false> {
  Lanes<T, n / 2> low, high;

  [[gnu::always_inline]] T operator[](int lane) const {
    if (__builtin_constant_p(lane)) return lane < n / 2 ? low[lane] : high[lane - n / 2];
    T all[sizeof *this / sizeof(T)];
    __builtin_memcpy(all, this, sizeof all);
    return all[lane];
  }
};

template <typename T, int n>
constexpr bool is_one(const Lanes<T, n>*) {
  return sizeof(T) * static_cast<unsigned>(n) <= kRegisterBytes;
}

/// The number itself, of which no type is deduced.
template <typename T>
using Same = std::type_identity_t<T>;

#define OBLIQ_LANES            \
  template <typename T, int n> \
  [[gnu::always_inline]] inline

/// lane(first), lane(first + 1) and so on, for what no instruction does.
template <typename T, int n, typename Lane>
[[gnu::always_inline]] inline Lanes<T, n> lane_by_lane(const Lane& lane, int first = 0) {
  if constexpr (is_one<T, n>(nullptr)) {
    return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
      return Lanes<T, n>{typename Lanes<T, n>::Register{static_cast<T>(lane(first + k))...}};
    }
    (std::make_integer_sequence<int, n>());
  } else {
    return {lane_by_lane<T, n / 2>(lane, first), lane_by_lane<T, n / 2>(lane, first + n / 2)};
  }
}

OBLIQ_LANES Lanes<T, n> every(const Lanes<T, n>* /*type*/, Same<T> value) {
  if constexpr (is_one<T, n>(nullptr)) {
    return lane_by_lane<T, n>([&](int) __attribute__((always_inline)) { return value; });
  } else {
    const auto half = every(static_cast<const Lanes<T, n / 2>*>(nullptr), value);
    return {half, half};
  }
}

#define OBLIQ_OPERATOR(op)                                                                \
  OBLIQ_LANES Lanes<T, n> operator op(Lanes<T, n> a, Lanes<T, n> b) {                     \
    if constexpr (is_one<T, n>(nullptr))                                                  \
      return {a.v op b.v};                                                                \
    else                                                                                  \
      return {a.low op b.low, a.high op b.high};                                          \
  }                                                                                       \
  OBLIQ_LANES Lanes<T, n> operator op(Lanes<T, n> a, Same<T> b) {                         \
    return a op every(static_cast<const Lanes<T, n>*>(nullptr), b);                       \
  }                                                                                       \
  OBLIQ_LANES Lanes<T, n> operator op(Same<T> a, Lanes<T, n> b) {                         \
    return every(static_cast<const Lanes<T, n>*>(nullptr), a) op b;                       \
  }                                                                                       \
  template <typename T, int n, typename B>                                                \
  [[gnu::always_inline]] inline Lanes<T, n>& operator op##=(Lanes<T, n>& a, const B& b) { \
    return a = a op b;                                                                    \
  }

OBLIQ_OPERATOR(+)
OBLIQ_OPERATOR(-)
OBLIQ_OPERATOR(*)
OBLIQ_OPERATOR(/)
OBLIQ_OPERATOR(&)
OBLIQ_OPERATOR(|)
OBLIQ_OPERATOR(^)
#undef OBLIQ_OPERATOR

#define OBLIQ_OF_EACH(name, expression)             \
  OBLIQ_LANES Lanes<T, n> name(Lanes<T, n> a) {     \
    if constexpr (is_one<T, n>(nullptr))            \
      return {expression a.v};                      \
    else                                            \
      return {expression a.low, expression a.high}; \
  }

OBLIQ_OF_EACH(operator-, -)
OBLIQ_OF_EACH(operator~, ~)
#undef OBLIQ_OF_EACH

OBLIQ_LANES Lanes<T, n> operator<<(Lanes<T, n> a, int bits) {
  if constexpr (is_one<T, n>(nullptr))
    return {a.v << bits};
  else
    return {a.low << bits, a.high << bits};
}
OBLIQ_LANES Lanes<T, n> operator>>(Lanes<T, n> a, int bits) {
  if constexpr (is_one<T, n>(nullptr))
    return {a.v >> bits};
  else
    return {a.low >> bits, a.high >> bits};
}

/// Lanes from `first` on, of one register: moved within registers, where a copy of memory would go through
/// it.
template <int first, int n, typename T, int of>
[[gnu::always_inline]] inline Lanes<T, n> some_of(Lanes<T, of> x) {
  return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    return Lanes<T, n>{__builtin_shufflevector(x.v, x.v, (first + k)...)};
  }
  (std::make_integer_sequence<int, n>());
}

OBLIQ_LANES Lanes<T, n / 2> low_half(Lanes<T, n> x) {
  if constexpr (is_one<T, n>(nullptr))
    return some_of<0, n / 2>(x);
  else
    return x.low;
}
OBLIQ_LANES Lanes<T, n / 2> high_half(Lanes<T, n> x) {
  if constexpr (is_one<T, n>(nullptr))
    return some_of<n / 2, n / 2>(x);
  else
    return x.high;
}
OBLIQ_LANES Lanes<T, 2 * n> joined(Lanes<T, n> low, Lanes<T, n> high) {
  if constexpr (is_one<T, 2 * n>(nullptr)) {
    return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
      return Lanes<T, 2 * n>{__builtin_shufflevector(low.v, high.v, k...)};
    }
    (std::make_integer_sequence<int, 2 * n>());
  } else {
    return {low, high};
  }
}

/// Each lane `by` places further on; the first of them stay where they are. Of one register.
template <int by, typename T, int n>
[[gnu::always_inline]] inline Lanes<T, n> moved_on(Lanes<T, n> x) {
  return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    return Lanes<T, n>{__builtin_shufflevector(x.v, x.v, (k < by ? k : k - by)...)};
  }
  (std::make_integer_sequence<int, n>());
}

/// Each lane `by` places further back; the last of them stay where they are. Of one register.
template <int by, typename T, int n>
[[gnu::always_inline]] inline Lanes<T, n> moved_back(Lanes<T, n> x) {
  return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    return Lanes<T, n>{__builtin_shufflevector(x.v, x.v, (k + by < n ? k + by : k)...)};
  }
  (std::make_integer_sequence<int, n>());
}

/// In each `group` of lanes the one that stands `by` places further on, around it. Of one register.
template <int by, int group, typename T, int n>
[[gnu::always_inline]] inline Lanes<T, n> from_within(Lanes<T, n> x) {
  return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    return Lanes<T, n>{__builtin_shufflevector(x.v, x.v, (k / group * group + (k + by) % group)...)};
  }
  (std::make_integer_sequence<int, n>());
}

OBLIQ_LANES Lanes<T, n> from_memory(const Lanes<T, n>* /*type*/, const T* from) {
  Lanes<T, n> lanes;
  if constexpr (is_one<T, n>(nullptr)) {
    __builtin_memcpy(&lanes.v, from, sizeof lanes.v);
  } else {
    lanes.low = from_memory(static_cast<const Lanes<T, n / 2>*>(nullptr), from);
    lanes.high = from_memory(static_cast<const Lanes<T, n / 2>*>(nullptr), from + n / 2);
  }
  return lanes;
}
OBLIQ_LANES void to_memory(T* to, Lanes<T, n> lanes) {
  if constexpr (is_one<T, n>(nullptr)) {
    __builtin_memcpy(to, &lanes.v, sizeof lanes.v);
  } else {
    to_memory(to, lanes.low);
    to_memory(to + n / 2, lanes.high);
  }
}

/// 0, 1, 2 and so on.
template <typename T, int n>
[[gnu::always_inline]] inline Lanes<T, n> lane_numbers() {
  return lane_by_lane<T, n>([](int k) __attribute__((always_inline)) { return k; });
}

/// As numbers of another type.
template <typename To, typename T, int n>
[[gnu::always_inline]] inline Lanes<To, n> converted(Lanes<T, n> x) {
  if constexpr (is_one<T, n>(nullptr) && is_one<To, n>(nullptr))
    return {__builtin_convertvector(x.v, typename Lanes<To, n>::Register)};
  else
    return joined(converted<To>(low_half(x)), converted<To>(high_half(x)));
}

/// The same bits.
template <typename To, typename T, int n>
[[gnu::always_inline]] inline Lanes<To, n> bits_as(Lanes<T, n> x) {
  if constexpr (is_one<T, n>(nullptr))
    return {__builtin_bit_cast(typename Lanes<To, n>::Register, x.v)};
  else
    return {bits_as<To>(x.low), bits_as<To>(x.high)};
}

// What the compiler's vectors have no operator for, of one register.

#define OBLIQ_REGISTER [[gnu::always_inline]] inline
#define OBLIQ_REGISTERS(mm, floats, doubles)                                       \
  OBLIQ_REGISTER floats root(floats x) { return mm##_sqrt_ps(x); }                 \
  OBLIQ_REGISTER doubles root(doubles x) { return mm##_sqrt_pd(x); }               \
  OBLIQ_REGISTER floats least(floats a, floats b) { return mm##_min_ps(b, a); }    \
  OBLIQ_REGISTER doubles least(doubles a, doubles b) { return mm##_min_pd(b, a); } \
  OBLIQ_REGISTER floats greatest(floats a, floats b) { return mm##_max_ps(b, a); } \
  OBLIQ_REGISTER doubles greatest(doubles a, doubles b) { return mm##_max_pd(b, a); }
OBLIQ_REGISTERS(_mm, __m128, __m128d)
#if defined(__AVX2__)
OBLIQ_REGISTERS(_mm256, __m256, __m256d)
#endif
#if defined(__AVX512F__)
OBLIQ_REGISTERS(_mm512, __m512, __m512d)
#endif
#undef OBLIQ_REGISTERS
#undef OBLIQ_REGISTER

/// A register as the intrinsics take it: floats for lanes of 4 bytes, doubles for lanes of 8.
template <int lane_bytes, int bytes>
struct IntrinsicOf;
#define OBLIQ_INTRINSIC(lane_bytes, bytes, register) \
  template <>                                        \
  struct IntrinsicOf<lane_bytes, bytes> {            \
    using type = register;                           \
  }
OBLIQ_INTRINSIC(4, 16, __m128);
OBLIQ_INTRINSIC(8, 16, __m128d);
#if defined(__AVX2__)
OBLIQ_INTRINSIC(4, 32, __m256);
OBLIQ_INTRINSIC(8, 32, __m256d);
#endif
#if defined(__AVX512F__)
OBLIQ_INTRINSIC(4, 64, __m512);
OBLIQ_INTRINSIC(8, 64, __m512d);
#endif
#undef OBLIQ_INTRINSIC
template <typename T, int n>
using Intrinsic = typename IntrinsicOf<sizeof(T), sizeof(T) * n>::type;

OBLIQ_LANES Intrinsic<T, n> intrinsic(Lanes<T, n> x) { return __builtin_bit_cast(Intrinsic<T, n>, x.v); }
template <typename L, typename R>
[[gnu::always_inline]] inline L lanes_from(R x) {
  return {__builtin_bit_cast(typename L::Register, x)};
}

}  // namespace obliq::OBLIQ_ISA
