// Throughput of the stream over the loopback, beside a bare socket loop that sends frames in blocks of the
// same size in the same run: from memory, as frames come, and not one block from the nearest cache. Rendering
// costs nothing here: the bins are prepared, and every frame is encoded and sent anew.
//   stream_bench [ROUNDS]
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <thread>
#include <vector>

#include "client/client.h"
#include "client/socket.h"
#include "proto/obliq.pb.h"
#include "server/net/server.h"
#include "tests/bench/stream/prepared_renderer.h"

namespace {

using namespace obliq;
using Clock = std::chrono::steady_clock;

constexpr int kBins = 2048;
constexpr std::size_t kBlockBytes = std::size_t{kWedgeAzimuthBins} * kBins * sizeof(std::complex<float>);
constexpr std::size_t kFrameBytes = std::size_t{kBins} * kBins * sizeof(std::complex<float>);
constexpr int kFrames = 60;
constexpr client::Timeout kLong{60000};

void check(const client::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "stream_bench: %s\n", status.sentence().c_str());
  std::exit(1);
}

/// Reads and drops; MB/s over all but the first frame's bytes, which let the connection warm up.
double drain_MB_s(client::Socket& socket, std::size_t bytes) {
  std::vector<std::byte> buffer(kBlockBytes);
  const auto read = [&](std::size_t n) {
    for (std::size_t done = 0; done < n; done += buffer.size()) check(socket.receive(buffer, kLong));
  };
  read(kFrameBytes);
  const auto start = Clock::now();
  read(bytes);
  return static_cast<double>(bytes) * 1e-6 / std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of the whole process: server and client.
double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// What one of the measurements takes; other work on the machine shows in the rate more than in the seconds.
struct Measured {
  double MB_s = 0;
  double processor_s = 0;
};
template <typename Function>
Measured measured(Function function) {
  const double before = processor_s();
  Measured result;
  result.MB_s = function();
  result.processor_s = processor_s() - before;
  return result;
}

double bare_MB_s() {
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (::bind(listener, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener, 1) != 0 ||
      ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    std::exit(1);
  std::jthread sender([&](const std::stop_token& stop) {
    const int to = ::accept(listener, nullptr, nullptr);
    const int on = 1;
    (void)::setsockopt(to, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    const std::vector<std::byte> frame(kFrameBytes, std::byte{1});
    for (std::size_t block = 0; !stop.stop_requested(); block = (block + kBlockBytes) % kFrameBytes) {
      for (std::size_t sent = 0; sent < kBlockBytes;) {
        const ssize_t n = ::send(to, frame.data() + block + sent, kBlockBytes - sent, MSG_NOSIGNAL);
        if (n <= 0) break;
        sent += static_cast<std::size_t>(n);
      }
    }
    ::close(to);
  });
  double rate = 0;
  {
    client::Socket socket;
    check(client::Socket::connect({"127.0.0.1", ntohs(address.sin_port)}, kLong, socket));
    rate = drain_MB_s(socket, kFrames * kFrameBytes);
    sender.request_stop();
  }
  sender.join();
  ::close(listener);
  return rate;
}

void send_message(client::Socket& socket, wire::MessageType type,
                  const google::protobuf::MessageLite& message) {
  check(socket.send(wire::encode_message(type, {0, 1, wire::utc_now_ns()}, message), kLong));
}

wire::Subscribe request() {
  wire::Subscribe request;
  request.set_request_id(2);
  request.set_radar("main");
  request.set_rate_hz(10000);  // as fast as it goes
  request.set_lossless(true);
  request.add_planes(wire::IQ);
  return request;
}

double stream_MB_s(const client::Endpoint& endpoint) {
  client::Socket socket;
  check(client::Socket::connect(endpoint, kLong, socket));
  wire::Hello hello;
  hello.set_major(wire::kMajorVersion);
  send_message(socket, wire::MessageType::hello, hello);
  send_message(socket, wire::MessageType::subscribe, request());
  return drain_MB_s(socket, kFrames * kFrameBytes);
}

/// With the client library, which parses every message and checks its CRC.
double library_MB_s(const client::Endpoint& endpoint) {
  client::Client client;
  check(client.connect(endpoint));
  struct Counter : client::FrameHandler {
    std::size_t bytes = 0;
    client::Status on_block(const wire::MessageHeader&, const wire::WedgeBlock&,
                            std::span<const std::byte> plane) override {
      bytes += plane.size();
      return {};
    }
  } counter;
  client.set_handler(&counter);
  wire::Subscribe subscription = request();
  check(client.subscribe(subscription));
  while (counter.bytes < kFrameBytes) check(client.receive(kLong));
  counter.bytes = 0;
  const auto start = Clock::now();
  while (counter.bytes < kFrames * kFrameBytes) check(client.receive(kLong));
  return static_cast<double>(counter.bytes) * 1e-6 /
         std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = std::clamp(argc > 1 ? std::atoi(argv[1]) : 5, 1, 1000);
  net::ServerOptions options;
  options.port = 0;
  options.max_rate_hz = 10000;
  RadarConfig radar;
  radar.name = "main";
  radar.settings.azimuth_bins = kBins;
  radar.settings.range_bins = kBins;
  const bench::PreparedRenderer renderer(kBins);
  net::Server server(renderer, {radar}, options);
  std::thread running([&] { server.run(); });

  std::printf("frames of %d x %d bins of I&Q, cf32_le, in blocks of %zu bytes; %u processors\n", kBins, kBins,
              kBlockBytes, std::thread::hardware_concurrency());
  std::vector<double> stream_ratio;
  std::vector<double> library_ratio;
  for (int round = 0; round < rounds; ++round) {
    const client::Endpoint endpoint{"127.0.0.1", server.port()};
    const Measured bare = measured(bare_MB_s);
    const Measured stream = measured([&] { return stream_MB_s(endpoint); });
    const Measured library = measured([&] { return library_MB_s(endpoint); });
    stream_ratio.push_back(stream.MB_s / bare.MB_s);
    library_ratio.push_back(library.MB_s / bare.MB_s);
    std::printf(
        "bare %.0f MB/s (%.2f s of processor), stream %.0f MB/s (%.0f %%, %.2f s), client library with CRC "
        "%.0f "
        "MB/s (%.0f %%, %.2f s)\n",
        bare.MB_s, bare.processor_s, stream.MB_s, 100 * stream_ratio.back(), stream.processor_s, library.MB_s,
        100 * library_ratio.back(), library.processor_s);
    std::fflush(stdout);
  }
  std::printf("median of %d: stream %.0f %%, client library %.0f %% of the bare socket loop\n", rounds,
              100 * median(stream_ratio), 100 * median(library_ratio));
  server.stop();
  running.join();
  return 0;
}
