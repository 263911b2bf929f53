#include "server/radar/settings.h"

namespace obliq {

std::string frustum_name(FrustumKind kind) {
  switch (kind) {
    case FrustumKind::symmetric:
      return "symmetric";
    case FrustumKind::oblique:
      return "oblique";
    case FrustumKind::polar:
      return "polar";
    default:
      return "sweep";
  }
}

std::string plates_name(PlateKind plates) { return plates == PlateKind::nearest ? "nearest" : "spread"; }

}  // namespace obliq
