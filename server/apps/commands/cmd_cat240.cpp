// `obliq cat240`: a radar's video as ASTERIX CAT 240 over UDP, for displays.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/asterix/paced_sender.h"
#include "server/asterix/radials.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

using Clock = asterix::Pace::Clock;

struct Cat240Arguments {
  ServerArguments server;
  asterix::UdpOptions udp;
  asterix::Source source;
  int bits = 8;
  int sac = 0;
  int sic = 1;
  double rate_hz = 1;
  double summary_s = 5;
  std::size_t max_datagram = asterix::VideoFormat{}.max_datagram;
  std::uint64_t frames = 0;
  int reconnect_s = 0;
};

// Between looks at the clock and at signals.
constexpr client::Timeout kPatience{100};
constexpr Clock::duration kTroublePause = std::chrono::minutes(1);
constexpr double kLongestSummaryPause_s = 3600;

void refuse_long_cells(double spacing_m, const std::string& radar) {
  if (spacing_m <= asterix::longest_cell_m()) return;
  throw InputError(fmt::format(
      "{}: found range bins of {:.1f} m (range_spacing_m); allowed: at most {:.1f} m, the longest cell of "
      "CAT 240; more bins.range or a smaller radar.r_max_m make them shorter",
      radar, spacing_m, asterix::longest_cell_m()));
}

const char* reference_text(wire::HeightReference reference) {
  switch (reference) {
    case wire::GROUND:
      return "above ground";
    case wire::ELLIPSOID:
      return "above the ellipsoid";
    default:
      return "above the datum";
  }
}

/// What a display cannot know from the cells. client/guide/cat240.md explains it.
std::string summary_text(const wire::FrameDescriptor& frame, const asterix::CellGeometry& cells) {
  const wire::Pose& pose = frame.pose();
  const std::string numbers = fmt::format(
      "; floor {:.2f} dB; span {:.2f} dB; 0 no return; range offset {:.3f} m; latitude {:.7f}; longitude "
      "{:.7f}; "
      "height {:.1f} m {}",
      frame.video_floor_db(), frame.settings().video_span_db(), cells.range_offset_m, pose.latitude_deg(),
      pose.longitude_deg(), pose.height_m(), reference_text(pose.height_reference()));
  // Of a long name the beginning: the numbers must be whole.
  return frame.radar().substr(0, asterix::kMostSummary - std::min(asterix::kMostSummary, numbers.size())) +
         numbers;
}

/// From radials to datagrams with their times.
class Feed {
 public:
  Feed(const Cat240Arguments& arguments, asterix::UdpTarget target)
      : summary_pause_(from_seconds(arguments.summary_s)),
        period_(arguments.rate_hz),
        sender_(std::move(target)) {
    format_.source = arguments.source;
    format_.max_datagram = arguments.max_datagram;
  }

  client::Status begin(const wire::FrameDescriptor& frame) {
    refuse_long_cells(frame.range_spacing_m(), frame.radar());
    const Shown shown{asterix::cell_geometry(frame.range_start_m(), frame.range_spacing_m()),
                      frame.azimuth_start_deg(),
                      frame.azimuth_width_deg(),
                      frame.settings().azimuth_bins(),
                      frame.settings().range_bins(),
                      frame.video_floor_db(),
                      frame.settings().video_span_db()};
    summary_ = summary_text(frame, shown.cells);
    if (shown_ != shown) {
      shown_ = shown;
      format_.cells = shown.cells;
      send_summary();
    }
    return {};
  }

  void take(const asterix::RadialGroup& group) {
    format_.bits = group.bits;
    std::vector<asterix::Bytes> messages;
    for (const auto& row : group.rows) {
      const auto edges = asterix::azimuth_edges(group.frame->azimuth_start_deg(),
                                                group.frame->azimuth_width_deg(), row.azimuth);
      asterix::append_video(format_, {edges, row.levels}, next_index_, messages);
    }
    radials_ += group.rows.size();
    const auto now = Clock::now();
    const auto period = group.beam_s > 0 ? dwells_.next(now, from_seconds(group.beam_s)) : period_.next(now);
    const auto times = pace_.spread(now, messages.size(), period);
    sender_.queue(std::move(messages), times, group.beam_utc_ns);
  }

  /// What is due between frames.
  void look_at_the_clock() {
    const auto now = Clock::now();
    if (shown_ && now - summary_sent_ >= summary_pause_) send_summary();
    tell_trouble(now);
  }

  /// Waits until all has been sent.
  void finish() {
    sender_.drain();
    tell_trouble(Clock::time_point::max());
  }
  std::string text(std::uint64_t frames) const {
    const asterix::SenderCounts counts = sender_.counts();
    return fmt::format("{}, {}, {} sent, {} could not be sent", counted(frames, "frame"),
                       counted(radials_, "radial"), counted(counts.sent, "datagram"), counts.not_sent);
  }

 private:
  /// What a summary is sent anew for.
  struct Shown {
    asterix::CellGeometry cells;
    double azimuth_start_deg, azimuth_width_deg;
    std::int32_t azimuth_bins, range_bins;
    double floor_db, span_db;
    bool operator==(const Shown&) const = default;
  };

  void send_summary() {
    summary_sent_ = Clock::now();
    std::vector<asterix::Bytes> message;
    message.push_back(asterix::summary_message(format_.source, summary_));
    sender_.queue(std::move(message), {summary_sent_, {}}, std::nullopt);
  }

  /// At once, and then once a minute.
  void tell_trouble(Clock::time_point now) {
    const asterix::SenderCounts counts = sender_.counts();
    if (counts.not_sent == told_ || now - told_at_ < kTroublePause) return;
    std::fprintf(stderr, "warning: %s could not be sent: %s\n",
                 counted(counts.not_sent - told_, "datagram").c_str(), std::strerror(counts.error));
    told_ = counts.not_sent;
    told_at_ = now;
  }

