#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "client/socket.h"
#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"
#include "server/radar/frame_plan.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/render.h"
#include "server/stream/frame_encoder.h"
#include "server/timing/timing.h"
#include "terrain/base/errors.h"
#include "terrain/base/files.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kFewestPairs = 5;
constexpr int kMostPairs = 31;
constexpr double kLongEnough_s = 4;

/// Of the whole process.
double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

constexpr client::Timeout kLong{60000};

[[noreturn]] void refuse(const std::string& why) {
  throw InputError("loopback: found " + why + "; allowed: a connection to 127.0.0.1");
}

void check(const client::Status& status) {
  if (!status.ok()) refuse(status.sentence());
}

/// A TCP connection over the loopback, to a thread of this process that reads and drops. One thread sends at
/// a time.
class Loopback {
 public:
  /// Throws InputError where there is no loopback.
  Loopback();
  ~Loopback();
  Loopback(const Loopback&) = delete;
  Loopback& operator=(const Loopback&) = delete;

  /// Returns when the system has the bytes.
  void send(std::span<const std::byte> bytes);
  /// Returns when the reader has all that was sent.
  void drain() const;

 private:
  void read();

  UniqueFd reader_end_;
  client::Socket socket_;
  std::uint64_t sent_ = 0;
  std::atomic<std::uint64_t> received_{0};
  std::jthread reader_;  ///< last: it ends when the socket is closed
};

Loopback::Loopback() {
  const UniqueFd listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  if (::bind(listener.get(), any, size) == 0 && ::listen(listener.get(), 1) == 0 &&
      ::getsockname(listener.get(), any, &size) == 0 &&
      client::Socket::connect({"127.0.0.1", ntohs(address.sin_port)}, kLong, socket_).ok())
    reader_end_.reset(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
  if (!reader_end_) refuse(std::strerror(errno));
  reader_ = std::jthread([this] { read(); });
}

Loopback::~Loopback() {
  socket_.close();
  reader_.join();
}

void Loopback::read() {
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  for (;;) {
    const ssize_t n = ::read(reader_end_.get(), buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    received_ += static_cast<std::uint64_t>(n);
    received_.notify_one();
  }
}

void Loopback::send(std::span<const std::byte> bytes) {
  check(socket_.send(bytes, kLong));
  sent_ += bytes.size();
}

void Loopback::drain() const {
  for (std::uint64_t at = received_; at < sent_; at = received_) received_.wait(at);
}

/// One frame.
struct Run {
  double wall_s = 0;
  double process_s = 0;  ///< processor time of the process
  TimeParts stages;      ///< only with probes
  int threads = 0;
  double processor_s = 0;
};

class FrameRunner {
 public:
  explicit FrameRunner(const TimedFrame& frame) : frame_(frame) {}

  Run run(bool with_probes) {
    Run run;
    const double process_s = processor_s();
    const auto start = Clock::now();
    StageTimes serial, parallel;
    begin(with_probes ? &serial : nullptr);
    RenderOptions options;
    options.threads = frame_.threads;
    options.times = with_probes ? &parallel : nullptr;
    FrameSum sum(frame_.settings->settings);
    options.on_wedge = [&](Wedge&& wedge) {
      sum.add(wedge);
      send([&] { return encoder_->wedge(wedge.index, wedge.bins); });
    };
    const Receiver receiver(frame_.settings->settings, frame_.radar,
                            frame_.settings->settings.receiver.noise_frame, air_view(plan_->looks_at()));
    options.receiver = &receiver;
    render_wedges(*plan_, {0, plan_->bins().n_azimuth}, options);
    end(with_probes ? &serial : nullptr, sum, start);
    run.wall_s = seconds_since(start);
    run.process_s = processor_s() - process_s;
    if (with_probes) take(run, serial, parallel);
    return run;
  }

 private:
  void begin(StageTimes* times) {
    const StageClock clock(times);
    {
      const StageProbe probe(Stage::plan);
      PlanResult planned = plan_frame(frame_.scene, frame_.settings, frame_.pose);
      if (!planned.plan) throw InputError(all_text(planned.errors));
      plan_ = std::move(planned.plan);
      describe_frame(*plan_, frame_.radar, frame_.scene_name, descriptor_);
    }
    send([&] {
      encoder_ = std::make_unique<stream::FrameEncoder>(stream::FrameIdentity{.stream_id = 1}, sequence_);
      return encoder_->begin(descriptor_);
    });
  }

  void end(StageTimes* times, const FrameSum& sum, Clock::time_point start) {
    const StageClock clock(times);
    send([&] {
      wire::FrameSummary summary;
      summarise_frame(*plan_, sum.total(), summary);
      return std::vector{encoder_->end(summary, seconds_since(start))};
    });
    const StageProbe probe(Stage::send);
    loopback_.drain();
  }

  template <typename Encode>
  void send(Encode encode) {
    std::vector<stream::BlockPtr> blocks;
    {
      const StageProbe probe(Stage::encode);
      blocks = encode();
    }
    const StageProbe probe(Stage::send);
    for (const stream::BlockPtr& block : blocks) loopback_.send(block->bytes);
  }

  static void take(Run& run, const StageTimes& serial, const StageTimes& parallel) {
    run.threads = parallel.threads();
    run.processor_s = serial.processor_s() + parallel.processor_s();
    run.stages.whole_s = run.threads * run.wall_s;
    double idle_s = run.stages.whole_s;
    for (int k = 0; k < kStages; ++k) {
      const auto stage = static_cast<Stage>(k);
      const double seconds = serial.seconds(stage) + parallel.seconds(stage);
      idle_s -= seconds;
      if (seconds > 0) run.stages.add(stage_name(stage), seconds);
    }
    run.stages.add("idle", idle_s);
  }

  TimedFrame frame_;
  Loopback loopback_;
  std::shared_ptr<const FramePlan> plan_;
  wire::FrameDescriptor descriptor_;
  std::uint64_t sequence_ = 0;
  std::unique_ptr<stream::FrameEncoder> encoder_;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

Timing time_frames(const TimedFrame& frame) {
  FrameRunner runner(frame);
  runner.run(false);  // memory, connection
  std::vector<Run> measured;
  std::vector<double> wall_ratio, processor_ratio;
  const auto start = Clock::now();
  while (measured.size() < kFewestPairs ||
         (measured.size() < kMostPairs && seconds_since(start) < kLongEnough_s)) {
    const bool first = measured.size() % 2 == 0;
    Run with, without;
    if (first) with = runner.run(true);
    without = runner.run(false);
    if (!first) with = runner.run(true);
    wall_ratio.push_back(with.wall_s / without.wall_s);
    processor_ratio.push_back(with.process_s / without.process_s);
    measured.push_back(std::move(with));
  }
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end(),
                   [](const Run& a, const Run& b) { return a.wall_s < b.wall_s; });
  Timing timing;
  timing.frame = std::move(middle->stages);
  timing.frame_s = middle->wall_s;
  timing.threads = middle->threads;
  timing.processor_s = middle->processor_s;
  timing.pairs = static_cast<int>(measured.size());
  timing.wall_ratio = median(wall_ratio);
  timing.processor_ratio = median(processor_ratio);
  return timing;
}

}  // namespace obliq
