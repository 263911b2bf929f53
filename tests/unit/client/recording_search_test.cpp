// A frame is found by its time wherever it lies, in files of any length, also damaged ones.
#include "client/recording/recording_search.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/support/made_recording.h"

namespace obliq::test::recording_search_test {
namespace {

constexpr std::int64_t kStep_ns = 100'000'000;

class RecordingSearchTest : public testing::Test {
 protected:
  ~RecordingSearchTest() override { std::filesystem::remove(path_); }
  std::unique_ptr<client::RecordingSearch> open(const std::string& bytes, const std::string& radar = "main") {
    std::ofstream(path_, std::ios::binary) << bytes;
    std::unique_ptr<client::RecordingSearch> search;
    status = client::RecordingSearch::open(path_, radar, search);
    return search;
  }
  client::Status status;

 private:
  std::string path_ = testing::TempDir() + "search_" + std::to_string(::getpid()) + ".obliq";
};

/// Where each frame begins.
std::vector<std::uint64_t> begins(const MadeRecording& made) {
  std::vector<std::uint64_t> offsets;
  for (const MadeMessage& message : made.messages)
    if (message.type == wire::MessageType::frame_begin) offsets.push_back(message.begin);
  return offsets;
}

TEST_F(RecordingSearchTest, FindsEachFrameByItsTimeAndTheOneBeforeIt) {
  for (const int frames : {1, 2, 3, 100, 3000}) {  // the longest is several megabytes
    const MadeRecording made = timed_recording(frames, kStep_ns);
    const auto offsets = begins(made);
    const auto search = open(made.bytes);
    ASSERT_TRUE(search) << status.text;
    EXPECT_EQ(search->first().utc_ns, kMadeStart_ns);
    EXPECT_EQ(search->end_utc_ns(), kMadeStart_ns + (frames - 1) * kStep_ns + 99 * kStep_ns / 100);
    for (int k = 0; k < frames; k += std::max(1, frames / 41)) {
      const auto at = static_cast<std::size_t>(k);
      for (const std::int64_t into_ns : {std::int64_t{0}, kStep_ns / 2, kStep_ns - 1}) {
        const auto found = search->at_utc(kMadeStart_ns + k * kStep_ns + into_ns);
        ASSERT_EQ(found.frame.offset, offsets[at]) << frames << " frames, " << k;
        ASSERT_EQ(found.before.offset, offsets[k == 0 ? 0 : at - 1]);
        const auto by_sim = search->at_sim_time(kMadeSimStart_ns + k * kStep_ns + into_ns);
        ASSERT_TRUE(by_sim);
        ASSERT_EQ(by_sim->frame.offset, offsets[at]);
        ASSERT_EQ(by_sim->frame.sim_time_ns, kMadeSimStart_ns + k * kStep_ns);
      }
    }
    EXPECT_EQ(search->at_utc(0).frame.offset, offsets.front()) << "before the beginning";
    EXPECT_EQ(search->at_utc(INT64_MAX).frame.offset, offsets.back()) << "behind the end";
  }
}

TEST_F(RecordingSearchTest, FramesOfOtherRadarsAreNotFound) {
  MadeRecording made;
  std::uint64_t sequence = 0, other = 0;
  for (std::uint64_t id = 1; id <= 200; ++id) {
    add_frame(made, id, other, true, "nose", 2);
    if (id % 50 == 0) add_frame(made, id, sequence);
  }
  const auto search = open(made.bytes);
  ASSERT_TRUE(search) << status.text;
  std::vector<std::uint64_t> mains;
  for (std::size_t i = 0; i < made.messages.size(); ++i) {
    const bool begin = made.messages[i].type == wire::MessageType::frame_begin;
    if (begin && made.messages[i].frame_id % 50 == 0 && i > 0 &&
        made.messages[i - 1].frame_id == made.messages[i].frame_id)
      mains.push_back(made.messages[i].begin);
  }
  ASSERT_EQ(mains.size(), 4u);
  EXPECT_EQ(search->first().offset, mains.front());
  EXPECT_EQ(search->at_utc(INT64_MAX).frame.offset, mains.back());
  EXPECT_EQ(search->at_utc(INT64_MAX).before.offset, mains[2]);
  EXPECT_FALSE(search->at_sim_time(5)) << "its poses have no clock";
  EXPECT_FALSE(open(made.bytes, "tail"));
  EXPECT_NE(status.text.find("no frame of radar tail begins in it"), std::string::npos) << status.text;
}

TEST_F(RecordingSearchTest, DamageAndACutCostTheFramesThatTheyHitAndNoOthers) {
  constexpr int kFrames = 3000;
  MadeRecording made = timed_recording(kFrames, kStep_ns);
  const auto offsets = begins(made);
  // The FrameBegin of each tenth is damaged, and the last is cut.
  for (std::size_t k = 5; k < offsets.size(); k += 10) made.bytes[offsets[k]] = 'X';
  made.bytes.resize(offsets.back() + 60);
  const auto search = open(made.bytes);
  ASSERT_TRUE(search) << status.text;
  for (std::size_t k = 0; k + 1 < offsets.size(); k += 37) {
    const std::size_t expected = k % 10 == 5 ? k - 1 : k;
    const auto found = search->at_utc(kMadeStart_ns + static_cast<std::int64_t>(k) * kStep_ns);
    EXPECT_EQ(found.frame.offset, offsets[expected]) << k;
  }
  EXPECT_EQ(search->at_utc(INT64_MAX).frame.offset, offsets[offsets.size() - 2]);
}

TEST_F(RecordingSearchTest, WhatIsNoRecordingIsRefused) {
  for (const std::string& bytes :
       {std::string(), std::string("x"), std::string(100000, 'O'), made_recording().bytes.substr(0, 40)}) {
    EXPECT_FALSE(open(bytes));
    EXPECT_EQ(status.outcome, client::Outcome::bad_stream) << status.text;
  }
  std::unique_ptr<client::RecordingSearch> search;
  EXPECT_FALSE(client::RecordingSearch::open("/nowhere/at.all", "main", search).ok());
}

}  // namespace
}  // namespace obliq::test::recording_search_test
