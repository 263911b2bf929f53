// Frames of a server, recorded as they come and read again: station HOST:PORT FRAMES FILE [CA_FILE]
// Prints a line a frame, with sums of its planes, that is the same wherever it runs. CA_FILE: by TLS.
#include <obliq/client/client.h>
#include <obliq/client/frame_assembler.h>
#include <obliq/client/recording/recorded_frames.h>
#include <obliq/client/recording/recording_writer.h>
#include <obliq/proto/obliq.pb.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace obliq;

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
template <class Value>
unsigned long long sum_of(const std::vector<Value>& values) {
  unsigned long long sum = 0xcbf29ce484222325;
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  for (std::size_t i = 0; i < values.size() * sizeof(Value); ++i) sum = (sum ^ bytes[i]) * 0x100000001b3;
  return sum;
}

std::string line_of(const client::AssembledFrame& frame) {
  char text[200];
  std::snprintf(text, sizeof text, "%d x %d iq %016llx power %016llx state %016llx", frame.n_azimuth,
                frame.n_range, sum_of(frame.iq), sum_of(frame.power_w), sum_of(frame.state));
  return text;
}

client::Status watched(const client::Endpoint& endpoint, const std::string& ca_file, std::size_t count,
                       client::RecordingWriter& writer, std::vector<std::string>& lines) {
  client::Client server;
  client::FrameAssembler frames;
  client::ClientOptions options{.name = "station"};
  if (!ca_file.empty()) options.tls = {.enabled = true, .ca_file = ca_file};
  if (client::Status status = server.connect(endpoint, options); !status.ok()) return status;
  if (client::Status status = writer.write(server.welcome_bytes(), {}); !status.ok()) return status;
  server.set_handler(&frames);
  server.set_tap([&](const client::Message& message) {
    return lines.size() < count ? writer.write(message.header_bytes(), message.payload) : client::Status{};
  });
  if (client::Status status = server.subscribe(server.welcome().radars(0), 10); !status.ok()) return status;
  while (lines.size() < count) {
    if (client::Status status = server.receive(client::Timeout(30000)); !status.ok()) return status;
    if (frames.state() == client::FrameAssembler::State::complete) lines.push_back(line_of(frames.take()));
  }
  return writer.close();
}

client::Status read_again(const std::string& path, std::vector<std::string>& lines) {
  std::unique_ptr<client::RecordingReader> reader;
  client::RecordingStart start;
  if (client::Status status = client::RecordingReader::open(path, reader); !status.ok()) return status;
  if (client::Status status = client::read_start(*reader, "", start); !status.ok()) return status;
  reader->seek(0);
  client::RecordedFrames recording(std::move(reader), start.radar, wire::kAllPlanes);
  client::RecordedFrame frame;
  for (auto found = recording.next(frame); found != client::RecordedFrames::Found::end;
       found = recording.next(frame))
    lines.push_back(found == client::RecordedFrames::Found::frame ? line_of(frame.frame) : recording.note());
  return {};
}

int fail(const client::Status& status) {
  std::fprintf(stderr, "station: %s\n", status.sentence().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto endpoint = client::parse_endpoint(argc > 3 ? argv[1] : "no address");
  if (!endpoint) {
    std::fprintf(stderr, "usage: station HOST:PORT FRAMES FILE [CA_FILE]\n");
    return 2;
  }
  const auto count = static_cast<std::size_t>(std::max(1, std::atoi(argv[2])));
  std::vector<std::string> live;
  client::RecordingWriter writer;
  if (client::Status status = writer.open(argv[3], true); !status.ok()) return fail(status);
  if (client::Status status = watched(*endpoint, argc > 4 ? argv[4] : "", count, writer, live); !status.ok())
    return fail(status);
  std::vector<std::string> recorded;
  if (client::Status status = read_again(argv[3], recorded); !status.ok()) return fail(status);
  for (const std::string& line : live) std::printf("%s\n", line.c_str());
  if (recorded == live) return 0;
  std::fprintf(stderr, "station: the recording has %zu frames, other than the %zu that came\n",
               recorded.size(), live.size());
  return 1;
}
