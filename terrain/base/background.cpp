#include "terrain/base/background.h"

#include <sys/resource.h>
#include <unistd.h>

namespace obliq {

namespace {
/// About a tenth of a core beside threads that compute all the time, a whole one beside threads that wait
/// (weights of the Linux scheduler: 110 against 1024).
constexpr int kNiceness = 10;
}  // namespace

bool lower_own_priority() {
  // Linux: niceness belongs to the thread (setpriority(2), "C library/kernel differences").
  return setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness) == 0;
}

}  // namespace obliq
