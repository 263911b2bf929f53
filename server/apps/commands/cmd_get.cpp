// `obliq get`: one frame from a server to files, the same files that `obliq render` writes.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>

#include "client/frame_assembler.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/frame_report.h"
#include "server/apps/scene_arguments.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/loading/scene_loading.h"
#include "server/output/frame_files.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

struct GetArguments {
  ServerArguments server;
  StreamArguments stream;
  std::vector<std::string> set;
  std::string out;
  PictureArguments picture;
};

// A frame may wait behind others', and its first wedge takes a while.
constexpr client::Timeout kLongestSilence{600000};

/// A frame on request is whole and taken at once.
std::string why_not_of_one_frame(const Parameter& parameter) {
  const std::string_view name = parameter.key.name;
  if (!name.starts_with("scan.") && name != "antenna.valid_s") return {};
  return "a frame on request takes no notice of it; allowed: parameters other than scan.* and "
         "antenna.valid_s (for a live radar: `obliq set`, `obliq pose`)";
}

/// The radar as it is on the server, with the flags applied.
wire::RenderOnce request_for(client::Client& client, const GetArguments& arguments) {
  const std::string name = choose_remote_radar(client, arguments.server);
  wire::RadarInfo info;
  require(client.get_radar(name, info));
  RadarConfig radar = config_of(info);
  // Which pose of a controller this was, and when, is not part of a frame of our own.
  radar.pose.pose_id = 0;
  radar.pose.sim_time_ns = 0;
  apply_radar_flags(arguments.set, radar, {.why_not = why_not_of_one_frame});
  wire::RenderOnce request;
  request.set_radar(name);
  write_request(radar.settings, *request.mutable_settings());
  write_message(radar.pose, *request.mutable_pose());
  ask_for(arguments.stream, request);
  return request;
}

client::AssembledFrame receive_frame(client::Client& client, wire::RenderOnce& request,
                                     wire::PlaneSet planes) {
  client::FrameAssembler frames(planes);
  client.set_handler(&frames);
  require(client.render_once(request));
  const Progress progress = terminal_progress();
  while (frames.state() != client::FrameAssembler::State::complete) {
    require(client.receive(kLongestSilence));
    if (frames.state() == client::FrameAssembler::State::aborted)
      throw InputError("the server gave the frame up: " + frames.abort_reason());
    if (progress) progress("receiving", frames.fraction());
  }
  client.set_handler(nullptr);
  return frames.take();
}

void run(const GetArguments& arguments) {
  const wire::PlaneSet planes = wanted_planes(arguments.stream);
  FrameFileOptions files;
  files.picture = picture_options(arguments.picture);
  prepare_output_folder(arguments.out);
  const auto start = std::chrono::steady_clock::now();
  client::Client client = connect_to_server(arguments.server, "obliq get");
  wire::RenderOnce request = request_for(client, arguments);
  client::AssembledFrame frame = receive_frame(client, request, planes);
  const double received_s = seconds_since(start);

  files.trains = take_trains(frame);
  const BinBlock bins = take_bins(frame);
  const std::string missing =
      write_frame_files(arguments.out, *frame.descriptor, *frame.summary, bins, files).missing;
  const double written_s = seconds_since(start);
  write_timing(
      arguments.out,
      {{"render_s", frame.render_s}, {"receive_s", received_s}, {"write_s", written_s - received_s}});

  if (!missing.empty()) std::fprintf(stderr, "warning: %s: %s\n", arguments.out.c_str(), missing.c_str());
  print_frame_report(
      arguments.out, *frame.descriptor, *frame.summary,
      "in " + milliseconds_text(frame.render_s) + ", here after " + milliseconds_text(received_s));
}

}  // namespace

void add_get(CLI::App& app) {
  CLI::App* command = app.add_subcommand("get", "Fetch one frame from a server into files");
  auto arguments = std::make_shared<GetArguments>();
  add_server_arguments(*command, arguments->server, true);
  add_stream_arguments(*command, arguments->stream);
  add_repeatable(*command, "--set", arguments->set,
                 "KEY=VALUE: render with this radar parameter instead of the server's, e.g. "
                 "antenna.bearing_deg=90 (repeatable); the server's radar does not change");
  command->add_option("--out", arguments->out, "Folder for the files (made if missing)")
      ->required()
      ->type_name("DIR");
  add_picture_arguments(*command, arguments->picture);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace obliq
