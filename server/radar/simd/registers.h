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
    T all[n];
    __builtin_memcpy(all, this, sizeof all);
    return all[lane];
  }
};

template <typename T, int n>
constexpr bool is_one(const Lanes<T, n>*) {
  return sizeof(T) * static_cast<unsigned>(n) <= kRegisterBytes;
}

/// All bits of a lane set, or none.
template <typename T>
using MaskOf = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;

/// The number itself, of which no type is deduced.
template <typename T>
using Same = std::type_identity_t<T>;

#define OBLIQ_LANES            \
  template <typename T, int n> \
  [[gnu::always_inline]] inline

OBLIQ_LANES Lanes<T, n> every(const Lanes<T, n>* /*type*/, Same<T> value) {
  if constexpr (is_one<T, n>(nullptr)) {
    return {typename Lanes<T, n>::Register{} + value};
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

#define OBLIQ_COMPARISON(op)                                                  \
  OBLIQ_LANES Lanes<MaskOf<T>, n> operator op(Lanes<T, n> a, Lanes<T, n> b) { \
    if constexpr (is_one<T, n>(nullptr))                                      \
      return {a.v op b.v};                                                    \
    else                                                                      \
      return {a.low op b.low, a.high op b.high};                              \
  }                                                                           \
  OBLIQ_LANES Lanes<MaskOf<T>, n> operator op(Lanes<T, n> a, Same<T> b) {     \
    return a op every(static_cast<const Lanes<T, n>*>(nullptr), b);           \
  }                                                                           \
  OBLIQ_LANES Lanes<MaskOf<T>, n> operator op(Same<T> a, Lanes<T, n> b) {     \
    return every(static_cast<const Lanes<T, n>*>(nullptr), a) op b;           \
  }

OBLIQ_COMPARISON(<)
OBLIQ_COMPARISON(>)
OBLIQ_COMPARISON(<=)
OBLIQ_COMPARISON(>=)
OBLIQ_COMPARISON(==)
OBLIQ_COMPARISON(!=)
#undef OBLIQ_COMPARISON

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

OBLIQ_LANES Lanes<T, n / 2> low_half(Lanes<T, n> x) {
  if constexpr (is_one<T, n>(nullptr)) {
    Lanes<T, n / 2> half;
    __builtin_memcpy(&half, &x, sizeof half);
    return half;
  } else {
    return x.low;
  }
}
OBLIQ_LANES Lanes<T, n / 2> high_half(Lanes<T, n> x) {
  if constexpr (is_one<T, n>(nullptr)) {
    Lanes<T, n / 2> half;
    __builtin_memcpy(&half, reinterpret_cast<const char*>(&x) + sizeof half, sizeof half);
    return half;
  } else {
    return x.high;
  }
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

// What the compiler's vectors have no operator for, of one register. In 64 bytes comparing and choosing are
// single instructions, with operators.

#define OBLIQ_REGISTER [[gnu::always_inline]] inline
#define OBLIQ_REGISTERS(mm, floats, doubles)                                                               \
  OBLIQ_REGISTER floats root(floats x) { return mm##_sqrt_ps(x); }                                         \
  OBLIQ_REGISTER doubles root(doubles x) { return mm##_sqrt_pd(x); }                                       \
  OBLIQ_REGISTER floats least(floats a, floats b) { return mm##_min_ps(b, a); }                            \
  OBLIQ_REGISTER doubles least(doubles a, doubles b) { return mm##_min_pd(b, a); }                         \
  OBLIQ_REGISTER floats greatest(floats a, floats b) { return mm##_max_ps(b, a); }                         \
  OBLIQ_REGISTER doubles greatest(doubles a, doubles b) { return mm##_max_pd(b, a); }                      \
  OBLIQ_REGISTER floats chosen(floats c, floats yes, floats no) { return mm##_blendv_ps(no, yes, c); }     \
  OBLIQ_REGISTER doubles chosen(doubles c, doubles yes, doubles no) { return mm##_blendv_pd(no, yes, c); } \
  OBLIQ_REGISTER unsigned bits(floats mask) { return static_cast<unsigned>(mm##_movemask_ps(mask)); }      \
  OBLIQ_REGISTER unsigned bits(doubles mask) { return static_cast<unsigned>(mm##_movemask_pd(mask)); }
OBLIQ_REGISTERS(_mm, __m128, __m128d)
#if defined(__AVX2__)
OBLIQ_REGISTERS(_mm256, __m256, __m256d)
#endif
#if defined(__AVX512F__)
OBLIQ_REGISTER __m512 root(__m512 x) { return _mm512_sqrt_ps(x); }
OBLIQ_REGISTER __m512d root(__m512d x) { return _mm512_sqrt_pd(x); }
OBLIQ_REGISTER __m512 least(__m512 a, __m512 b) { return b < a ? b : a; }
OBLIQ_REGISTER __m512d least(__m512d a, __m512d b) { return b < a ? b : a; }
OBLIQ_REGISTER __m512 greatest(__m512 a, __m512 b) { return a < b ? b : a; }
OBLIQ_REGISTER __m512d greatest(__m512d a, __m512d b) { return a < b ? b : a; }
OBLIQ_REGISTER unsigned bits(__m512 mask) { return _mm512_movepi32_mask(_mm512_castps_si512(mask)); }
OBLIQ_REGISTER unsigned bits(__m512d mask) { return _mm512_movepi64_mask(_mm512_castpd_si512(mask)); }
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

/// For templates of other rooms, which find it by its arguments.
OBLIQ_LANES Lanes<T, n> select(Lanes<MaskOf<T>, n> where, Lanes<T, n> yes, Lanes<T, n> no) {
  if constexpr (!is_one<T, n>(nullptr))
    return {select(where.low, yes.low, no.low), select(where.high, yes.high, no.high)};
  else if constexpr (sizeof(yes.v) == 64)
    return {where.v ? yes.v : no.v};
  else
    return lanes_from<Lanes<T, n>>(chosen(intrinsic(where), intrinsic(yes), intrinsic(no)));
}

}  // namespace obliq::OBLIQ_ISA
