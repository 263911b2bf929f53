#include "server/radar/simd/kernels.h"

#include <atomic>

#include "server/scene/tracer_isa.h"

namespace obliq {

// kernel_table.cpp, compiled with x86-64-v2, -v3 and -v4.
namespace sse {
extern const Kernels kTable;
}
namespace avx2 {
extern const Kernels kTable;
}
namespace avx512 {
extern const Kernels kTable;
}

const std::vector<Kernels>& all_kernels() {
  static const std::vector<Kernels> kernels = [] {
    std::vector<Kernels> here{sse::kTable};
    if (has_isa(TracerIsa::avx2)) here.push_back(avx2::kTable);
    if (has_isa(TracerIsa::avx512)) here.push_back(avx512::kTable);
    return here;
  }();
  return kernels;
}

namespace {
std::atomic<const Kernels*>& in_use() {
  static std::atomic<const Kernels*> kernels = &all_kernels().back();
  return kernels;
}
}  // namespace

const Kernels& active_kernels() { return *in_use().load(std::memory_order_relaxed); }

void use_kernels(const Kernels& kernels) { in_use() = &kernels; }

}  // namespace obliq
