// `obliq watch`: subscribes to a radar and prints a line per frame.
#include <CLI/CLI.hpp>
#include <cinttypes>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "client/frame_assembler.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/frame_report.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

struct WatchArguments {
  ServerArguments server;
  StreamArguments stream;
  bool lossless = false;
  double rate_hz = 1;
  std::uint64_t frames = 0;
  std::string out;
  PictureArguments picture;
  std::string picture_file;
  int picture_side = 0;
  int reconnect_s = 0;
};

constexpr client::Timeout kSilence{60000};
constexpr int kLeastSide = 100;
constexpr int kMostSide = 8000;

// Coverage from which on all of the sector has ground, but for what rounding leaves.
constexpr double kWhole = 0.99995;

double milliseconds_of(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }

/// An assembler that also takes the times along the way.
class TimedFrames : public client::FrameAssembler {
 public:
  using FrameAssembler::FrameAssembler;
  client::Status on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) override {
    first_wedge_ns_ = 0;
    utc_ns_ = header.utc_ns;
    scan_ = begin.has_scan() ? std::make_unique<wire::ScanPass>(begin.scan()) : nullptr;
    bytes_ = header.payload_length;
    return FrameAssembler::on_begin(header, begin);
  }
  client::Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                          std::span<const std::byte> values) override {
    if (first_wedge_ns_ == 0) first_wedge_ns_ = block.send_ns() - block.render_start_ns();
    pose_age_ns_ = block.pose_received_ns() == 0 ? 0 : block.send_ns() - block.pose_received_ns();
    bytes_ += header.payload_length;
    return FrameAssembler::on_block(header, block, values);
  }
  client::Status on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) override {
    // Between the clocks of two machines: exact on one machine, elsewhere as good as both are set.
    const double underway_ms = milliseconds_of(wire::utc_now_ns() - header.utc_ns);
    std::printf("%s %" PRIu64 ": ", scan_ ? "pass" : "frame", end.frame_id());
    if (scan_) print_scan(end);
    std::printf("rendered in %.1f ms, first wedge after %.1f ms, under way %.1f ms, %.2f MB",
                1000 * end.render_s(), milliseconds_of(first_wedge_ns_), underway_ms,
                static_cast<double>(bytes_) * 1e-6);
    if (frame().frames_skipped != 0) std::printf(", %" PRIu64 " skipped before it", frame().frames_skipped);
    if (pose_age_ns_ != 0) std::printf(", pose %.1f ms old", milliseconds_of(pose_age_ns_));
    if (end.summary().coverage() < kWhole) std::printf(", coverage %.4g %%", 100 * end.summary().coverage());
    std::printf("\n");
    std::fflush(stdout);
    std::vector<std::string> warnings(frame().descriptor->warnings().begin(),
                                      frame().descriptor->warnings().end());
    warnings.insert(warnings.end(), end.summary().warnings().begin(), end.summary().warnings().end());
    warnings_.tell(std::move(warnings));
    return FrameAssembler::on_end(header, end);
  }
  client::Status on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) override {
    std::printf("frame %" PRIu64 ": aborted, %s\n", abort.frame_id(), abort.reason().c_str());
    std::fflush(stdout);
    return FrameAssembler::on_abort(header, abort);
  }

  /// When the server began the current frame.
  std::int64_t utc_ns() const { return utc_ns_; }

 private:
  void print_scan(const wire::FrameEnd& end) const {
    std::uint32_t missed = 0;
    for (const wire::AzimuthSpan& span : end.missed()) missed += span.n_azimuth();
    std::printf("%s at %.4g deg/s, ", scan_->clockwise() ? "clockwise" : "counterclockwise",
                scan_->rate_deg_s());
    if (missed > 0) std::printf("%u azimuth bins missed, ", missed);
  }

  std::unique_ptr<wire::ScanPass> scan_;  ///< of a scanning antenna
  WarningChanges warnings_;
  std::int64_t utc_ns_ = 0;
  std::int64_t first_wedge_ns_ = 0;
  std::int64_t pose_age_ns_ = 0;
  std::uint64_t bytes_ = 0;
};

