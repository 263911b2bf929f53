// Recordings that are whole, cut at every byte and damaged at every byte.
// The file that a recording is written to.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "client/recording/recorded_frames.h"
#include "client/recording/recording_reader.h"
#include "client/recording/recording_writer.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/stream/frame_encoder.h"
#include "tests/support/made_recording.h"

namespace obliq::test::recording_test {
namespace {

using client::RecordedFrames;
using client::RecordingReader;
using wire::MessageType;

std::unique_ptr<RecordingReader> reader_of(const std::string& bytes) {
  return std::make_unique<RecordingReader>(std::make_unique<std::istringstream>(bytes));
}

struct Replayed {
  std::set<std::uint64_t> frames;
  std::vector<std::string> notes;
  client::RecordingLosses losses;
  std::uint64_t aborted = 0;
  bool cut = false;
};

void expect_made(const client::RecordedFrame& recorded) {
  const client::AssembledFrame& frame = recorded.frame;
  const std::uint64_t id = frame.descriptor->frame_id();
  ASSERT_EQ(frame.power_w.size(), static_cast<std::size_t>(kMadeAzimuths * kMadeRanges));
  for (int azimuth = 0; azimuth < kMadeAzimuths; ++azimuth) {
    for (int range = 0; range < kMadeRanges; ++range) {
      const auto at = static_cast<std::size_t>(azimuth * kMadeRanges + range);
      ASSERT_EQ(frame.power_w[at], made_power(id, azimuth, range));
      ASSERT_EQ(frame.count[at], id);
      ASSERT_EQ(frame.state[at], range);
    }
  }
  ASSERT_EQ(recorded.wedges.size(), 2u);
  ASSERT_EQ(recorded.wedges[0].n_azimuth + recorded.wedges[1].n_azimuth,
            static_cast<std::uint32_t>(kMadeAzimuths));
}

Replayed replay(const std::string& bytes) {
  Replayed replayed;
  RecordedFrames frames(reader_of(bytes), "main", wire::kAllPlanes);
  for (;;) {
    client::RecordedFrame recorded;
    const auto found = frames.next(recorded);
    if (!frames.note().empty()) replayed.notes.push_back(frames.note());
    if (found == RecordedFrames::Found::frame) {
      expect_made(recorded);
      replayed.frames.insert(recorded.frame.descriptor->frame_id());
    }
    if (found != RecordedFrames::Found::end) continue;
    replayed.losses = frames.losses();
    replayed.aborted = frames.aborted();
    replayed.cut = frames.cut();
    return replayed;
  }
}

TEST(Recording, AWholeOneGivesItsFramesAndNamesTheOneThatWasAborted) {
  const Replayed replayed = replay(made_recording().bytes);
  EXPECT_EQ(replayed.frames, (std::set<std::uint64_t>{1, 3, 4}));
  EXPECT_EQ(replayed.notes, std::vector<std::string>{"frame 2: aborted, made to end"});
  EXPECT_FALSE(replayed.losses.any());
  EXPECT_EQ(replayed.aborted, 1u);
  EXPECT_FALSE(replayed.cut);
}

TEST(Recording, CutAtAnyByteGivesEveryWholeMessageAndSaysWhatIsLeftOver) {
  const MadeRecording made = made_recording();
  for (std::size_t cut = 0; cut <= made.bytes.size(); ++cut) {
    std::size_t whole_messages = 0;
    std::size_t whole_bytes = 0;
    std::set<std::uint64_t> whole_frames;
    std::uint64_t in_hand = 0;
    for (const MadeMessage& message : made.messages) {
      if (message.end > cut) break;
      ++whole_messages;
      whole_bytes = message.end;
      if (message.type == MessageType::frame_end) whole_frames.insert(message.frame_id);
      const bool ends = message.type == MessageType::frame_end || message.type == MessageType::frame_abort;
      in_hand = ends ? 0 : message.frame_id;
    }
    const std::string bytes = made.bytes.substr(0, cut);

    const auto reader = reader_of(bytes);
    while (reader->next() == RecordingReader::Found::message) {
    }
    ASSERT_EQ(reader->messages(), whole_messages) << cut;
    ASSERT_EQ(reader->fault().bytes, cut - whole_bytes) << cut;
    if (cut > whole_bytes) {
      ASSERT_EQ(reader->fault().offset, whole_bytes) << cut;
    }

    const Replayed replayed = replay(bytes);
    ASSERT_EQ(replayed.frames, whole_frames) << cut;
    ASSERT_FALSE(replayed.losses.any()) << cut << ": how a recorder that is killed ends is no loss";
    ASSERT_EQ(replayed.cut, cut > whole_bytes || in_hand != 0) << cut;
    if (!replayed.cut) continue;
    const std::string& said = replayed.notes.back();
    ASSERT_NE(said.find("cut at offset " + std::to_string(cut)), std::string::npos) << said;
    if (cut > whole_bytes) {
      ASSERT_NE(said.find(std::to_string(cut - whole_bytes) + " bytes"), std::string::npos) << said;
    }
    const std::string frame_text = "frame " + std::to_string(in_hand) + " is incomplete";
    ASSERT_EQ(said.find(frame_text) != std::string::npos, in_hand != 0) << cut << ": " << said;
  }
}

TEST(Recording, OneWrongByteAnywhereCostsItsMessageAndNothingElse) {
  const MadeRecording made = made_recording();
  for (const MadeMessage& hit : made.messages) {
    for (std::size_t at = hit.begin; at < hit.end; ++at) {
      for (const unsigned flip : {0x01u, 0x80u, 0xFFu}) {
        std::string bytes = made.bytes;
        bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ flip);

        const auto reader = reader_of(bytes);
        auto found = RecordingReader::Found::message;
        while ((found = reader->next()) == RecordingReader::Found::message) {
        }
        // At the recording's end a header that promises too much looks like a cut; else it is damage.
        const bool last = hit.end == made.bytes.size();
        ASSERT_TRUE(found == RecordingReader::Found::damage || last) << at;
        ASSERT_EQ(reader->fault().offset, hit.begin) << at;
        ASSERT_EQ(reader->fault().bytes, hit.end - hit.begin) << at;
        while (reader->next() != RecordingReader::Found::end) {
        }
        ASSERT_EQ(reader->messages(), made.messages.size() - 1) << at;

        std::set<std::uint64_t> whole{1, 3, 4};
        whole.erase(hit.frame_id);
        const Replayed replayed = replay(bytes);
        ASSERT_EQ(replayed.frames, whole) << at;
        ASSERT_TRUE(replayed.losses.any() || replayed.cut) << at;
        // One, whichever of its messages was hit.
        if (hit.frame_id == 3) {
          ASSERT_EQ(replayed.losses.text(), "1 frame lost, damaged in 1 place") << at;
        }
      }
    }
  }
}

TEST(Recording, WhatAPowerFailureLeavesBehindIsNamedAndSkipped) {
  MadeRecording made = made_recording();
  std::uint64_t sequence = 100;
  made.bytes += std::string(5'000'000, '\0');  // more than the reader holds at a time
  add_frame(made, 7, sequence);
  const Replayed replayed = replay(made.bytes);
  EXPECT_EQ(replayed.frames, (std::set<std::uint64_t>{1, 3, 4, 7}));
  EXPECT_EQ(replayed.losses.text(), "0 frames lost, damaged in 1 place");
  EXPECT_NE(replayed.notes.back().find("5000000 bytes skipped"), std::string::npos) << replayed.notes.back();
}

TEST(Recording, AFileOfNothingButHeadersEnds) {
  // Each header promises the most there may be, so that each candidate costs its CRC over all of it: searched
  // to the end, this would be a hundred gigabytes.
  wire::MessageHeader header;
  header.type = MessageType::wedge_block;
  header.payload_length = wire::kMaxPayloadBytes;
  wire::HeaderBytes one;
  wire::encode_header(header, one);
  std::string bytes;
  while (bytes.size() < 5'000'000) bytes.append(reinterpret_cast<const char*>(one.data()), one.size());
  const auto reader = reader_of(bytes);
  ASSERT_EQ(reader->next(), RecordingReader::Found::damage);
  EXPECT_NE(reader->fault().reason.find("too much damage"), std::string::npos) << reader->fault().reason;
  EXPECT_EQ(reader->next(), RecordingReader::Found::end);
}

TEST(Recording, OfIntegersCompressedGivesTheValuesThatAClientWouldHaveGot) {
  stream::StreamChoice choice;
  choice.format.iq = wire::IqEncoding::ci16_le;
  choice.format.compression = wire::Compression::zstd;
  MadeRecording made;
  std::uint64_t sequence = 0;
  add_frame(made, 1, sequence, true, "main", 1, {choice});
  EXPECT_EQ(replay(made.bytes).frames, std::set<std::uint64_t>{1});  // all planes but I&Q are exact
}

TEST(Recording, AConnectionThatWasTakenUpAgainLosesTheFrameInHandAndNoOther) {
  MadeRecording made = made_recording();
  const MadeMessage end = made.messages.back();
  made.bytes.resize(end.begin);  // frame 4 has no end
  made.messages.pop_back();
  const MadeMessage welcome = made.messages.front();
  made.bytes += made.bytes.substr(welcome.begin, welcome.end - welcome.begin);
  std::uint64_t sequence = 0;
  add_frame(made, 1, sequence, true, "main", 5);  // the server has begun anew, with other numbers
  add_frame(made, 2, sequence, true, "main", 5);
  const Replayed replayed = replay(made.bytes);
  EXPECT_EQ(replayed.frames, (std::set<std::uint64_t>{1, 2, 3}));
  EXPECT_NE(replayed.notes.back().find("connection was lost there; frame 4 is incomplete"), std::string::npos)
      << replayed.notes.back();
  EXPECT_EQ(replayed.losses.text(), "1 frame lost");
  EXPECT_FALSE(replayed.cut);
}

TEST(Recording, AFrameThatIsTooLargeIsLostAndCountedOnce) {
  const MadeRecording made = made_recording();
  RecordedFrames frames(reader_of(made.bytes), "main", wire::kAllPlanes, kMadeAzimuths * kMadeRanges);
  client::RecordedFrame recorded;
  std::vector<std::string> notes;
  while (frames.next(recorded) != RecordedFrames::Found::end) notes.push_back(frames.note());
  ASSERT_EQ(notes.size(), 4u);
  EXPECT_NE(notes[0].find("bytes; allowed: at most"), std::string::npos) << notes[0];
  EXPECT_EQ(frames.losses().text(), "4 frames lost");
}

TEST(Recording, OfAPartOfTheBinsIsReplayed) {
  stream::StreamChoice choice;
  choice.format.window = {{2, 6, 2}, {1, 0, 1}};
  MadeRecording made;
  std::uint64_t sequence = 0;
  add_frame(made, 1, sequence, true, "main", 1, {choice});
  RecordedFrames frames(reader_of(made.bytes), "main", wire::kAllPlanes);
  client::RecordedFrame recorded;
  ASSERT_EQ(frames.next(recorded), RecordedFrames::Found::frame) << frames.note();
  EXPECT_EQ(recorded.frame.n_azimuth, 3);
  ASSERT_EQ(recorded.frame.power_w.size(), 3u * (kMadeRanges - 1));
  EXPECT_EQ(recorded.frame.power_w[0], made_power(1, 2, 1));
  EXPECT_TRUE(recorded.wedges.empty());
}

/// A disk that fails in the middle of a file.
class FailingDisk : public std::stringbuf {
 public:
  using std::stringbuf::stringbuf;
  std::streamsize xsgetn(char* to, std::streamsize n) override {
    const std::streamsize got = std::stringbuf::xsgetn(to, n);
    if (got < n) throw std::ios_base::failure("made to fail");
    return got;
  }
};

TEST(Recording, AFileThatCannotBeReadAnyFurtherIsNotTakenForOneThatWasCut) {
  FailingDisk disk(made_recording().bytes);
  RecordingReader reader(std::make_unique<std::istream>(&disk));
  ASSERT_EQ(reader.next(), RecordingReader::Found::damage);
  EXPECT_EQ(reader.fault().reason, "the file cannot be read any further");
  EXPECT_EQ(reader.next(), RecordingReader::Found::end);
}

TEST(Recording, WhatAScanningAntennaMissedIsAWedgeAtThePassesEnd) {
  MadeRecording made;
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder({.stream_id = 1, .frame_id = 1}, sequence);
  const auto add = [&](const stream::BlockPtr& block) { made.add(block->bytes, block->type, 1); };
  wire::FrameDescriptor descriptor;
  descriptor.set_radar("main");
  descriptor.mutable_settings()->set_azimuth_bins(kMadeAzimuths);
  descriptor.mutable_settings()->set_range_bins(kMadeRanges);
  for (const auto& block : encoder.begin(descriptor)) add(block);
  for (const auto& block : encoder.wedge(0, BinBlock(0, 8, kMadeRanges))) add(block);
  add(encoder.end({}, 0.001, {{8, kMadeAzimuths - 8}}));

  RecordedFrames frames(reader_of(made.bytes), "main", wire::kAllPlanes);
  client::RecordedFrame pass;
  ASSERT_EQ(frames.next(pass), RecordedFrames::Found::frame) << frames.note();
  ASSERT_EQ(pass.wedges.size(), 2u);
  EXPECT_EQ(pass.wedges[0].n_azimuth, 8u);
  EXPECT_EQ(pass.wedges[1].first_azimuth, 8u);
  EXPECT_EQ(pass.wedges[1].n_azimuth, static_cast<std::uint32_t>(kMadeAzimuths - 8));
  EXPECT_EQ(pass.wedges[1].utc_ns, pass.end_utc_ns);
}

TEST(Recording, FramesOfOtherRadarsAreCountedAndLeftOut) {
  MadeRecording made;
  std::uint64_t sequence = 0;
  add_frame(made, 1, sequence);
  std::uint64_t other_sequence = 0;
  add_frame(made, 9, other_sequence, true, "nose", 2);
  add_frame(made, 3, sequence);
  RecordedFrames frames(reader_of(made.bytes), "main", wire::kAllPlanes);
  client::RecordedFrame recorded;
  std::vector<std::uint64_t> ids;
  while (frames.next(recorded) == RecordedFrames::Found::frame) {
    ids.push_back(recorded.frame.descriptor->frame_id());
  }
  EXPECT_EQ(ids, (std::vector<std::uint64_t>{1, 3}));
  EXPECT_EQ(frames.frames_of_others(), 1u);

  client::RecordingStart start;
  ASSERT_TRUE(client::read_start(*reader_of(made.bytes), "nose", start).ok());
  EXPECT_EQ(start.radar, "nose");
  EXPECT_EQ(start.planes, wire::kAllPlanes);
  const client::Status none = client::read_start(*reader_of(made.bytes), "tail", start);
  EXPECT_EQ(none.outcome, client::Outcome::ok) << "a start that is known stays";
  client::RecordingStart nothing;
  EXPECT_EQ(client::read_start(*reader_of(made.bytes), "tail", nothing).outcome, client::Outcome::bad_stream);
}

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
}  // namespace obliq::test::recording_test
