// `obliq replay`: a recording as a line per frame, as files, or served to clients.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/frame_report.h"
#include "server/apps/commands/number_option.h"
#include "server/apps/commands/replay_track.h"
#include "server/apps/commands/server_arguments.h"
#include "server/apps/commands/stream_arguments.h"
#include "server/apps/replay/recorded_time.h"
#include "server/apps/replay/replay_renderer.h"
#include "server/apps/version/version.h"
#include "server/control/parameter_reference.h"
#include "server/control/sections/server.h"
#include "server/control/settings_message.h"
#include "server/http/answering.h"
#include "server/http/http_server.h"
#include "server/http/page_routes.h"
#include "server/net/io_thread.h"
#include "server/net/request_limits.h"
#include "server/net/server.h"
#include "server/security/networks.h"
#include "server/websocket/upgrade.h"
#include "terrain/base/errors.h"
#include "terrain/base/memory_limit.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

using client::RecordedFrames;

struct ReplayArguments {
  std::string file;
  std::string radar;
  std::string speed = "1";
  std::string out;
  PictureArguments picture;
  std::uint64_t frames = 0;
  bool loop = false;
  std::string track;
  bool hold = false;
  bool serve = false;
  std::string address = "127.0.0.1";
  std::uint16_t port = wire::kDefaultPort;
  std::optional<std::uint16_t> http_port;
  bool unprotected = false;
  double max_memory_mb = 0;
};

double speed_of(const std::string& text) {
  if (text == "max") return std::numeric_limits<double>::infinity();
  double speed = 0;
  if (CLI::detail::lexical_cast(text, speed) && speed >= kSlowestReplay && speed <= kFastestReplay)
    return speed;
  throw InputError("--speed: found \"" + text + "\"; allowed: " + replay_speeds() + ", or max");
}

void warn(const std::string& note) { std::fprintf(stderr, "warning: %s\n", note.c_str()); }

std::unique_ptr<client::RecordingReader> open_recording(const std::string& path) {
  std::unique_ptr<client::RecordingReader> reader;
  require(client::RecordingReader::open(path, reader));
  return reader;
}

client::RecordingStart start_of(const ReplayArguments& arguments) {
  client::RecordingStart start;
  client::Status status = client::read_start(*open_recording(arguments.file), arguments.radar, start);
  if (!status.ok()) status.text = arguments.file + ": " + status.text;
  require(status);
  return start;
}

void report(const client::RecordingLosses& losses, const std::string& path) {
  if (losses.any()) throw PartlyDone(path + ": " + losses.text() + "; what is whole has been replayed");
}

// ---- To the terminal and to files ----

/// In floating point: the times are whatever the file says.
double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  return (static_cast<double>(to_ns) - static_cast<double>(from_ns)) * 1e-9;
}

void print_frame(const client::RecordedFrame& recorded, std::int64_t start_ns) {
  const client::AssembledFrame& frame = recorded.frame;
  std::printf("frame %" PRIu64
              ": %.3f s into the recording, rendered in %.1f ms, first wedge after %.1f ms, %.2f MB\n",
              frame.descriptor->frame_id(), seconds_between(start_ns, recorded.end_utc_ns),
              1000 * frame.render_s, static_cast<double>(recorded.first_wedge_ns) * 1e-6,
              static_cast<double>(recorded.bytes) * 1e-6);
  std::fflush(stdout);
}

/// What the file held, in a line: also that nothing is missing is said.
std::string end_line(const RecordedFrames& frames, std::uint64_t shown) {
  const client::RecordingReader& reader = frames.reader();
  std::string line = fmt::format("{}, {} whole messages, {} bytes", counted(shown, "frame"),
                                 reader.messages(), reader.offset());
  if (frames.aborted() > 0) line += fmt::format(", {} aborted", frames.aborted());
  if (frames.losses().any()) line += ", " + frames.losses().text();
  if (frames.cut()) line += ", the end is cut";
  if (!frames.cut() && !frames.losses().any()) line += ", nothing left over";
  return line;
}

