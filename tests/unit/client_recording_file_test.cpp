// The file that a recording is written to.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "client/recording_reader.h"
#include "client/recording_writer.h"
#include "tests/support/made_recording.h"

namespace obliq::test {
namespace {

class RecordingFile : public testing::Test {
 protected:
  RecordingFile()
      : path_(std::filesystem::path(testing::TempDir()) /
              ("recording_" + std::to_string(getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name())) {}
  ~RecordingFile() override { std::filesystem::remove(path_); }

  std::string text() const {
    std::stringstream all;
    all << std::ifstream(path_, std::ios::binary).rdbuf();
    return all.str();
  }
  std::filesystem::path path_;
};

client::Status write_messages(client::RecordingWriter& writer, const MadeRecording& made,
                              std::size_t& whole) {
  whole = 0;
  for (const MadeMessage& message : made.messages) {
    const auto bytes =
        std::as_bytes(std::span(made.bytes)).subspan(message.begin, message.end - message.begin);
    client::Status status = writer.write(bytes.first(wire::kHeaderBytes), bytes.subspan(wire::kHeaderBytes));
    if (!status.ok()) return status;
    whole = message.end;
  }
  return {};
}

TEST_F(RecordingFile, IsWhatArrivedByteForByteAndIsNotOverwrittenUnasked) {
  const MadeRecording made = made_recording();
  client::RecordingWriter writer;
  ASSERT_TRUE(writer.open(path_, false).ok());
  std::size_t whole = 0;
  ASSERT_TRUE(write_messages(writer, made, whole).ok());
  EXPECT_TRUE(text() == made.bytes) << "also before it is closed";
  ASSERT_TRUE(writer.close().ok());
  client::RecordingWriter second;
  EXPECT_EQ(second.open(path_, false).outcome, client::Outcome::bad_argument);
  EXPECT_TRUE(text() == made.bytes);
  ASSERT_TRUE(second.open(path_, true).ok());
  EXPECT_EQ(text(), "");
}

TEST_F(RecordingFile, ThatMayGrowNoFurtherEndsWithItsLastWholeMessage) {
  const MadeRecording made = made_recording();
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  for (const std::size_t limit :
       {std::size_t{1}, std::size_t{300}, made.bytes.size() / 2, made.bytes.size() - 1}) {
    rlimit tight = before;
    tight.rlim_cur = limit;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
    client::RecordingWriter writer;
    std::size_t whole = 0;
    const client::Status opened = writer.open(path_, true);
    const client::Status status = write_messages(writer, made, whole);
    const client::Status after = writer.write(std::as_bytes(std::span(made.bytes)).first(1), {});
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    ASSERT_TRUE(opened.ok());
    EXPECT_EQ(status.outcome, client::Outcome::bad_argument) << limit;
    EXPECT_NE(status.text.find(std::to_string(whole) + " bytes of whole messages"), std::string::npos)
        << status.text;
    EXPECT_FALSE(after.ok()) << "nothing is written behind a gap";
    EXPECT_TRUE(text() == made.bytes.substr(0, whole)) << limit;
  }
  (void)std::signal(SIGXFSZ, ignored);
}

}  // namespace
}  // namespace obliq::test
