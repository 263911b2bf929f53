// Tables of antenna patterns. Any bytes are a table whose gains are between nothing and 1, or a sentence.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <string>

#include "server/radar/beam/pattern_cuts.h"
#include "terrain/base/errors.h"
#include "tests/fuzz/input.h"

namespace obliq {
namespace {

void check(const PatternCut& cut) {
  for (double angle = -3.2; angle <= 3.2; angle += 0.05) {
    const double gain = cut.gain(angle);
    if (!(gain >= 0 && gain <= 1)) fuzz::broken("a gain that is none");
  }
  if (!std::isfinite(cut.extent_rad(1e-3))) fuzz::broken("a beam without an end");
}

}  // namespace
}  // namespace obliq

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace obliq;
  const int file = memfd_create("pattern", 0);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) fuzz::broken("no memory for a file");
  try {
    const PatternCuts cuts = read_pattern_cuts("/proc/self/fd/" + std::to_string(file));
    check(cuts.azimuth);
    check(cuts.elevation);
  } catch (const InputError&) {
    // What an operator gets to read.
  }
  close(file);
  return 0;
}
