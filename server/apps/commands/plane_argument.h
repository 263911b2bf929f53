#pragma once
#include <string>

#include "proto/plane.h"

namespace obliq {

/// "iq,power" as a set of planes; throws InputError that lists the names.
wire::PlaneSet planes_from_names(const std::string& names);

}  // namespace obliq
