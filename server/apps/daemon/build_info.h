#pragma once
#include "server/http/metrics.h"

namespace obliq {

/// This program's version and compiler, and the versions of the libraries that decide its results.
http::BuildInfo build_info();

}  // namespace obliq
