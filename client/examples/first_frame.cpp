// The smallest useful client: watch a radar until one frame is complete and print what it holds.
//   first_frame HOST:PORT [RADAR]
#include <cstdio>

#include "client/client.h"
#include "client/frame_assembler.h"
#include "proto/obliq.pb.h"

namespace {

int fail(const obliq::client::Status& status) {
  std::fprintf(stderr, "first_frame: %s\n", status.sentence().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace obliq;
  const auto endpoint = client::parse_endpoint(argc > 1 ? argv[1] : "127.0.0.1");
  if (!endpoint) {
    std::fprintf(stderr, "usage: first_frame HOST:PORT [RADAR]\n");
    return 2;
  }

  client::Client server;
  if (auto status = server.connect(*endpoint, {.name = "first_frame"}); !status.ok()) return fail(status);
  if (server.welcome().radars_size() == 0) return 1;
  const std::string radar = argc > 2 ? argv[2] : server.welcome().radars(0);

  client::FrameAssembler frames;
  server.set_handler(&frames);
  if (auto status = server.subscribe(radar, 1.0); !status.ok()) return fail(status);
  while (frames.state() != client::FrameAssembler::State::complete) {
    if (auto status = server.receive(client::Timeout(30000)); !status.ok()) return fail(status);
  }

  const client::AssembledFrame frame = frames.take();
  double power_w = 0;
  for (const double bin : frame.power_w) power_w += bin;
  std::printf("%s: %d x %d bins, %.3g W in all\n", radar.c_str(), frame.n_azimuth, frame.n_range, power_w);
  return 0;
}
