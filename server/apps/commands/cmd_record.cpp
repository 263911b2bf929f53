// `obliq record`: what a server sends about a radar, byte for byte, into a file.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "client/frame_dispatch.h"
#include "client/recording/recording_writer.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/commands.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

using Clock = std::chrono::steady_clock;

struct RecordArguments {
  ServerArguments server;
  std::string out;
  double rate_hz = 1;
  std::uint64_t frames = 0;
  double seconds = 0;
  StreamArguments stream;
  bool all = false;
  bool lossless = false;
  bool truth = false;
  bool force = false;
  int reconnect_s = 0;
};

// Between looks at the clock and at signals.
constexpr client::Timeout kPatience{100};
constexpr double kMostSeconds = 1e9;
constexpr Clock::duration kProgressPause = std::chrono::milliseconds(250);

// What a server says before all subscriptions are acknowledged is a handful of messages.
constexpr std::size_t kMostHeld = 64;

/// Writes what arrives, and counts frames on the way. What comes before the subscription is acknowledged is
/// held back, so that one that is refused leaves no file behind, and an older file as it was.
class Recorder {
 public:
  Recorder(std::string path, bool force, std::uint64_t most_frames, std::size_t radars)
      : path_(std::move(path)), force_(force), most_frames_(most_frames), radars_(radars) {}

  client::Status begin() {
    if (begun_) return {};
    begun_ = true;
    client::Status status = writer_.open(path_, force_);
    if (!status.ok()) {
      const bool exists = !force_ && access(path_.c_str(), F_OK) == 0;
      status.text = "--out: " + status.text + (exists ? "; --force overwrites it" : "");
    }
    for (auto message = held_.begin(); status.ok() && message != held_.end(); ++message)
      status = writer_.write(*message, {});
    held_.clear();
    return status;
  }

  client::Status take(const client::Message& message) {
    if (finished()) return {};
    count(message);
    if (!begun_ && held_.size() < kMostHeld) {
      held_.push_back(message.bytes());
      return {};
    }
    if (client::Status status = begin(); !status.ok()) return status;
    return writer_.write(message.header_bytes(), message.payload);
  }
  void take_welcome(const wire::Bytes& whole) { held_.push_back(whole); }
  client::Status close() { return writer_.close(); }

  /// Each radar has its frames.
  bool finished() const {
    return most_frames_ != 0 && frames_of_.size() >= radars_ &&
           std::ranges::all_of(frames_of_, [&](const auto& of) { return of.second >= most_frames_; });
  }
  std::string text(Clock::time_point start) const {
    std::uint64_t frames = 0;
    for (const auto& of : frames_of_) frames += of.second;
    return fmt::format("{}, {} left out on the way, {:.1f} MB, {:.1f} s", counted(frames, "frame"), skipped_,
                       static_cast<double>(writer_.bytes()) * 1e-6, seconds_since(start));
  }

 private:
  void count(const client::Message& message) {
    if (message.header.type == wire::MessageType::frame_end) ++frames_of_[message.header.stream_id];
    wire::FrameBegin begin;
    if (message.header.type == wire::MessageType::frame_begin &&
        wire::parse_descriptor(message.descriptor(), begin))
      skipped_ += begin.frames_skipped();
  }

  client::RecordingWriter writer_;
  std::string path_;
  bool force_;
  bool begun_ = false;
  std::vector<wire::Bytes> held_;
  std::uint64_t most_frames_;
  std::size_t radars_;
  std::map<std::uint32_t, std::uint64_t> frames_of_;  ///< by the radar's stream, the same on each connection
  std::uint64_t skipped_ = 0;
};

/// Receives until there is enough, or something ends it.
client::Status receive_all(client::ResumingClient& client, const RecordArguments& arguments,
                           const Recorder& recorder, const std::string& radars) {
  const auto start = Clock::now();
  const bool terminal = isatty(STDERR_FILENO) != 0;
  auto shown = start;
  while (!recorder.finished() && !interrupted()) {
    const auto now = Clock::now();
    if (arguments.seconds > 0 && to_seconds(now - start) >= arguments.seconds) break;
    if (terminal && now - shown >= kProgressPause) {
      std::fprintf(stderr, "\r%s: %s  ", radars.c_str(), recorder.text(start).c_str());
      shown = now;
    }
    client::Status status = client.receive(kPatience);
    const bool goes_on = status.ok() || status.outcome == client::Outcome::timed_out;
    if (!goes_on && !is_warning(status, terminal ? "\n" : "")) return status;
  }
  if (terminal) std::fprintf(stderr, "\n");
  return {};
}

