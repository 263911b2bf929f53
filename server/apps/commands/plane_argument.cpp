#include "server/apps/commands/plane_argument.h"

#include <fmt/core.h>

#include <sstream>

#include "terrain/base/errors.h"

namespace obliq {

wire::PlaneSet planes_from_names(const std::string& names) {
  wire::PlaneSet set = 0;
  std::istringstream in(names);
  for (std::string name; std::getline(in, name, ',');) {
    bool known = false;
    for (int i = 0; i < wire::kPlanes; ++i) {
      const auto plane = static_cast<wire::Plane>(i);
      if (name != wire::plane_name(plane)) continue;
      set = static_cast<wire::PlaneSet>(set | wire::plane_bit(plane));
      known = true;
    }
    if (!known) set = 0;
    if (!known) break;
  }
  if (set != 0) return set;
  throw InputError(fmt::format("--planes: found \"{}\"; allowed: one or more of {}, with commas between them",
                               names, wire::plane_names(wire::kAllPlanes)));
}

}  // namespace obliq
