// A recording's bytes.
#include <sstream>
#include <string>

#include "client/recording/recorded_frames.h"
#include "proto/obliq.pb.h"
#include "tests/fuzz/input.h"

namespace obliq {
namespace {

const fuzz::QuietProtobuf kQuiet;
constexpr std::uint64_t kMostFrameBytes = 1u << 20;

std::unique_ptr<client::RecordingReader> reader_of(const std::string& bytes) {
  return std::make_unique<client::RecordingReader>(std::make_unique<std::istringstream>(bytes));
}

void check(const client::RecordedFrame& recorded) {
  if (!recorded.frame.descriptor || !recorded.frame.summary) fuzz::broken("a frame without its parts");
  std::uint64_t azimuths = 0;
  for (const client::RecordedWedge& wedge : recorded.wedges) {
    azimuths += wedge.n_azimuth;
    if (wedge.first_azimuth + std::uint64_t{wedge.n_azimuth} >
        static_cast<std::uint64_t>(recorded.frame.n_azimuth)) {
      fuzz::broken("a wedge reaches out of its frame");
    }
  }
  if (!recorded.wedges.empty() && azimuths != static_cast<std::uint64_t>(recorded.frame.n_azimuth)) {
    fuzz::broken("wedges do not make a frame");
  }
}

}  // namespace
}  // namespace obliq

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace obliq;
  const wire::Bytes raw = fuzz::stream_of(data, size);
  const std::string bytes(reinterpret_cast<const char*>(raw.data()), raw.size());

  // Every byte is in a message, in damage, or left over.
  const auto reader = reader_of(bytes);
  std::uint64_t accounted = 0;
  for (auto found = reader->next();; found = reader->next()) {
    accounted +=
        found == client::RecordingReader::Found::message ? reader->message().size : reader->fault().bytes;
    if (found == client::RecordingReader::Found::end) break;
  }
  if (accounted != bytes.size()) fuzz::broken("bytes of a recording are lost");

  client::RecordingStart start;
  if (!client::read_start(*reader_of(bytes), "", start).ok()) return 0;
  client::RecordedFrames frames(reader_of(bytes), start.radar, start.planes, kMostFrameBytes);
  for (;;) {
    client::RecordedFrame recorded;
    const auto found = frames.next(recorded);
    if (found == client::RecordedFrames::Found::frame) check(recorded);
    if (found == client::RecordedFrames::Found::end) break;
  }
  return 0;
}
