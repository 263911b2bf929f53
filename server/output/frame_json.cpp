#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "proto/bin_window.h"
#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"

namespace obliq {
namespace {

using Json = nlohmann::ordered_json;

/// The edges of a run of bins, many numbers a line: n + 1 where they touch; where only every few are kept,
/// the two edges of each.
std::string edges_text(const std::string& axis, const std::string& unit, const wire::BinRun& run,
                       double start, double width) {
  constexpr std::size_t kLine = 100;
  const bool touch = run.step == 1;
  std::string text = fmt::format(" \"{}{}{}\": [", axis, touch ? "_edges_" : "_intervals_", unit);
  std::string line;
  const auto add = [&](const std::string& item, bool last) {
    if (line.size() + item.size() > kLine) {
      text += "\n  " + line;
      line.clear();
    }
    line += item + (last ? "" : ", ");
  };
  const auto edge = [&](std::uint32_t bin) { return Json(start + bin * width).dump(); };
  for (std::uint32_t k = 0; k < run.kept(); ++k) {
    const std::uint32_t bin = run.first + k * run.step;
    const bool last = k + 1 == run.kept();
    if (touch) {
      add(edge(bin), false);
      if (last) add(edge(bin + 1), true);
    } else {
      add(fmt::format("[{}, {}]", edge(bin), edge(bin + 1)), last);
    }
  }
  return text + "\n  " + line + "]";
}

/// What the numbers mean that a name does not say.
Json notes() {
  return {
      {"arrays",
       "[azimuth][range]: a row is an azimuth bin, clockwise from azimuth_start_deg; a column is a "
       "range bin, outwards"},
      {"azimuth_edges_deg", "true bearings at the antenna, clockwise"},
      {"range_edges_m", "slant ranges; not ranges along the ground"},
      {"unit",
       "of bins.npy, whose phase is phase_sign 4 pi range / wavelength_m; power_unit is of power.npy"},
      {"antenna_y_m",
       "antenna_x_m east, antenna_y_m up, antenna_z_m north: the antenna in the world frame, a "
       "plane that touches the earth at origin_latitude_deg, origin_longitude_deg"},
      {"radius_factor", "effective-earth factor that is part of world y; null: flat ground"},
      {"north_rad",
       "true north at the antenna as an angle in the world frame, clockwise from z: a bearing b "
       "points along b + north_rad"},
      {"bottom_y_m", "lowest ground in sector and range, world y; top_y_m: highest ground or roof"},
      {"map_reference_height_m",
       "median height of the sector's ground above the datum: ground_map places "
       "slant ranges as if all ground lay there"},
  };
}

}  // namespace

std::string frame_json(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                       const std::vector<std::string>& planes) {
  Json root;
  root["frame"] = Json::parse(file_json(descriptor));
  root["summary"] = Json::parse(file_json(summary));
  // A live server numbers its frames; the files of a frame do not depend on how many came before.
  root["frame"].erase("frame_id");
  root["frame"].erase("settings_version");
  root["summary"].erase("frame_id");
  root["frame"]["warnings"] = frame_warnings(descriptor, summary);  // all that the programs print
  root["bin_states"] = {{"0", "not sampled"},
                        {"1", "sampled"},
                        {"2", "shadow"},
                        {"3", "no known surface"},
                        {"4", "no ground at this range"}};
  root["planes"] = planes;
  root["notes"] = notes();
  if (!descriptor.has_window()) root["frame"].erase("window");
  const auto window =
      wire::cut_window(wire::read_window(descriptor.window()), descriptor.settings().azimuth_bins(),
                       descriptor.settings().range_bins())
          .value_or(wire::Window{});
  // Last, so that they do not stand between a reader and the rest.
  std::string text = root.dump(1);
  text.resize(text.rfind('\n'));
  return fmt::format(
      "{},\n{},\n{}\n}}\n", text,
      edges_text("azimuth", "deg", window.azimuth, descriptor.azimuth_start_deg(),
                 descriptor.azimuth_width_deg()),
      edges_text("range", "m", window.range, descriptor.range_start_m(), descriptor.range_spacing_m()));
}

}  // namespace obliq
