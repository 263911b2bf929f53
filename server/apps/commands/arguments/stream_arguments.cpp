#include "server/apps/commands/arguments/stream_arguments.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <sstream>
#include <string_view>

#include "proto/obliq.pb.h"
#include "proto/plane_coding.h"
#include "server/apps/commands/arguments/number_option.h"
#include "terrain/base/errors.h"

namespace obliq {

namespace {

/// "iq,power" as a set of planes; throws InputError that lists the names.
wire::PlaneSet planes_from_names(const std::string& names) {
  wire::PlaneSet set = 0;
  std::istringstream in(names);
  for (std::string name; std::getline(in, name, ',');) {
    int plane = 0;
    while (plane < wire::kPlanes && name != wire::plane_name(static_cast<wire::Plane>(plane))) ++plane;
    if (!wire::plane_from_number(plane)) {
      set = 0;
      break;
    }
    set = static_cast<wire::PlaneSet>(set | wire::plane_bit(static_cast<wire::Plane>(plane)));
  }
  if (set != 0) return set;
  throw InputError(fmt::format("--planes: found \"{}\"; allowed: one or more of {}, with commas between them",
                               names, wire::plane_names(wire::kEveryPlane)));
}

template <typename Request>
void write_request(const StreamArguments& arguments, Request& request) {
  request.set_iq_encoding(
      arguments.encoding == wire::encoding_name(wire::IqEncoding::ci16_le) ? wire::CI16_LE : wire::CF32_LE);
  request.set_compression(arguments.compression == wire::compression_name(wire::Compression::zstd)
                              ? wire::ZSTD
                              : wire::UNCOMPRESSED);
  const wire::Window window{parse_bin_run(arguments.azimuths, "--azimuths"),
                            parse_bin_run(arguments.ranges, "--ranges")};
  if (!window.is_whole()) wire::write_window(window, *request.mutable_window());
  if (arguments.video_bits == 16) request.set_video_bits(16);
  const wire::PlaneSet planes = wanted_planes(arguments);
  for (int plane = 0; plane < wire::kPlanes; ++plane)
    if ((planes >> plane) & 1) request.add_planes(static_cast<wire::PlaneKind>(plane));
}

// Long enough for a daemon that is restarted and loads a large scene.
constexpr int kPatience_s = 300;
constexpr int kMaxPatience_s = 86400;

constexpr double kMost_dB = 1000;

DbRange parse_db_range(const std::string& text) {
  DbRange range;
  const std::size_t colon = text.find(':');
  const auto number = [](const std::string& part, double& value) {
    return CLI::detail::lexical_cast(part, value) && std::abs(value) <= kMost_dB;
  };
  if (colon != std::string::npos && number(text.substr(0, colon), range.low) &&
      number(text.substr(colon + 1), range.high) && range.low < range.high)
    return range;
  throw InputError("--db-range: found \"" + text +
                   "\"; allowed: LOW:HIGH in dB, LOW below HIGH, both from -1000 to 1000, such as -20:35");
}

volatile std::sig_atomic_t g_interrupted = 0;
extern "C" void note_interrupt(int) { g_interrupted = 1; }

}  // namespace

void add_stream_arguments(CLI::App& app, StreamArguments& arguments) {
  using wire::Compression;
  using wire::IqEncoding;
  app.add_option(
         "--encoding", arguments.encoding,
         "How I&Q is sent: floats as they are, or 16-bit integers with a scale for each block, half the "
         "bytes")
      ->check(
          CLI::IsMember({wire::encoding_name(IqEncoding::cf32_le), wire::encoding_name(IqEncoding::ci16_le)}))
      ->default_val(wire::encoding_name(IqEncoding::cf32_le));
  app.add_option("--compress", arguments.compression, "Compress all planes")
      ->check(CLI::IsMember(
          {wire::compression_name(Compression::none), wire::compression_name(Compression::zstd)}))
      ->default_val(wire::compression_name(Compression::none));
  app.add_option(
         "--azimuths", arguments.azimuths,
         "Only these azimuth bins, those below END, every STEP-th; any part may be left out: 100:200, ::4")
      ->type_name("FIRST:END:STEP");
  app.add_option("--ranges", arguments.ranges, "The same for range bins")->type_name("FIRST:END:STEP");
  app.add_option("--planes", arguments.planes,
                 fmt::format("Only these of {}, with commas between them; without: the first four",
                             wire::plane_names(wire::kEveryPlane)))
      ->type_name("NAMES");
  app.add_option("--video-bits", arguments.video_bits, "Bits of the plane video")
      ->check(CLI::IsMember({8, 16}))
      ->default_val(8);
}

void ask_for(const StreamArguments& arguments, wire::Subscribe& request) {
  write_request(arguments, request);
}
void ask_for(const StreamArguments& arguments, wire::RenderOnce& request) {
  write_request(arguments, request);
}

wire::PlaneSet wanted_planes(const StreamArguments& arguments) {
  return arguments.planes.empty() ? wire::kAllPlanes : planes_from_names(arguments.planes);
}

wire::BinRun parse_bin_run(const std::string& text, const std::string& option) {
  const auto refuse = [&] {
    throw InputError(
        option + ": found \"" + text +
        "\"; allowed: FIRST:END:STEP with END above FIRST and STEP from 1, such as 100:200, :512 "
        "or ::4");
  };
  std::array<std::uint32_t, 3> parts{0, 0, 1};
  std::string_view rest = text;
  bool has_end = false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t colon = rest.find(':');
    const std::string_view part = rest.substr(0, colon);
    if (!part.empty()) {
      const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), parts[i]);
      if (error != std::errc() || end != part.data() + part.size()) refuse();
      if (i == 1) has_end = true;
    }
    if (colon == std::string_view::npos) {
      if (i == 0 && !text.empty()) refuse();  // a single number says neither where to begin nor where to end
      break;
    }
    if (i + 1 == parts.size()) refuse();
    rest.remove_prefix(colon + 1);
  }
  if (parts[2] == 0 || (has_end && parts[1] <= parts[0])) refuse();
  return {parts[0], has_end ? parts[1] - parts[0] : 0, parts[2]};
}