void show(const ReplayArguments& arguments, const client::RecordingStart& start, double speed) {
  std::optional<NewestFiles> files;
  if (!arguments.out.empty()) files.emplace(arguments.out, picture_options(arguments.picture));
  DueTimes times(speed);
  std::uint64_t shown = 0;
  bool enough = false;
  client::RecordingLosses losses;
  do {
    RecordedFrames frames(open_recording(arguments.file), start.radar, start.planes);
    auto found = RecordedFrames::Found::note;
    const std::uint64_t before = shown;
    while (!enough && found != RecordedFrames::Found::end) {
      client::RecordedFrame recorded;
      found = frames.next(recorded);
      if (!frames.note().empty()) warn(frames.note());
      if (found != RecordedFrames::Found::frame) continue;
      std::this_thread::sleep_until(times.due(recorded.end_utc_ns));
      print_frame(recorded, start.utc_ns);
      if (files) {
        const BinBlock bins = take_bins(recorded.frame);
        files->write(*recorded.frame.descriptor, *recorded.frame.summary, bins);
      }
      enough = arguments.frames != 0 && ++shown >= arguments.frames;
      if (arguments.frames == 0) ++shown;
    }
    losses = client::more_of(losses, frames.losses());
    if (!enough) std::printf("%s: %s\n", arguments.file.c_str(), end_line(frames, shown).c_str());
    if (frames.frames_of_others() > 0 && !arguments.loop)
      warn(fmt::format("{} frames of other radars than {} were left out; --radar chooses",
                       frames.frames_of_others(), start.radar));
    if (shown == before) break;  // nothing to loop over
    times.begin_again();
  } while (arguments.loop && !enough);
  if (shown == 0)
    throw InputError(fmt::format("{}: no frame of radar {} is whole, so nothing was replayed{}",
                                 arguments.file, start.radar, losses.any() ? "; " + losses.text() : ""));
  report(losses, arguments.file);
}

// ---- To clients ----

// Between looks at whether it is over.
constexpr std::chrono::milliseconds kServingPause{50};

RadarConfig radar_of(const client::RecordingStart& start, const std::string& path) {
  RadarConfig radar;
  radar.name = start.radar;
  for (const auto& errors : {merge_message(start.descriptor->settings(), radar.settings),
                             merge_message(start.descriptor->pose(), radar.pose)}) {
    if (!errors.empty()) throw InputError(path + ": its radar: " + errors.front().text());
  }
  // Its beam has swept: the passes come out of the recording.
  radar.settings.scan_mode = ScanMode::frame;
  return radar;
}

/// The page and the stream for browsers, beside `server` on its thread.
std::unique_ptr<http::HttpServer> serve_browsers(const ReplayArguments& arguments, net::IoThread& io,
                                                 net::Server& server) {
  http::HttpOptions options;
  options.address = arguments.address;
  options.port = *arguments.http_port;
  std::vector<http::Route> routes = http::page_routes(parameters_json());
  http::Readiness readiness;
  readiness.ready();
  routes.push_back({"/readyz", true, [state = readiness.state()] { return http::readiness_page(state); }});
  const HttpConfig offered;
  routes.push_back(http::page_state_route([state = readiness.state()] { return http::readiness_page(state); },
                                          {offered.range_scales, offered.range_unit}));
  return std::make_unique<http::HttpServer>(
      io.context(), options, std::move(routes),
      websocket::upgrade(
          io.context(), [&server] { return &server; }, [] { return http::Page{}; }));
}

void serve(const ReplayArguments& arguments, client::RecordingStart start, double speed) {
  if (!net::resolves_to_loopback(arguments.address) && !arguments.unprotected)
    throw InputError("--address: found " + arguments.address +
                     "; allowed: a loopback address, unless --unprotected says that any client that reaches "
                     "the port may watch");
  if (start.descriptor->has_window())
    throw InputError("--serve: found " + arguments.file +
                     ", of a part of the bins (--azimuths, --ranges); allowed: a recording of whole frames");
  net::ServerOptions options;
  options.address = arguments.address;
  options.port = arguments.port;
  options.server_name = "obliq replay";
  options.server_version = program_version();
  options.scene_name = start.descriptor->scene_name();
  options.max_memory_mb = memory_limit_mb(arguments.max_memory_mb);
  const RadarConfig radar = radar_of(start, arguments.file);
  const net::FrameCost cost = net::replay_cost(radar.settings, start.planes, options);
  if (const auto over = net::over_memory(radar.settings, cost, 0, options))
    throw InputError(arguments.file + ": " + over->text +
                     "; allowed: a larger --max-memory-mb, inf for no limit");
  std::atomic<bool> ended = false;
  const ReplayOptions replay{speed, arguments.loop, arguments.hold};
  ReplayRenderer renderer(arguments.file, std::move(start), replay, warn, [&ended] { ended = true; });
  net::IoThread io;
  net::Server server(io.context(), renderer, {radar}, options,
                     net::ReservedPort(options.address, options.port));
  std::unique_ptr<http::HttpServer> browsers;
  if (arguments.http_port) browsers = serve_browsers(arguments, io, server);
  const std::shared_ptr<void> first_of_all(nullptr, [&io](void*) { io.end(); });
  heed_interrupts();
  server.start([&] {
    if (browsers) browsers->stop();
    io.release();
  });
  if (browsers) std::printf("the picture in a browser: %s\n", browsers->url().c_str());
  std::printf("ready: replays radar %s (%s) on %s\n", radar.name.c_str(),
              wire::plane_names(renderer.planes()).c_str(), server.address().c_str());
  std::fflush(stdout);
  while (!ended && !interrupted()) std::this_thread::sleep_for(kServingPause);
  if (!ended) renderer.stop();
  server.stop();  // when clients have taken what waits for them
  io.join();
  report(renderer.losses(), arguments.file);
}

