// What obliq fly says of datagrams that are no pose.
#include "server/apps/dis/refused_datagrams.h"

#include <gtest/gtest.h>

namespace obliq::refused_datagrams_test {
namespace {

using std::chrono::milliseconds;

TEST(RefusedDatagrams, AFloodOfReasonsIsALineASecondWithItsCount) {
  RefusedDatagrams refused;
  const RefusedDatagrams::Clock::time_point start{std::chrono::hours(1)};
  std::vector<std::string> lines;
  for (int k = 0; k < 2500; ++k) {  // for two and a half seconds, each for another reason than the one before
    refused.add(k % 2 == 0 ? "found 3 bytes" : "found 4 bytes");
    if (std::string line = refused.line(start + milliseconds(k)); !line.empty()) lines.push_back(line);
  }
  EXPECT_EQ(lines, (std::vector<std::string>{
                       "1 datagram is no pose: found 3 bytes",
                       "1000 datagrams are no poses: 500 x found 4 bytes / 500 x found 3 bytes",
                       "1000 datagrams are no poses: 500 x found 4 bytes / 500 x found 3 bytes"}));
  EXPECT_EQ(refused.all(), 2500u);
  // The last ones are told when the second is over, though no further one comes.
  EXPECT_EQ(refused.line(start + milliseconds(2999)), "");
  EXPECT_EQ(refused.line(start + milliseconds(3000)),
            "499 datagrams are no poses: 250 x found 4 bytes / 249 x found 3 bytes");
  EXPECT_EQ(refused.rest(), "");
}

TEST(RefusedDatagrams, ALineOfManyReasonsIsBounded) {
  RefusedDatagrams refused;
  for (int k = 0; k < 1000; ++k) refused.add("latitude: found " + std::to_string(k));
  const std::string line = refused.rest();
  EXPECT_TRUE(line.ends_with("latitude: found 7 / 992 for other reasons")) << line;
  EXPECT_LT(line.size(), 300u);
}

TEST(RefusedDatagrams, AReasonThatStaysIsToldOnce) {
  RefusedDatagrams refused;
  RefusedDatagrams::Clock::time_point now{std::chrono::hours(1)};
  EXPECT_EQ(refused.line(now), "");
  int lines = 0;
  for (int k = 0; k < 100; ++k, now += milliseconds(100)) {
    refused.add("found 3 bytes");
    lines += !refused.line(now).empty();
  }
  EXPECT_EQ(lines, 1);
}

}  // namespace
}  // namespace obliq::refused_datagrams_test
