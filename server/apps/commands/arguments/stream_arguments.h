#pragma once
// How a command asks for frames: encoding, compression, and which bins.
#include <cstdint>
#include <string>

#include "client/resuming_client.h"
#include "proto/bin_window.h"
#include "proto/plane.h"
#include "server/output/ground_map_png.h"

namespace CLI {
class App;
}

namespace obliq::wire {
class Subscribe;
class RenderOnce;
}  // namespace obliq::wire

namespace obliq {

struct StreamArguments {
  std::string encoding;
  std::string compression;
  std::string azimuths;
  std::string ranges;
  std::string planes;
  int video_bits = 8;
};

/// Adds --encoding, --compress, --azimuths, --ranges, --planes and --video-bits. `arguments` must outlive the
/// parsing.
void add_stream_arguments(CLI::App& app, StreamArguments& arguments);

/// Writes them into a request. Throws InputError.
void ask_for(const StreamArguments& arguments, wire::Subscribe& request);
void ask_for(const StreamArguments& arguments, wire::RenderOnce& request);

/// Which planes --planes asks for. Throws InputError.
wire::PlaneSet wanted_planes(const StreamArguments& arguments);

/// "FIRST:END:STEP", each part optional, bins below END. Throws InputError that names the option.
wire::BinRun parse_bin_run(const std::string& text, const std::string& option);

/// Adds --rate and --frames, which say what they say.
void add_rate_argument(CLI::App& app, double& rate_hz, const std::string& text);
void add_frames_argument(CLI::App& app, std::uint64_t& frames, const std::string& text);

// How the commands that stay connected report a lost connection.

/// Whether it is a refusal that concerns a radar, which may recover: then it is told as a warning.
bool is_warning(const client::Status& status, const char* before = "");

/// Adds --reconnect. `patience_s` must outlive the parsing.
void add_reconnect_argument(CLI::App& app, int& patience_s);

/// Says on stderr when the connection is lost and when it is back.
client::ResumeOptions reconnecting(int patience_s);

// How a command's pictures look.

struct PictureArguments {
  bool north_up = false;
  std::string db_range;
  bool ortho = false;
};

/// Adds --north-up, --db-range and --ortho. `arguments` must outlive the parsing.
void add_picture_arguments(CLI::App& app, PictureArguments& arguments);

/// `has_heights`: the command knows the ground, as --ortho needs it. Throws InputError.
PictureOptions picture_options(const PictureArguments& arguments, bool has_heights = false);

/// From now on SIGINT and SIGTERM are noted instead of ending the process; a second one ends it.
void heed_interrupts();

/// Whether one has come.
bool interrupted();

}  // namespace obliq