/// A picture alone needs two of the planes.
StreamArguments stream_for(const WatchArguments& arguments) {
  StreamArguments stream = arguments.stream;
  if (arguments.picture_file.empty()) return stream;
  if (stream.planes.empty() && arguments.out.empty()) stream.planes = "iq,state";
  const wire::PlaneSet seen = wire::plane_bit(wire::Plane::iq) | wire::plane_bit(wire::Plane::power) |
                              wire::plane_bit(wire::Plane::video);
  if ((wanted_planes(stream) & seen) == 0)
    throw InputError("--planes: found \"" + stream.planes +
                     "\" with --picture; allowed: iq, power or video among them");
  return stream;
}

void run(const WatchArguments& arguments) {
  const StreamArguments stream = stream_for(arguments);
  const wire::PlaneSet planes = wanted_planes(stream);
  PictureOptions look = picture_options(arguments.picture);
  std::optional<NewestFiles> files;
  if (!arguments.out.empty()) files.emplace(arguments.out, look);
  look.side = arguments.picture_side;
  std::optional<NewestPicture> picture;
  if (!arguments.picture_file.empty()) picture.emplace(arguments.picture_file, look);
  client::ResumingClient client(connect_to_server(arguments.server, "obliq watch"),
                                reconnecting(arguments.reconnect_s));
  const std::string radar = choose_remote_radar(client.client(), arguments.server);
  wire::RadarInfo info;
  require(client.client().get_radar(radar, info));
  if (info.transmit_off())
    std::fprintf(stderr, "%s: transmit is off, no frame comes before `obliq set --radar %s --transmit on`\n",
                 radar.c_str(), radar.c_str());
  TimedFrames frames(planes);
  client.client().set_handler(&frames);
  wire::Subscribe request;
  request.set_radar(radar);
  request.set_rate_hz(arguments.rate_hz);
  request.set_lossless(arguments.lossless);
  ask_for(stream, request);
  require(client.subscribe(request));
  for (std::uint64_t seen = 0; arguments.frames == 0 || seen < arguments.frames;) {
    const client::Status status = client.receive(kSilence);
    // Slower than a frame a minute, or nothing to render: not the server's fault.
    if (is_warning(status) || status.outcome == client::Outcome::timed_out) continue;
    require(status);
    if (frames.state() != client::FrameAssembler::State::complete) continue;
    client::AssembledFrame frame = frames.take();
    const BinBlock bins = take_bins(frame);
    if (picture) picture->write(*frame.descriptor, *frame.summary, bins, utc_text(frames.utc_ns()));
    if (files) files->write(*frame.descriptor, *frame.summary, bins, take_trains(frame));
    ++seen;
  }
}

}  // namespace

void add_watch(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "watch", "Watch a server's radar, one line per frame, or per pass of an antenna that scans");
  auto arguments = std::make_shared<WatchArguments>();
  add_server_arguments(*command, arguments->server, true);
  add_stream_arguments(*command, arguments->stream);
  add_rate_argument(*command, arguments->rate_hz,
                    "Frames a second; an antenna that scans (scan.mode) has its own");
  command->add_flag("--lossless", arguments->lossless,
                    "Leave no frame out: the radar waits for this client, which needs the role controller");
  add_frames_argument(*command, arguments->frames, "Stop after this many frames; 0: never");
  command->add_option("--out", arguments->out, "Folder that always holds the files of the newest frame")
      ->type_name("DIR");
  command
      ->add_option(
          "--picture", arguments->picture_file,
          "Picture of the newest frame, replaced as a whole, so that a viewer may open it at any time")
      ->type_name("FILE.png");
  command->add_option("--picture-side", arguments->picture_side, "Pixels of the longer side of its map")
      ->type_name("PIXELS")
      ->default_val(800)
      ->check(whole_number_from(kLeastSide, kMostSide));
  add_picture_arguments(*command, arguments->picture);
  add_reconnect_argument(*command, arguments->reconnect_s);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
