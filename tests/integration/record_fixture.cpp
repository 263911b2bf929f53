#include "tests/integration/record_fixture.h"

#include "proto/obliq.pb.h"

namespace obliq::test {

std::map<std::uint64_t, client::AssembledFrame> frames_of(const std::string& file, wire::PlaneSet planes) {
  std::map<std::uint64_t, client::AssembledFrame> all;
  std::unique_ptr<client::RecordingReader> reader;
  EXPECT_TRUE(client::RecordingReader::open(file, reader).ok());
  client::RecordedFrames frames(std::move(reader), "main", planes);
  client::RecordedFrame recorded;
  for (auto found = frames.next(recorded); found != client::RecordedFrames::Found::end;
       found = frames.next(recorded)) {
    if (found != client::RecordedFrames::Found::frame) continue;
    all[recorded.frame.descriptor->frame_id()] = std::move(recorded.frame);
  }
  return all;
}

}  // namespace obliq::test
