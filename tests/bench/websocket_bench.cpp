// Video over a WebSocket beside TCP, in one run: frames a second and processor time of one server and one
// client that reads and drops. Rendering costs nothing: the bins are prepared. Also what one descriptor costs
// as JSON, by our writer and by protobuf's.
//   websocket_bench [ROUNDS]
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "client/socket.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/http/answering.h"
#include "server/http/http_server.h"
#include "server/net/io_thread.h"
#include "server/net/server.h"
#include "server/websocket/json_message.h"
#include "server/websocket/json_writer.h"
#include "server/websocket/upgrade.h"

namespace {

using namespace obliq;
using Clock = std::chrono::steady_clock;
using wire::MessageType;

constexpr int kBins = 1024;
constexpr int kFrames = 100;
constexpr client::Timeout kLong{60000};

/// Wedges that were rendered long ago.
class PreparedFrame : public net::PlannedFrame {
 public:
  PreparedFrame(SettingsPtr settings, Wedge& wedge) : settings_(std::move(settings)), wedge_(wedge) {}
  void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const override {
    descriptor.set_radar(radar);
    write_message(settings_->settings, *descriptor.mutable_settings());
  }
  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    for (int first = azimuths.first; first < azimuths.first + azimuths.count; first += kWedgeAzimuthBins) {
      if (options.stop.stop_requested()) return false;
      wedge_.index = first / kWedgeAzimuthBins;
      wedge_.bins.first_azimuth = first;
      options.on_wedge(std::move(wedge_));  // who receives it reads only
    }
    return true;
  }
  void summarise(const FrameStats&, wire::FrameSummary&) const override {}

 private:
  SettingsPtr settings_;
  Wedge& wedge_;
};

class PreparedRenderer : public net::FrameRenderer {
 public:
  PreparedRenderer() {
    wedge_.bins = BinBlock(0, kWedgeAzimuthBins, kBins);
    wedge_.bins.video8.assign(wedge_.bins.iq.size(), 100);
  }
  std::vector<FieldError> place(const PoseSettings&) const override { return {}; }
  Plan plan(const SettingsPtr& settings, const PoseSettings&) const override {
    Plan plan;
    plan.frame = std::make_unique<PreparedFrame>(settings, wedge_);
    return plan;
  }

 private:
  mutable Wedge wedge_;
};

void check(const client::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "websocket_bench: %s\n", status.sentence().c_str());
  std::exit(1);
}

/// A connection that sends two requests and reads messages.
class Reader {
 public:
  explicit Reader(const client::Endpoint& server) { check(client::Socket::connect(server, kLong, socket_)); }
  virtual ~Reader() = default;
  virtual void send(MessageType type, const google::protobuf::Message& message) = 0;
  virtual MessageType read() = 0;

 protected:
  MessageType type_of(std::span<const std::byte> bytes) const {
    wire::MessageHeader header;
    if (wire::decode_header(bytes.first<wire::kHeaderBytes>(), wire::kMaxPayloadBytes, header) !=
        wire::HeaderStatus::ok)
      std::exit(1);
    return header.type;
  }
  client::Socket socket_;
  std::vector<std::byte> buffer_ = std::vector<std::byte>(2 << 20);
};

class TcpReader : public Reader {
 public:
  using Reader::Reader;
  void send(MessageType type, const google::protobuf::Message& message) override {
    check(socket_.send(wire::encode_message(type, {}, message), kLong));
  }
  MessageType read() override {
    const std::span all(buffer_);
    check(socket_.receive(all.first(wire::kHeaderBytes), kLong));
    wire::MessageHeader header;
    if (wire::decode_header(all.first<wire::kHeaderBytes>(), wire::kMaxPayloadBytes, header) !=
        wire::HeaderStatus::ok)
      std::exit(1);
    check(socket_.receive(all.first(header.payload_length), kLong));
    return header.type;
  }
};

/// RFC 6455 as far as it is needed.
class WebReader : public Reader {
 public:
  explicit WebReader(const client::Endpoint& server) : Reader(server) {
    const std::string request =
        "GET /stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Protocol: obliq.v1.json\r\n\r\n";
    check(socket_.send(std::as_bytes(std::span(request)), kLong));
    std::string answer;
    for (char one = 0; !answer.ends_with("\r\n\r\n"); answer += one)
      check(socket_.receive(std::as_writable_bytes(std::span(&one, 1)), kLong));
  }
  void send(MessageType type, const google::protobuf::Message& message) override {
    websocket::JsonMessage json;
    if (!websocket::to_json(wire::encode_message(type, {}, message), json)) std::exit(1);
    // Masked with 0. The length has as few bytes as it needs (RFC 6455 section 5.2).
    const std::size_t n = json.head.size();
    std::string frame = "\x82";
    if (n < 126) {
      frame += static_cast<char>(0x80 | n);
    } else {
      frame += {'\xfe', static_cast<char>(n >> 8), static_cast<char>(n & 0xff)};
    }
    frame.append(4, '\0');
    frame += json.head;
    check(socket_.send(std::as_bytes(std::span(frame)), kLong));
  }
  MessageType read() override {
    const std::span all(buffer_);
    check(socket_.receive(all.first(2), kLong));
    std::size_t n = std::to_integer<std::size_t>(all[1]);
    if (n >= 126) {
      const std::size_t digits = n == 126 ? 2 : 8;
      check(socket_.receive(all.first(digits), kLong));
      n = 0;
      for (std::size_t i = 0; i < digits; ++i) n = n << 8 | std::to_integer<std::size_t>(all[i]);
    }
    check(socket_.receive(all.first(n), kLong));
    return type_of(all);
  }
};

struct Measured {
  double frames_s = 0;
  double processor_ms = 0;  ///< of a frame: server and client
};

Measured measure(Reader& reader) {
  wire::Hello hello;
  hello.set_major(wire::kMajorVersion);
  reader.send(MessageType::hello, hello);
  wire::Subscribe request;
  request.set_request_id(2);
  request.set_radar("main");
  request.set_rate_hz(10000);  // as fast as it goes
  request.set_lossless(true);
  request.add_planes(wire::VIDEO);
  reader.send(MessageType::subscribe, request);
  const auto frames = [&](int n) {
    while (n > 0)
      if (reader.read() == MessageType::frame_end) --n;
  };
  frames(5);
  const auto start = Clock::now();
  const std::clock_t before = std::clock();
  frames(kFrames);
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
  const double processor_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  return {kFrames / elapsed_s, 1000 * processor_s / kFrames};
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
    websocket::append_json(block, text);
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
  net::ServerOptions options;
  options.max_rate_hz = 10000;
  RadarConfig radar;
  radar.name = "main";
  radar.settings.azimuth_bins = kBins;
  radar.settings.range_bins = kBins;
  const PreparedRenderer renderer;
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
      TcpReader reader({"127.0.0.1", server.port()});
      tcp = measure(reader);
    }
    {
      WebReader reader({"127.0.0.1", http.port()});
      web = measure(reader);
    }
    std::printf(
        "TCP %.0f frames/s, %.2f ms of processor a frame; WebSocket %.0f frames/s (%.0f %%), %.2f ms\n",
        tcp.frames_s, tcp.processor_ms, web.frames_s, 100 * web.frames_s / tcp.frames_s, web.processor_ms);
    std::fflush(stdout);
  }
  server.stop();
  io.join();
  return 0;
}
