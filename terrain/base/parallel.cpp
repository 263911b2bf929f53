#include "terrain/base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace obliq {

namespace {
// The thread sanitizer cannot see the locks inside libtbb, so it is told where data changes hands.
#ifdef __SANITIZE_THREAD__
void hand_over(void* token) { __tsan_release(token); }
void take_over(void* token) { __tsan_acquire(token); }
#else
void hand_over(void*) {}
void take_over(void*) {}
#endif
}  // namespace

void for_each_row(int n_rows, const std::function<void(int row)>& work) {
  if (n_rows <= 0) return;
  char begun = 0, done = 0;
  hand_over(&begun);
  tbb::parallel_for(0, n_rows, [&](int row) {
    take_over(&begun);
    work(row);
    hand_over(&done);
  });
  take_over(&done);
}

void on_this_thread_alone(const std::function<void()>& work) {
  tbb::task_arena(1).execute([&] { work(); });
}

}  // namespace obliq
