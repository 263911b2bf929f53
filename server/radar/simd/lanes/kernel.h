#pragma once

/// Declares a kernel, an inner loop that exists once for each instruction set: the type of a pointer to it,
/// and the function itself in the files that are compiled once for each set. All sets give the same bits.
#if defined(OBLIQ_ISA)
#define OBLIQ_KERNEL(result, name, ...) \
  namespace OBLIQ_ISA {                 \
  result name(__VA_ARGS__);             \
  }                                     \
  using name##_kernel = result (*)(__VA_ARGS__)
#else
#define OBLIQ_KERNEL(result, name, ...) using name##_kernel = result (*)(__VA_ARGS__)
#endif
