// Seeds of streams with trains of pulses.
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/stream/frame_encoder.h"
#include "tests/fuzz/make_seeds.h"

namespace obliq::fuzz {

/// A frame of two trains of pulses.
void write_trains() {
  wire::FrameDescriptor descriptor;
  descriptor.set_radar("main");
  descriptor.mutable_settings()->set_azimuth_bins(16);
  descriptor.mutable_settings()->set_range_bins(24);
  descriptor.mutable_settings()->set_doppler_pulses(4);
  stream::StreamChoice choice;
  choice.planes = wire::kPulsesPlane;
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder({.stream_id = 1, .frame_id = 1, .choices = {choice}}, sequence);
  std::string bytes;
  const auto add = [&](const std::vector<stream::BlockPtr>& blocks) {
    for (const stream::BlockPtr& block : blocks)
      bytes.append(reinterpret_cast<const char*>(block->bytes.data()), block->bytes.size());
  };
  add(encoder.begin(descriptor));
  for (const int first : {0, 8})
    add(encoder.train(
        {{first, 8}, 4, 24, {1e6, 1.5e6}, 3, 30, std::vector<std::complex<float>>(96, {1, 2})}));
  add({encoder.end({}, 0)});
  write_seed("framing", "trains", kMended + bytes);
  write_seed("recording", "trains", kMended + bytes);
}

}  // namespace obliq::fuzz
