#include "server/apps/commands/picture_arguments.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "terrain/base/errors.h"

namespace obliq {
namespace {

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

}  // namespace

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

}  // namespace obliq
