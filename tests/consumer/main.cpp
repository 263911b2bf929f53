// One frame by the installed library: consumer HOST:PORT
#include <obliq/client/client.h>
#include <obliq/client/frame_assembler.h>
#include <obliq/proto/obliq.pb.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace obliq;
  const auto endpoint = client::parse_endpoint(argc > 1 ? argv[1] : "");
  if (!endpoint) return 2;
  client::Client server;
  client::FrameAssembler frames;
  server.set_handler(&frames);
  client::Status status = server.connect(*endpoint);
  if (status.ok()) status = server.subscribe(server.welcome().radars(0), 10);
  while (status.ok() && frames.state() != client::FrameAssembler::State::complete)
    status = server.receive(client::Timeout(30000));
  if (!status.ok()) {
    std::fprintf(stderr, "%s\n", status.sentence().c_str());
    return 1;
  }
  const client::AssembledFrame frame = frames.take();
  std::printf("%d x %d bins of %s\n", frame.n_azimuth, frame.n_range, frame.descriptor->radar().c_str());
  return 0;
}
