// What the log of an exercise keeps, and what it drops when there is more.
#include "server/net/exercise/exercise_log.h"

#include <gtest/gtest.h>

#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::test::exercise_log_test {
namespace {

using net::ExerciseLog;

TEST(EventsOfALog, AreBoundedAndBookmarksStay) {
  ExerciseLog log;
  wire::ExerciseEvent bookmark;
  bookmark.set_kind(wire::BOOKMARK_EVENT);
  bookmark.set_text("the first");
  log.note(bookmark);
  constexpr std::size_t kMany = 3 * ExerciseLog::kMostEvents;
  wire::ExerciseEvent change;
  change.set_kind(wire::SETTINGS_EVENT);
  for (std::size_t i = 0; i < kMany; ++i) log.note(change);
  wire::ExerciseEvents page;
  EXPECT_FALSE(log.write(0, page));
  EXPECT_EQ(page.events(0).text(), "the first");
  EXPECT_EQ(page.events(1).number(), 2 + kMany - ExerciseLog::kMostEvents);
  EXPECT_EQ(page.lost(), kMany - ExerciseLog::kMostEvents);
  EXPECT_NE(log.find(1), nullptr);
  EXPECT_EQ(log.find(2), nullptr);
  // Large ones: by their bytes.
  change.mutable_state()->set_scene_name(std::string(200'000, 'x'));
  for (int i = 0; i < 100; ++i) log.note(change);
  std::size_t bytes = 0;
  std::uint64_t after = 1;
  for (bool whole = false; !whole;) {
    page.Clear();
    whole = log.write(after, page);
    for (const wire::ExerciseEvent& event : page.events()) bytes += event.ByteSizeLong();
    after = page.events().rbegin()->number();
    EXPECT_LT(page.ByteSizeLong(), wire::kMaxDescriptorBytes) << "one of these a page";
  }
  EXPECT_LE(bytes, ExerciseLog::kMostBytes);
  EXPECT_EQ(after, 1 + kMany + 100);
}

TEST(EventsOfALog, AreNotPushedOutByTargetsThatComeAndGo) {
  ExerciseLog log;
  wire::ExerciseEvent change;
  change.set_kind(wire::SETTINGS_EVENT);
  log.note(change);
  constexpr std::size_t kMany = 2 * ExerciseLog::kMostEvents;
  for (std::size_t i = 0; i < kMany; ++i) log.targets(1, 0, "host");
  log.note(change);
  EXPECT_NE(log.find(1), nullptr);
  EXPECT_EQ(log.find(2), nullptr);
  EXPECT_NE(log.find(kMany + 1), nullptr);
  EXPECT_EQ(log.find(kMany + 3), nullptr);
  wire::ExerciseEvents page;
  std::uint64_t last = 0, n = 0;
  for (bool whole = false; !whole;) {
    page.Clear();
    whole = log.write(last, page);
    for (const wire::ExerciseEvent& event : page.events()) {
      EXPECT_GT(event.number(), last);
      last = event.number();
      ++n;
    }
  }
  EXPECT_EQ(n, ExerciseLog::kMostTargetEvents + 2);
  EXPECT_EQ(last, kMany + 2);
  EXPECT_EQ(page.lost(), kMany - ExerciseLog::kMostTargetEvents);
}

}  // namespace
}  // namespace obliq::test::exercise_log_test