  asterix::VideoFormat format_;
  std::optional<Shown> shown_;
  std::string summary_;
  Clock::duration summary_pause_;
  Clock::time_point summary_sent_;
  std::uint32_t next_index_ = 0;
  std::uint64_t radials_ = 0;
  std::uint64_t told_ = 0;
  Clock::time_point told_at_ = Clock::now() - kTroublePause;
  asterix::Pace pace_;
  asterix::FramePeriod period_;
  asterix::DwellPeriod dwells_;
  asterix::PacedSender sender_;
};

std::string start_text(const Cat240Arguments& arguments, const asterix::UdpTarget& target,
                       const std::string& radar) {
  const std::string way =
      target.is_multicast() ? fmt::format("multicast, TTL {}", arguments.udp.ttl) : "unicast";
  return fmt::format(
      "{}: sends ASTERIX CAT 240, edition 1.3, to {} ({}), levels of {} bits, SAC {}, SIC {}, a summary "
      "every {} s\n"
      "UDP is not protected: anyone in the network can read this video, and forge it\n",
      radar, target.text(), way, arguments.bits, arguments.sac, arguments.sic, arguments.summary_s);
}

void run(Cat240Arguments& arguments) {
  arguments.source = {static_cast<std::uint8_t>(arguments.sac), static_cast<std::uint8_t>(arguments.sic)};
  heed_interrupts();
  asterix::UdpTarget target(arguments.udp);  // a bad address is refused before anything is asked of a server
  client::ResumeOptions resume = reconnecting(arguments.reconnect_s);
  resume.give_up = interrupted;
  client::ResumingClient client(connect_to_server(arguments.server, "obliq cat240"), resume);
  const std::string radar = choose_remote_radar(client.client(), arguments.server);
  wire::RadarInfo info;
  require(client.client().get_radar(radar, info));
  const wire::RadarSettings& settings = info.settings();
  refuse_long_cells((settings.r_max_m() - settings.r_min_m()) / settings.range_bins(), radar);

  const std::string start = start_text(arguments, target, radar);
  Feed feed(arguments, std::move(target));
  asterix::Radials radials({[&feed](const wire::FrameDescriptor& frame) { return feed.begin(frame); },
                            [&feed](const asterix::RadialGroup& group) { feed.take(group); }});
  client.client().set_handler(&radials);
  wire::Subscribe request;
  request.set_radar(radar);
  request.set_rate_hz(arguments.rate_hz);
  request.add_planes(wire::VIDEO);
  request.set_video_bits(static_cast<std::uint32_t>(arguments.bits));
  require(client.subscribe(request));
  std::fputs(start.c_str(), stdout);  // only now that nothing is refused
  std::fflush(stdout);
  while (!interrupted() && (arguments.frames == 0 || radials.whole_frames() < arguments.frames)) {
    const client::Status status = client.receive(kPatience);
    feed.look_at_the_clock();
    if (status.ok() || status.outcome == client::Outcome::timed_out || is_warning(status)) continue;
    if (interrupted()) break;
    require(status);
  }
  feed.finish();
  std::printf("%s: %s\n", radar.c_str(), feed.text(radials.whole_frames()).c_str());
}

}  // namespace

void add_cat240(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "cat240", "Send a radar's video to displays as ASTERIX CAT 240 over UDP; Ctrl-C ends it cleanly");
  auto arguments = std::make_shared<Cat240Arguments>();
  add_server_arguments(*command, arguments->server, true);
  command
      ->add_option("--to", arguments->udp.to,
                   "Receiver or multicast group: IPv4 address or name, and UDP port")
      ->required()
      ->type_name("HOST:PORT");
  command->add_option("--bits", arguments->bits, "Bits of a cell")
      ->check(CLI::IsMember({8, 16}))
      ->default_val(8);
  add_rate_argument(*command, arguments->rate_hz,
                    "Frames a second; an antenna that scans (scan.mode) has its own");
  constexpr int kMostOctet = 255;
  command->add_option("--sac", arguments->sac, "System area code of the source")
      ->type_name("N")
      ->default_val(0)
      ->check(whole_number_from(0, kMostOctet));
  command->add_option("--sic", arguments->sic, "System identification code of the source")
      ->type_name("N")
      ->default_val(1)
      ->check(whole_number_from(0, kMostOctet));
  command
      ->add_option("--interface", arguments->udp.interface,
                   "Send from this IPv4 address of this machine; without: as its routes say")
      ->type_name("ADDRESS");
  command->add_option("--ttl", arguments->udp.ttl, "Networks that a datagram may cross; 1: this one alone")
      ->type_name("N")
      ->default_val(1)
      ->check(whole_number_from(1, kMostOctet));
  command->add_option("--summary-s", arguments->summary_s, "Seconds between summary messages")
      ->type_name("S")
      ->default_val(5.0)
      ->check(number_from(0.1, kLongestSummaryPause_s));
  command
      ->add_option(
          "--max-datagram", arguments->max_datagram,
          "Octets of a datagram; a radial that needs more becomes several messages. 1472 pass an Ethernet "
          "in one piece")
      ->type_name("OCTETS")
      ->default_val(asterix::VideoFormat{}.max_datagram)
      ->check(whole_number_from(asterix::least_datagram(), asterix::kMostDatagram));
  add_frames_argument(*command, arguments->frames, "Stop after this many frames or passes; 0: never");
  add_reconnect_argument(*command, arguments->reconnect_s);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
