// Video over a WebSocket beside TCP, in one run: frames a second and processor time of one server and one
// client that reads and drops. Rendering costs nothing: the bins are prepared. Also what one descriptor costs
// as JSON, by our writer and by protobuf's, and what a message to one of several browsers costs the io
// thread.
//   websocket_bench [ROUNDS]
#include <google/protobuf/util/json_util.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <barrier>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/http/answering.h"
#include "server/http/http_server.h"
#include "server/net/io_thread.h"
#include "server/net/server.h"
#include "server/websocket/upgrade.h"
#include "tests/bench/stream/prepared_renderer.h"
#include "tests/bench/stream/readers.h"

namespace {

using namespace obliq;
using Clock = std::chrono::steady_clock;
using wire::MessageType;

constexpr int kBins = 1024;
constexpr int kFrames = 100;

struct Measured {
  double frames_s = 0;
  double processor_ms = 0;  ///< of a frame: server and client
};

void read_frames(bench::Reader& reader, int n) {
  while (n > 0)
    if (reader.read().type == MessageType::frame_end) --n;
}

Measured measure(bench::Reader& reader) {
  reader.watch(10000, true);  // as fast as it goes
  read_frames(reader, 5);
  const auto start = Clock::now();
  const std::clock_t before = std::clock();
  read_frames(reader, kFrames);
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
  const double processor_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  return {kFrames / elapsed_s, 1000 * processor_s / kFrames};
}

/// Processor time of the io thread so far.
double io_s(net::IoThread& io) {
  std::promise<double> told;
  io.post([&] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    told.set_value(static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec));
  });
  return told.get_future().get();
}

/// Of the io thread, microseconds for each message to each of n readers that watch together.
template <class Reader>
double io_us(net::IoThread& io, const client::Endpoint& server, int n) {
  constexpr int kMessages = kBins / kWedgeAzimuthBins + 2;
  std::barrier together(n + 1);
  std::vector<std::thread> readers;
  for (int i = 0; i < n; ++i)
    readers.emplace_back([&] {
      Reader reader(server);
      reader.watch(10000, true);
      read_frames(reader, 5);
      together.arrive_and_wait();
      read_frames(reader, kFrames);
      together.arrive_and_wait();
    });
  together.arrive_and_wait();
  const double before_s = io_s(io);
  together.arrive_and_wait();
  const double spent_s = io_s(io) - before_s;
  for (std::thread& reader : readers) reader.join();
  return 1e6 * spent_s / (double{kFrames} * kMessages * n);
}

template <class Write>
double microseconds(Write write) {
  constexpr int kTimes = 20000;
  const std::clock_t before = std::clock();
  for (int i = 0; i < kTimes; ++i) write();
  return 1e6 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC / kTimes;
}

void measure_json() {
  wire::WedgeBlock block;
  block.set_frame_id(123456);
  block.set_plane(wire::VIDEO);
  block.set_first_azimuth(8);
  block.set_n_azimuth(8);
  block.set_n_range(kBins);
  block.set_wedge_index(1);
  block.set_pose_received_ns(123456789012345);
  block.set_render_start_ns(123456789012345);
  block.set_send_ns(123456789012345);
  auto& pose = *block.mutable_pose();
  pose.set_latitude_deg(34.123456789);
  pose.set_longitude_deg(-118.123456789);
  pose.set_height_m(2500.25);
  pose.set_bearing_deg(11.0625);
  std::string text;
  const double ours = microseconds([&] {
    text.clear();
    wire::append_json(block, text);
  });
  const double theirs = microseconds([&] {
    text.clear();
    (void)google::protobuf::util::MessageToJsonString(block, &text);
  });
  std::printf(
      "descriptor of a block as JSON: %.2f us of processor, protobuf's own writer %.2f us (%zu bytes)\n",
      ours, theirs, text.size());
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = std::clamp(argc > 1 ? std::atoi(argv[1]) : 3, 1, 1000);
  spdlog::set_level(spdlog::level::err);
  net::ServerOptions options;
  options.max_rate_hz = 10000;
  RadarConfig radar;
  radar.name = "main";
  radar.settings.azimuth_bins = kBins;
  radar.settings.range_bins = kBins;
  const bench::PreparedRenderer renderer(kBins);
  net::IoThread io;
  net::Server server(io.context(), renderer, {radar}, options, net::ReservedPort("127.0.0.1", 0));
  http::HttpServer http(io.context(), {}, {},
                        websocket::upgrade(
                            io.context(), [&] { return &server; }, [] { return http::error_page(503, ""); }));
  server.start([&] {
    http.stop();
    io.release();
  });
  measure_json();
  std::printf("video of %d x %d bins, 8 bits, 128 blocks a frame:\n", kBins, kBins);
  for (int round = 0; round < rounds; ++round) {
    Measured tcp, web;
    {
      bench::TcpReader reader({"127.0.0.1", server.port()});
      tcp = measure(reader);
    }
    {
      bench::WebReader reader({"127.0.0.1", http.port()});
      web = measure(reader);
    }
    std::printf(
        "TCP %.0f frames/s, %.2f ms of processor a frame; WebSocket %.0f frames/s (%.0f %%), %.2f ms\n",
        tcp.frames_s, tcp.processor_ms, web.frames_s, 100 * web.frames_s / tcp.frames_s, web.processor_ms);
    std::fflush(stdout);
  }
  for (const int n : {1, 8}) {
    const double tcp = io_us<bench::TcpReader>(io, {"127.0.0.1", server.port()}, n);
    const double web = io_us<bench::WebReader>(io, {"127.0.0.1", http.port()}, n);
    std::printf("io thread, a message to each of %d: %.2f us over TCP, %.2f over WebSockets\n", n, tcp, web);
  }
  server.stop();
  io.join();
  return 0;
}
