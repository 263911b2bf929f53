// `obliq replay`: a recording as a line per frame, as files, or served to clients.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/event_table.h"
#include "server/apps/commands/frame_report.h"
#include "server/apps/commands/replay_server.h"
#include "server/apps/commands/replay_targets.h"
#include "server/apps/commands/replay_track.h"
#include "server/apps/replay/recorded_time.h"
#include "terrain/base/errors.h"
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
  std::string targets;
  bool events = false;
  bool json = false;
  bool hold = false;
  bool keep_bookmarks = false;
  bool all = false;
  bool serve = false;
  ServeArguments server;
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
        files->write(*recorded.frame.descriptor, *recorded.frame.summary, bins, take_trains(recorded.frame));
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

/// The radars that its Welcome names and that have frames in it.
void add_other_radars(const std::string& file, std::vector<client::RecordingStart>& starts) {
  const auto reader = open_recording(file);
  wire::Welcome welcome;
  while (welcome.radars().empty() && reader->next() != client::RecordingReader::Found::end) {
    const wire::MessageView& message = reader->message();
    if (message.header.type == wire::MessageType::frame_begin) break;
    if (message.header.type == wire::MessageType::welcome)
      (void)wire::parse_descriptor(message.descriptor, welcome);
  }
  const std::string first = starts.front().radar;
  for (const std::string& radar : welcome.radars()) {
    client::RecordingStart start;
    if (radar != first && client::read_start(*open_recording(file), radar, start).ok())
      starts.push_back(std::move(start));
  }
}

void run(const ReplayArguments& arguments) {
  const double speed = speed_of(arguments.speed);
  if (arguments.events) return print_recorded_events(arguments.file, arguments.json);
  client::RecordingStart start = start_of(arguments);
  if (!arguments.track.empty()) return write_track(arguments.file, start.radar, arguments.track);
  if (!arguments.targets.empty()) return write_targets(arguments.file, start, arguments.targets);
  if (start.planes == 0) warn("none of its frames has values");
  if (arguments.serve) {
    const ReplayOptions options{speed, arguments.loop, arguments.hold, arguments.keep_bookmarks, {}};
    std::vector<client::RecordingStart> starts;
    starts.push_back(std::move(start));
    if (arguments.all) add_other_radars(arguments.file, starts);
    report(serve_recording(arguments.server, arguments.file, std::move(starts), options), arguments.file);
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
  CLI::Option* targets =
      command
          ->add_option(
              "--targets", arguments->targets,
              "Write where targets were in each frame, of a recording with --truth, and nothing else; -: "
              "to the standard output")
          ->type_name("FILE.csv")
          ->excludes(out)
          ->excludes(track);
  CLI::Option* events =
      command
          ->add_flag("--events", arguments->events,
                     "Print the log of the exercise, who changed what and when, and nothing else")
          ->excludes(out)
          ->excludes(track)
          ->excludes(targets);
  command->add_flag("--json", arguments->json, "With --events: each as a line of JSON")->needs(events);
  add_picture_arguments(*command, arguments->picture);
  command->add_flag("--loop", arguments->loop, "Begin again at the end");
  CLI::Option* serve = command->add_flag(
      "--serve", arguments->serve,
      "Serve the frames as obliqd would, from the first subscription on; ends with the recording");
  serve->excludes(frames)->excludes(out)->excludes(track)->excludes(targets)->excludes(events);
  command
      ->add_flag("--hold", arguments->hold,
                 "With --serve: stand still at the end, so that clients can seek back, instead of ending")
      ->needs(serve);
  command
      ->add_flag("--keep-bookmarks", arguments->keep_bookmarks,
                 "With --serve: bookmarks that are set are written into the recording, behind its end")
      ->needs(serve);
  command
      ->add_flag(
          "--all", arguments->all,
          "With --serve: all radars of `obliq record --all`, in step, each on the next port and the next "
          "HTTP port; who steers one steers all")
      ->needs(serve)
      ->excludes("--radar")
      ->excludes("--loop");
  add_serve_arguments(*command, serve, arguments->server);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
