// The kernels of the instruction set that this file is compiled for.
#include "server/radar/simd/kernels.h"

namespace obliq::OBLIQ_ISA {

#define OBLIQ_TEXT(text) #text
#define OBLIQ_NAME(isa) OBLIQ_TEXT(isa)
#define OBLIQ_ENTRY(kernel) , kernel

extern const Kernels kTable;
constinit const Kernels kTable{OBLIQ_NAME(OBLIQ_ISA) OBLIQ_KERNELS(OBLIQ_ENTRY)};

}  // namespace obliq::OBLIQ_ISA
