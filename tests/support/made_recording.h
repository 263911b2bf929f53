#pragma once
// A small recording made message by message, and where each of them lies.
#include <cstdint>
#include <string>
#include <vector>

#include "proto/message_codec.h"
#include "server/stream/stream_choice.h"

namespace obliq::test {

struct MadeMessage {
  std::size_t begin = 0;
  std::size_t end = 0;
  wire::MessageType type{};
  std::uint64_t frame_id = 0;  ///< 0: of no frame
};

struct MadeRecording {
  std::string bytes;
  std::vector<MadeMessage> messages;

  void add(const wire::Bytes& message, wire::MessageType type, std::uint64_t frame_id = 0);
};

constexpr int kMadeAzimuths = 10;  // a whole wedge and a part of one
constexpr int kMadeRanges = 3;

/// The value of a bin's power.
double made_power(std::uint64_t frame_id, int azimuth, int range);

/// Adds a frame of radar "main"; `whole` false: ended by a FrameAbort after its first wedge. choices: how its
/// blocks are made; none: as floats, and all of them.
void add_frame(MadeRecording& recording, std::uint64_t frame_id, std::uint64_t& sequence, bool whole = true,
               const std::string& radar = "main", std::uint32_t stream_id = 1,
               const std::vector<stream::StreamChoice>& choices = {}, std::int64_t sim_time_ns = 0);

/// Gives a message another time in its header, and the checksum that belongs to it.
void set_time(MadeRecording& recording, std::size_t message, std::int64_t utc_ns);

/// Frames 1 to n, so far apart, the first at kMadeStart_ns: a frame's two wedges come after a third and two
/// thirds of the time to the next, and its end just before that. The poses' own clock is at 1000 s when the
/// first begins.
constexpr std::int64_t kMadeStart_ns = 1'767'225'600'000'000'000;
constexpr std::int64_t kMadeSimStart_ns = 1'000'000'000'000;
MadeRecording timed_recording(int frames, std::int64_t step_ns);

/// Welcome, frame 1, frame 2 (aborted), frame 3, frame 4.
MadeRecording made_recording();

}  // namespace obliq::test
