// How long a rendering works between two times that it asks whether it may go on: asks [FRAMES] [FIRST_SEED]
// [MOST_UNITS] renders the frames of wedge_work_test.cpp, each with one thread and up to so much work, and
// prints the longest waits in milliseconds of the thread's processor time, and nanoseconds a unit.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "tests/support/hard_frames.h"

namespace {

double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) / 1e6;
}

struct Wait {
  double ms;
  std::int64_t units;
  std::string where;
};

}  // namespace

int main(int argc, char** argv) {
  using namespace obliq::test;
  const auto argument = [&](int k, long otherwise) { return argc > k ? std::atol(argv[k]) : otherwise; };
  const long frames = argument(1, 200);
  std::vector<Wait> longest;
  double all_ms = 0;
  std::int64_t all = 0;
  auto seed = static_cast<std::uint64_t>(argument(2, 0));
  for (long done = 0; done < frames; ++seed) {
    const auto frame = hard_frame(seed);
    if (!frame) continue;
    ++done;
    HeardWork heard;
    heard.most_total = argument(3, 15'000'000);
    Wait wait{0, 0, frame->text};
    const double begun_ms = processor_ms();
    double since_ms = begun_ms;
    std::int64_t before = 0;
    heard.on_ask = [&] {
      const double now_ms = processor_ms();
      if (now_ms - since_ms > wait.ms) wait = {now_ms - since_ms, heard.total() - before, frame->text};
      since_ms = now_ms;
      before = heard.total();
    };
    render_heard(*frame, heard);
    all_ms += processor_ms() - begun_ms;
    all += heard.total();
    longest.push_back(wait);
  }
  std::ranges::sort(longest, [](const Wait& a, const Wait& b) { return a.ms > b.ms; });
  std::printf("%ld frames, %.1f s, %.1f ns a unit; longest waits, each the longest of its frame:\n", frames,
              all_ms / 1e3, all_ms * 1e6 / static_cast<double>(all));
  for (std::size_t k = 0; k < std::min<std::size_t>(20, longest.size()); ++k)
    std::printf("%8.2f ms after %lld units: %s\n", longest[k].ms, static_cast<long long>(longest[k].units),
                longest[k].where.c_str());
  std::printf("%8.2f ms in the middle\n", longest.empty() ? 0 : longest[longest.size() / 2].ms);
  return 0;
}
