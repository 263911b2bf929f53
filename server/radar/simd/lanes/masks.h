#pragma once
// What comparing lanes gives, and choosing by it: a lane of all bits or none where numbers are compared in
// SSE and AVX2, a bit a lane in AVX-512, which has registers for it. (As vectors of whole numbers GCC 12
// makes a number of each bit there and a bit of each number again, and some conditions bit by bit.)
#include "server/radar/simd/lanes/registers.h"

namespace obliq::OBLIQ_ISA {

#if defined(__AVX512F__)

/// Whether something holds in a lane of so many bytes.
template <int bytes>
struct Flag {
  std::conditional_t<bytes == 8, std::int64_t, std::int32_t> lane;
};
template <int bytes, int n>
struct Lanes<Flag<bytes>, n, true> {
  using Bits = std::conditional_t<n == 16, __mmask16, __mmask8>;
  Bits v;  ///< those beyond the lanes mean nothing
};

template <typename T>
struct MaskOfLane {
  using type = Flag<sizeof(T)>;
};

#else

template <typename T>
struct MaskOfLane {
  using type = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
};

#endif

/// Of a lane of T.
template <typename T>
using MaskOf = typename MaskOfLane<T>::type;

#if defined(__AVX512F__)

#define OBLIQ_FLAGS           \
  template <int bytes, int n> \
  [[gnu::always_inline]] inline

template <int bytes, int n>
using Flags = Lanes<Flag<bytes>, n>;

// Functions of the instruction set, since what the compiler makes of the operators goes through other
// registers.
#define OBLIQ_OF_FLAGS(op, name)                                                  \
  OBLIQ_FLAGS Flags<bytes, n> operator op(Flags<bytes, n> a, Flags<bytes, n> b) { \
    if constexpr (!is_one<Flag<bytes>, n>(nullptr))                               \
      return {a.low op b.low, a.high op b.high};                                  \
    else if constexpr (n == 16)                                                   \
      return {_k##name##_mask16(a.v, b.v)};                                       \
    else                                                                          \
      return {_k##name##_mask8(a.v, b.v)};                                        \
  }
OBLIQ_OF_FLAGS(&, and)
OBLIQ_OF_FLAGS(|, or)
OBLIQ_OF_FLAGS(^, xor)
OBLIQ_OF_FLAGS(!=, xor)
#undef OBLIQ_OF_FLAGS
OBLIQ_FLAGS Flags<bytes, n> operator~(Flags<bytes, n> a) {
  if constexpr (!is_one<Flag<bytes>, n>(nullptr))
    return {~a.low, ~a.high};
  else if constexpr (n == 16)
    return {_knot_mask16(a.v)};
  else
    return {_knot_mask8(a.v)};
}

/// A bit for each lane, the first lane's the lowest.
OBLIQ_FLAGS unsigned bits_of(Flags<bytes, n> flags) {
  if constexpr (!is_one<Flag<bytes>, n>(nullptr))
    return bits_of(flags.low) | bits_of(flags.high) << n / 2;
  else
    return n < 8 ? flags.v & ((1U << n) - 1) : flags.v;
}
OBLIQ_FLAGS Flags<bytes, n> flags_of(const Flags<bytes, n>* /*type*/, unsigned bits) {
  if constexpr (!is_one<Flag<bytes>, n>(nullptr)) {
    constexpr const Flags<bytes, n / 2>* kHalf = nullptr;
    return {flags_of(kHalf, bits), flags_of(kHalf, bits >> n / 2)};
  } else {
    return {static_cast<typename Flags<bytes, n>::Bits>(bits)};
  }
}
OBLIQ_FLAGS bool any_of(Flags<bytes, n> flags) {
  if constexpr (!is_one<Flag<bytes>, n>(nullptr))
    return any_of(flags.low | flags.high);
  else
    return bits_of(flags) != 0;
}

OBLIQ_FLAGS Flags<bytes, n / 2> low_half(Flags<bytes, n> flags) {
  if constexpr (is_one<Flag<bytes>, n>(nullptr))
    return flags_of(static_cast<const Flags<bytes, n / 2>*>(nullptr), flags.v);
  else
    return flags.low;
}
OBLIQ_FLAGS Flags<bytes, n / 2> high_half(Flags<bytes, n> flags) {
  if constexpr (is_one<Flag<bytes>, n>(nullptr))
    return flags_of(static_cast<const Flags<bytes, n / 2>*>(nullptr), flags.v >> n / 2);
  else
    return flags.high;
}
OBLIQ_FLAGS Flags<bytes, 2 * n> joined(Flags<bytes, n> low, Flags<bytes, n> high) {
  if constexpr (is_one<Flag<bytes>, 2 * n>(nullptr))
    return flags_of(static_cast<const Flags<bytes, 2 * n>*>(nullptr), bits_of(low) | bits_of(high) << n);
  else
    return {low, high};
}
OBLIQ_FLAGS Flags<bytes, n> select(Flags<bytes, n> where, Flags<bytes, n> yes, Flags<bytes, n> no) {
  return (where & yes) | (~where & no);
}
#undef OBLIQ_FLAGS

// As the language's operators compare.
enum class Order { less, more, up_to, from, same, other };
template <Order order>
constexpr int kOrderOfFloats = order == Order::less    ? _CMP_LT_OQ
                               : order == Order::more  ? _CMP_GT_OQ
                               : order == Order::up_to ? _CMP_LE_OQ
                               : order == Order::from  ? _CMP_GE_OQ
                               : order == Order::same  ? _CMP_EQ_OQ
                                                       : _CMP_NEQ_UQ;
template <Order order>
constexpr int kOrderOfWhole = order == Order::less    ? _MM_CMPINT_LT
                              : order == Order::more  ? _MM_CMPINT_NLE
                              : order == Order::up_to ? _MM_CMPINT_LE
                              : order == Order::from  ? _MM_CMPINT_NLT
                              : order == Order::same  ? _MM_CMPINT_EQ
                                                      : _MM_CMPINT_NE;
#define OBLIQ_COMPARED(mm, whole)                                                                         \
  const auto bits = [](auto x) __attribute__((always_inline)) { return __builtin_bit_cast(whole, x.v); }; \
  if constexpr (std::is_same_v<T, float>)                                                                 \
    return mm##_cmp_ps_mask(intrinsic(a), intrinsic(b), kOrderOfFloats<order>);                           \
  else if constexpr (std::is_same_v<T, double>)                                                           \
    return mm##_cmp_pd_mask(intrinsic(a), intrinsic(b), kOrderOfFloats<order>);                           \
  else if constexpr (sizeof(T) == 4 && std::is_signed_v<T>)                                               \
    return mm##_cmp_epi32_mask(bits(a), bits(b), kOrderOfWhole<order>);                                   \
  else if constexpr (sizeof(T) == 4)                                                                      \
    return mm##_cmp_epu32_mask(bits(a), bits(b), kOrderOfWhole<order>);                                   \
  else if constexpr (std::is_signed_v<T>)                                                                 \
    return mm##_cmp_epi64_mask(bits(a), bits(b), kOrderOfWhole<order>);                                   \
  else                                                                                                    \
    return mm##_cmp_epu64_mask(bits(a), bits(b), kOrderOfWhole<order>)
template <Order order, typename T, int n>
[[gnu::always_inline]] inline auto compared(Lanes<T, n> a, Lanes<T, n> b) {
  if constexpr (sizeof(a.v) == 64) {
    OBLIQ_COMPARED(_mm512, __m512i);
  } else if constexpr (sizeof(a.v) == 32) {
    OBLIQ_COMPARED(_mm256, __m256i);
  } else {
    OBLIQ_COMPARED(_mm, __m128i);
  }
}
#undef OBLIQ_COMPARED
#define OBLIQ_COMPARE(op, order) compared<Order::order>(a, b)

#else

#define OBLIQ_COMPARE(op, order) a.v op b.v

#endif

#define OBLIQ_COMPARISON(op, order)                                           \
  OBLIQ_LANES Lanes<MaskOf<T>, n> operator op(Lanes<T, n> a, Lanes<T, n> b) { \
    if constexpr (is_one<T, n>(nullptr))                                      \
      return {OBLIQ_COMPARE(op, order)};                                      \
    else                                                                      \
      return {a.low op b.low, a.high op b.high};                              \
  }                                                                           \
  OBLIQ_LANES Lanes<MaskOf<T>, n> operator op(Lanes<T, n> a, Same<T> b) {     \
    return a op every(static_cast<const Lanes<T, n>*>(nullptr), b);           \
  }                                                                           \
  OBLIQ_LANES Lanes<MaskOf<T>, n> operator op(Same<T> a, Lanes<T, n> b) {     \
    return every(static_cast<const Lanes<T, n>*>(nullptr), a) op b;           \
  }

OBLIQ_COMPARISON(<, less)
OBLIQ_COMPARISON(>, more)
OBLIQ_COMPARISON(<=, up_to)
OBLIQ_COMPARISON(>=, from)
OBLIQ_COMPARISON(==, same)
OBLIQ_COMPARISON(!=, other)
#undef OBLIQ_COMPARISON
#undef OBLIQ_COMPARE

// Of one register.
#define OBLIQ_REGISTER [[gnu::always_inline]] inline
#if defined(__AVX512F__)
#define OBLIQ_CHOOSING(mm, floats, doubles, mask)                                                        \
  OBLIQ_REGISTER floats chosen(mask c, floats yes, floats no) { return mm##_mask_blend_ps(c, no, yes); } \
  OBLIQ_REGISTER doubles chosen(__mmask8 c, doubles yes, doubles no) {                                   \
    return mm##_mask_blend_pd(c, no, yes);                                                               \
  }
OBLIQ_CHOOSING(_mm, __m128, __m128d, __mmask8)
OBLIQ_CHOOSING(_mm256, __m256, __m256d, __mmask8)
OBLIQ_CHOOSING(_mm512, __m512, __m512d, __mmask16)
#else
#define OBLIQ_CHOOSING(mm, floats, doubles)                                                                \
  OBLIQ_REGISTER floats chosen(floats c, floats yes, floats no) { return mm##_blendv_ps(no, yes, c); }     \
  OBLIQ_REGISTER doubles chosen(doubles c, doubles yes, doubles no) { return mm##_blendv_pd(no, yes, c); } \
  OBLIQ_REGISTER unsigned bits(floats mask) { return static_cast<unsigned>(mm##_movemask_ps(mask)); }      \
  OBLIQ_REGISTER unsigned bits(doubles mask) { return static_cast<unsigned>(mm##_movemask_pd(mask)); }
OBLIQ_CHOOSING(_mm, __m128, __m128d)
#if defined(__AVX2__)
OBLIQ_CHOOSING(_mm256, __m256, __m256d)
#endif

/// A bit for each lane, the first lane's the lowest.
OBLIQ_LANES unsigned bits_of(Lanes<T, n> flags) {
  if constexpr (!is_one<T, n>(nullptr))
    return bits_of(flags.low) | bits_of(flags.high) << n / 2;
  else
    return bits(intrinsic(flags));
}
OBLIQ_LANES bool any_of(Lanes<T, n> flags) {
  if constexpr (!is_one<T, n>(nullptr))
    return any_of(flags.low | flags.high);
  else
    return bits(intrinsic(flags)) != 0;
}
OBLIQ_LANES Lanes<T, n> flags_of(const Lanes<T, n>* /*type*/, unsigned bits) {
  const auto bit = lane_by_lane<T, n>([](int lane) __attribute__((always_inline)) { return T{1} << lane; });
  return (static_cast<T>(bits) & bit) != 0;
}
#endif
#undef OBLIQ_CHOOSING
#undef OBLIQ_REGISTER

/// For templates of other rooms, which find it by its arguments.
OBLIQ_LANES Lanes<T, n> select(Lanes<MaskOf<T>, n> where, Lanes<T, n> yes, Lanes<T, n> no) {
  if constexpr (!is_one<T, n>(nullptr)) {
    return {select(where.low, yes.low, no.low), select(where.high, yes.high, no.high)};
  } else {
#if defined(__AVX512F__)
    return lanes_from<Lanes<T, n>>(chosen(where.v, intrinsic(yes), intrinsic(no)));
#else
    return lanes_from<Lanes<T, n>>(chosen(intrinsic(where), intrinsic(yes), intrinsic(no)));
#endif
  }
}

}  // namespace obliq::OBLIQ_ISA
