#pragma once
// Every way to find samples, for tests that hold for all of them: a new one is one line here.
#include <ostream>
#include <string>

#include "server/radar/settings.h"

namespace obliq::test {

struct NamedSource {
  FrustumKind kind;
  const char* name;

  friend std::ostream& operator<<(std::ostream& out, const NamedSource& source) { return out << source.name; }
};

inline constexpr NamedSource kEverySource[] = {
    {FrustumKind::symmetric, "symmetric"},
    {FrustumKind::oblique, "oblique"},
    {FrustumKind::sweep, "sweep"},
};

/// For the names of parameterised tests.
template <class Info>
std::string source_name(const Info& info) {
  return info.param.name;
}

}  // namespace obliq::test
