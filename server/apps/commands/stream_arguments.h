#pragma once
// How a command asks for frames: encoding, compression, and which bins.
#include <string>

#include "proto/bin_window.h"
#include "proto/plane.h"

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
};

/// Adds --encoding, --compress, --azimuths, --ranges and --planes. `arguments` must outlive the parsing.
void add_stream_arguments(CLI::App& app, StreamArguments& arguments);

/// Writes them into a request. Throws InputError.
void ask_for(const StreamArguments& arguments, wire::Subscribe& request);
void ask_for(const StreamArguments& arguments, wire::RenderOnce& request);

/// Which planes --planes asks for. Throws InputError.
wire::PlaneSet wanted_planes(const StreamArguments& arguments);

/// "FIRST:END:STEP", each part optional, bins below END. Throws InputError that names the option.
wire::BinRun parse_bin_run(const std::string& text, const std::string& option);

}  // namespace obliq