/// How the exercise stands, and from now on who changes what.
client::Status follow_log(client::Client& client) {
  if (client.welcome().minor() < 2) return {};
  wire::ExerciseEvents events;
  return client.get_events(std::numeric_limits<std::uint64_t>::max(), true, events, true);
}

/// Those to record: with --all every one that the server has.
std::vector<std::string> radars_of(const client::Client& client, const RecordArguments& arguments) {
  if (!arguments.all) return {choose_remote_radar(client, arguments.server)};
  const auto& names = client.welcome().radars();
  const auto most = client.welcome().limits().max_subscriptions();
  if (names.empty()) throw InputError("the server has no radars");
  if (most != 0 && static_cast<std::uint32_t>(names.size()) > most)
    throw InputError(fmt::format("--all: found {} radars; allowed: {}, the server's max_subscriptions",
                                 names.size(), most));
  return {names.begin(), names.end()};
}

void run(const RecordArguments& arguments) {
  (void)wanted_planes(arguments.stream);  // bad names are refused before anything is done
  heed_interrupts();
  client::ResumeOptions resume = reconnecting(arguments.reconnect_s);
  resume.give_up = interrupted;
  client::ResumingClient client(connect_to_server(arguments.server, "obliq record"), resume);
  const std::vector<std::string> radars = radars_of(client.client(), arguments);
  Recorder recorder(arguments.out, arguments.force, arguments.frames, radars.size());
  recorder.take_welcome(client.client().welcome_bytes());
  client.client().set_tap([&recorder](const client::Message& message) { return recorder.take(message); });

  const auto start = Clock::now();
  for (const std::string& radar :
       radars)  // how it stands, for a recording that is cut before its first frame
    require(client.hold("state of " + radar, [radar](client::Client& to) {
      wire::RadarInfo info;
      return to.get_radar(radar, info);
    }));
  require(client.hold("log of the exercise", follow_log));
  std::string names;
  for (const std::string& radar : radars) {
    wire::Subscribe request;
    request.set_radar(radar);
    request.set_rate_hz(arguments.rate_hz);
    request.set_lossless(arguments.lossless);
    request.set_truth(arguments.truth);
    ask_for(arguments.stream, request);
    require(client.subscribe(request));
    names += (names.empty() ? "" : ", ") + radar;
  }
  require(recorder.begin());
  client::Status status = receive_all(client, arguments, recorder, names);
  // A frame that is under way is ended by the server's FrameAbort, so that the recording ends between frames.
  for (const std::string& radar : radars)
    if (status.ok() && !recorder.finished()) status = client.client().unsubscribe(radar);
  if (interrupted() && !client.client().is_open()) status = {};  // while it was to be taken up again
  client.client().close();
  const client::Status closed = recorder.close();
  std::printf("%s: radar%s %s, %s\n", arguments.out.c_str(), radars.size() == 1 ? "" : "s", names.c_str(),
              recorder.text(start).c_str());
  require(status);
  require(closed);
}

}  // namespace

void add_record(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "record", "Record what a server sends about a radar, byte for byte; Ctrl-C ends it cleanly");
  auto arguments = std::make_shared<RecordArguments>();
  add_server_arguments(*command, arguments->server, true);
  add_stream_arguments(*command, arguments->stream);
  command->add_option("--out", arguments->out, "The recording; must not exist yet")
      ->required()
      ->type_name("FILE");
  add_rate_argument(*command, arguments->rate_hz, "Frames a second");
  add_frames_argument(*command, arguments->frames,
                      "Stop after this many whole frames of each radar; 0: never");
  command->add_option("--seconds", arguments->seconds, "Stop after this long; 0: never")
      ->type_name("S")
      ->check(number_from(0, kMostSeconds));
  command
      ->add_flag("--all", arguments->all,
                 "All radars of the server, in one recording and so in step; `obliq replay --radar` chooses")
      ->excludes("--radar");
  command->add_flag("--lossless", arguments->lossless,
                    "Leave no frame out: the radar waits for the disk. Needs the role controller");
  command->add_flag("--truth", arguments->truth,
                    "Keep where targets are, too (`obliq replay --targets`). Needs the server's truth role");
  add_reconnect_argument(*command, arguments->reconnect_s);
  command->add_flag("--force", arguments->force, "Overwrite a file that exists");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