void run(const ReplayArguments& arguments) {
  const double speed = speed_of(arguments.speed);
  client::RecordingStart start = start_of(arguments);
  if (!arguments.track.empty()) return write_track(arguments.file, start.radar, arguments.track);
  if (start.planes == 0) warn("none of its frames has values");
  if (arguments.serve) {
    serve(arguments, std::move(start), speed);
  } else {
    show(arguments, start, speed);
  }
}

}  // namespace

void add_replay(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("replay", "Replay a recording: a line per frame, files, or a server for any client");
  command->footer(
      "Exit code: 0 all frames replayed (of a recording that was cut, those before the cut), 1 nothing could "
      "be replayed, 2 frames were lost or the file is damaged, and what is whole has been replayed.");
  auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("file", arguments->file, "A recording by `obliq record`")
      ->required()
      ->type_name("FILE");
  command->add_option("--radar", arguments->radar, "Radar; default: that of the first frame")
      ->type_name("NAME");
  command
      ->add_option(
          "--speed", arguments->speed,
          "Speed factor, or max: without waiting. Pauses of more than 5 minutes are cut to 5 minutes")
      ->type_name("FACTOR")
      ->default_val("1");
  CLI::Option* frames =
      command->add_option("--frames", arguments->frames, "Stop after this many frames; 0: all")
          ->type_name("N")
          ->check(a_count());
  CLI::Option* out =
      command->add_option("--out", arguments->out, "Folder that always holds the files of the newest frame")
          ->type_name("DIR");
  CLI::Option* track =
      command
          ->add_option(
              "--track", arguments->track,
              "Write where the antenna was, for `obliq fly`, and nothing else; -: to the standard output")
          ->type_name("FILE.csv")
          ->excludes(out);
  add_picture_arguments(*command, arguments->picture);
  command->add_flag("--loop", arguments->loop, "Begin again at the end");
  CLI::Option* serve = command->add_flag(
      "--serve", arguments->serve,
      "Serve the frames as obliqd would, from the first subscription on; ends with the recording");
  serve->excludes(frames)->excludes(out)->excludes(track);
  command
      ->add_flag("--hold", arguments->hold,
                 "With --serve: stand still at the end, so that clients can seek back, instead of ending")
      ->needs(serve);
  command->add_option("--port", arguments->port, "With --serve; 0: any free one")
      ->needs(serve)
      ->type_name("N")
      ->default_val(wire::kDefaultPort)
      ->check(whole_number_from(0, std::numeric_limits<std::uint16_t>::max()));
  command
      ->add_option(
          "--http-port", arguments->http_port,
          "With --serve: also the page and the stream for browsers (/stream) over HTTP; 0: any free one")
      ->needs(serve)
      ->type_name("N")
      ->check(whole_number_from(0, std::numeric_limits<std::uint16_t>::max()));
  command->add_option("--address", arguments->address, "With --serve: where to listen")
      ->needs(serve)
      ->type_name("HOST")
      ->default_val("127.0.0.1");
  command
      ->add_flag("--unprotected", arguments->unprotected,
                 "With --serve: allow an address off loopback, without encryption and tokens")
      ->needs(serve);
  command
      ->add_option("--max-memory-mb", arguments->max_memory_mb,
                   "With --serve: refuse what would take more memory than this with what is in use; 0: three "
                   "quarters of the machine's or of its control group's; inf: no limit")
      ->needs(serve)
      ->type_name("MB")
      ->default_val(0)
      ->check(number_from(0, std::numeric_limits<double>::infinity()));
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
