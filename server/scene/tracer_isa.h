#pragma once
#include <array>
#include <cstdint>

namespace obliq {

/// The instruction set that Embree traces with. Promised bits hold for one set: two sets may round a ray that
/// passes within float steps of an edge to different sides of it. `best` is the widest this machine has; the
/// others are for tests that compare sets.
enum class TracerIsa : std::uint8_t { best, sse42, avx, avx2, avx512 };

inline constexpr std::array kNamedIsas{TracerIsa::sse42, TracerIsa::avx, TracerIsa::avx2, TracerIsa::avx512};

/// As Embree's device configuration spells it; empty for `best`.
constexpr const char* isa_name(TracerIsa isa) {
  switch (isa) {
    case TracerIsa::sse42:
      return "sse4.2";
    case TracerIsa::avx:
      return "avx";
    case TracerIsa::avx2:
      return "avx2";
    case TracerIsa::avx512:
      return "avx512";
    case TracerIsa::best:
      break;
  }
  return "";
}

/// Whether this machine's processor has the set. Embree itself does not ask before it uses one that was
/// named.
bool has_isa(TracerIsa isa);

}  // namespace obliq