void add_rate_argument(CLI::App& app, double& rate_hz, const std::string& text) {
  app.add_option("--rate", rate_hz, text)->type_name("HZ")->default_val(1.0)->check(a_rate());
}

void add_frames_argument(CLI::App& app, std::uint64_t& frames, const std::string& text) {
  app.add_option("--frames", frames, text)->type_name("N")->check(a_count());
}

bool is_warning(const client::Status& status, const char* before) {
  constexpr std::uint32_t kFirstErrorOfRadar = 100;  // errors below it end the connection
  const bool warns = status.outcome == client::Outcome::refused && status.number >= kFirstErrorOfRadar;
  if (warns) std::fprintf(stderr, "%swarning: %s\n", before, status.sentence().c_str());
  return warns;
}

void add_reconnect_argument(CLI::App& app, int& patience_s) {
  app.add_option("--reconnect", patience_s,
                 "After losing the connection, try for this long to reconnect; 0: end at once")
      ->type_name("SECONDS")
      ->default_val(kPatience_s)
      ->check(whole_number_from(0, kMaxPatience_s));
}

client::ResumeOptions reconnecting(int patience_s) {
  client::ResumeOptions options;
  options.patience = std::chrono::seconds(patience_s);
  options.on_lost = [patience_s](const client::Status& why) {
    std::fprintf(stderr, "obliq: connection lost: %s; retrying for at most %d s\n", why.sentence().c_str(),
                 patience_s);
  };
  options.on_resumed = [](std::chrono::duration<double> after) {
    std::fprintf(stderr, "obliq: connected again, %.1f s after the connection was lost\n", after.count());
  };
  return options;
}

void add_picture_arguments(CLI::App& app, PictureArguments& arguments) {
  app.add_flag("--north-up", arguments.north_up, "Draw the picture north up instead of bearing up");
  app.add_option("--db-range", arguments.db_range,
                 "Levels in dB that are drawn black and white, as the picture's legend counts them: -20:35. "
                 "Without: from what there is to see; of a stream, in its first frame, until the radar's "
                 "settings change")
      ->type_name("LOW:HIGH");
  app.add_flag("--ortho", arguments.ortho,
               "Place ground_map.tif by the heights of the ground instead of as if all of it lay at one; for "
               "`obliq render`, which has the heights");
}

PictureOptions picture_options(const PictureArguments& arguments, bool has_heights) {
  if (arguments.ortho && !has_heights)
    throw InputError(
        "--ortho: found a frame without the heights of its ground; allowed: with `obliq render`, which loads "
        "them");
  PictureOptions options;
  options.up = arguments.north_up ? MapUp::north : MapUp::bearing;
  if (!arguments.db_range.empty()) options.db_range = parse_db_range(arguments.db_range);
  return options;
}

void heed_interrupts() {
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) (void)sigaction(signal, &action, nullptr);
}

bool interrupted() { return g_interrupted != 0; }

}  // namespace obliq
