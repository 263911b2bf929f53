// Stations that watch one radar, and what the others notice of one that reads nothing, of a hundred sockets
// that say nothing, and of a flood of HTTP requests: the time from the encoding of a block to its arrival,
// here of video, 512 x 512 bins, 30 frames a second, in one run. Rendering costs nothing.
//   stations_bench [SECONDS]
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/http/answering.h"
#include "server/http/http_server.h"
#include "server/net/io_thread.h"
#include "server/net/server.h"
#include "server/websocket/upgrade.h"
#include "tests/bench/numbers.h"
#include "tests/bench/prepared_renderer.h"
#include "tests/bench/readers.h"

namespace {

using namespace obliq;
using wire::MessageType;

constexpr int kBins = 512;
constexpr double kRate_hz = 30;

/// Watches until it is stopped; keeps the latency of each block.
class Station {
 public:
  explicit Station(std::unique_ptr<bench::Reader> reader) : reader_(std::move(reader)) {
    reader_->watch(kRate_hz, false);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const wire::MessageHeader header = reader_->read();
        if (header.type == MessageType::frame_end) ++frames_;
        if (header.type != MessageType::wedge_block) continue;
        const std::lock_guard lock(mutex_);
        latencies_ms_.push_back(static_cast<double>(wire::utc_now_ns() - header.utc_ns) * 1e-6);
      }
    });
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    latencies_ms_.clear();
    frames_ = 0;
  }
  std::vector<double> latencies_ms() {
    const std::lock_guard lock(mutex_);
    return latencies_ms_;
  }
  int frames() const { return frames_; }

 private:
  std::unique_ptr<bench::Reader> reader_;
  std::mutex mutex_;
  std::vector<double> latencies_ms_;
  std::atomic<int> frames_ = 0;
  std::jthread thread_;
};

/// Asks /healthz again and again on a connection of its own.
std::jthread flood(const client::Endpoint& http, std::atomic<std::uint64_t>& answered) {
  return std::jthread([http, &answered](const std::stop_token& stop) {
    const std::string request = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
    std::vector<std::byte> answer(4096);
    client::Socket socket;
    while (!stop.stop_requested()) {
      if (!socket.is_open() && !client::Socket::connect(http, client::Timeout(1000), socket).ok()) continue;
      std::string got;
      bool good = socket.send(std::as_bytes(std::span(request)), client::Timeout(1000)).ok();
      while (good && !got.ends_with("ok\n")) {
        char one = 0;
        good = socket.receive(std::as_writable_bytes(std::span(&one, 1)), client::Timeout(1000)).ok();
        got += one;
      }
      if (good) ++answered;
      if (!good) socket.close();
    }
  });
}

}  // namespace

int main(int argc, char** argv) {
  const int seconds = std::clamp(argc > 1 ? std::atoi(argv[1]) : 10, 1, 3600);
  spdlog::set_level(spdlog::level::err);
  RadarConfig radar;
  radar.name = "main";
  radar.settings.azimuth_bins = radar.settings.range_bins = kBins;
  const bench::PreparedRenderer renderer(kBins);
  net::IoThread io;
  net::ServerOptions options;
  options.max_clients_per_address = options.max_clients = 1000;
  net::Server server(io.context(), renderer, {radar}, options, net::ReservedPort("127.0.0.1", 0));
  http::HttpOptions http_options;
  http_options.max_connections = http_options.max_connections_per_address = 1000;
  http::HttpServer http(io.context(), http_options, {{"/healthz", true, http::health_page}},
                        websocket::upgrade(
                            io.context(), [&] { return &server; }, [] { return http::error_page(503, ""); }));
  server.start([&] {
    http.stop();
    io.release();
  });
  const client::Endpoint tcp{"127.0.0.1", server.port()}, web{"127.0.0.1", http.port()};

  std::vector<std::unique_ptr<Station>> stations;
  for (int i = 0; i < 2; ++i)
    stations.push_back(std::make_unique<Station>(std::make_unique<bench::WebReader>(web)));
  stations.push_back(std::make_unique<Station>(std::make_unique<bench::TcpReader>(tcp)));
  const auto measure = [&](const char* what) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    for (const auto& station : stations) station->forget();
    std::this_thread::sleep_for(std::chrono::seconds(seconds));
    std::vector<double> all;
    int frames = 0;
    for (const auto& station : stations) {
      const std::vector<double> own = station->latencies_ms();
      all.insert(all.end(), own.begin(), own.end());
      frames += station->frames();
    }
    std::printf("%-46s median %.2f ms, 99 %% %.2f ms, %.1f frames/s each\n", what, bench::quantile(all, 0.5),
                bench::quantile(all, 0.99), frames / 3.0 / seconds);
    std::fflush(stdout);
  };
  std::printf(
      "blocks of %d x %d bins of video at %.0f frames/s, two stations over WebSockets and one over TCP:\n",
      kBins, kBins, kRate_hz);
  for (int round = 0; round < 2; ++round) {
    measure("alone:");
    {
      bench::WebReader stalled(web);
      stalled.watch(kRate_hz, false);
      measure("with a fourth that reads nothing:");
    }
    {
      std::vector<client::Socket> idle(100);
      for (client::Socket& socket : idle)
        if (!client::Socket::connect(web, client::Timeout(1000), socket).ok()) return 1;
      measure("with 100 sockets that say nothing:");
    }
    std::atomic<std::uint64_t> answered = 0;
    {
      std::vector<std::jthread> floods;
      for (int i = 0; i < 4; ++i) floods.push_back(flood(web, answered));
      measure("with four that ask /healthz without a pause:");
    }
    std::printf("(%llu answers)\n", static_cast<unsigned long long>(answered.load()));
  }
  stations.clear();
  server.stop();
  io.join();
  return 0;
}
