#include "server/output/frame_files.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/output/bin_levels.h"
#include "server/output/frame_json.h"
#include "server/output/frame_window.h"
#include "server/output/ground_map.h"
#include "server/output/ground_map_png.h"
#include "server/output/ground_map_tif.h"
#include "server/output/new_files.h"
#include "server/output/npy.h"
#include "server/output/sample_textures.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

void write_whole(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw InputError(path.string() + ": cannot be written (" + std::strerror(errno) + ")");
}

void make_folder(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw InputError(directory.string() + ": cannot be made (" + error.message() + ")");
}

/// The grey scale that the picture was drawn with.
std::optional<DbRange> add_maps(NewFiles& files, const wire::FrameDescriptor& descriptor,
                                const wire::FrameSummary& summary, const BinBlock& bins,
                                const FrameFileOptions& options) {
  const wire::FrameDescriptor placed = placed_window(descriptor);
  if (bins.n_azimuth != placed.settings().azimuth_bins() || bins.n_range != placed.settings().range_bins())
    throw InputError("frame descriptor: found other numbers of bins than the frame has; allowed: its own");
  files.add("ground_map.tif", [&](const auto& path) {
    GroundMapWish wish;
    wish.least_pixel_m = placed.range_spacing_m();
    wish.ground = options.ground;
    const GroundMap map = map_to_ground(MapProjection(placed), bins.n_azimuth, bins.n_range, wish);
    const std::string how =
        options.ground ? "slant ranges placed by the heights of the ground"
                       : fmt::format("slant ranges placed as if all ground lay {:.0f} m above the datum",
                                     placed.map_reference_height_m());
    write_ground_map_tif(path, map, bins, bin_levels(placed, bins), placed, how);
  });
  std::optional<DbRange> range;
  files.add("ground_map.png", [&](const auto& path) {
    range = write_ground_map_png(path, placed, summary, bins, options.picture);
  });
  return range;
}

/// "a, b and c".
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

struct PlaneFile {
  const char* plane;
  const char* file;
  bool there;
};

std::vector<PlaneFile> plane_files(const BinBlock& bins) {
  return {{"iq", "bins.npy", !bins.iq.empty()},
          {"power", "power.npy", !bins.power_w.empty()},
          {"count", "count.npy", !bins.count.empty()},
          {"state", "state.npy", !bins.state.empty()}};
}

std::string what_is_missing(const BinBlock& bins) {
  std::vector<std::string> planes;
  std::vector<std::string> files;
  for (const PlaneFile& one : plane_files(bins)) {
    if (one.there) continue;
    planes.emplace_back(one.plane);
    files.emplace_back(one.file);
  }
  if (planes.empty()) return {};
  std::string text = "the frame came without " + listed(planes);
  if (!can_be_drawn(bins)) {
    files.insert(files.end(), {"ground_map.png", "ground_map.tif"});
  } else if (bins.iq.empty()) {
    text += ", so the ground map shows its power";
  }
  return text + "; not written: " + listed(files);
}

}  // namespace

void write_text(const std::filesystem::path& path, const std::string& text) {
  replace_file(path, [&](const std::filesystem::path& beside) { write_whole(beside, text); });
}

void prepare_output_folder(const std::filesystem::path& directory) {
  make_folder(directory);
  const std::filesystem::path probe = directory / ".obliq-write-test";
  write_whole(probe, "");
  std::error_code none;
  std::filesystem::remove(probe, none);
}

WrittenFrame write_frame_files(const std::filesystem::path& directory,
                               const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                               const BinBlock& bins, const FrameFileOptions& options) {
  WrittenFrame written;
  make_folder(directory);
  NewFiles files(directory);
  const auto add_plane = [&](const char* name, const auto& values) {
    if (values.empty()) {
      files.leave_out(name);
    } else {
      files.add(name, [&](const auto& path) { write_npy(path, values, bins.n_azimuth, bins.n_range); });
    }
  };
  add_plane("bins.npy", bins.iq);
  add_plane("power.npy", bins.power_w);
  add_plane("count.npy", bins.count);
  add_plane("state.npy", bins.state);
  if (can_be_drawn(bins)) {
    written.scale = add_maps(files, descriptor, summary, bins, options);
  } else {
    files.leave_out("ground_map.tif");
    files.leave_out("ground_map.png");
  }
  if (options.samples) {
    files.add("samples.exr", [&](const auto& path) { options.samples->write(path); });
  } else {
    files.leave_out("samples.exr");
  }
  std::vector<std::string> planes;
  for (const PlaneFile& one : plane_files(bins))
    if (one.there) planes.emplace_back(one.plane);
  files.leave_out("timing.json");  // of an older frame; that of this one comes when all is written
  files.add("frame.json",
            [&](const auto& path) { write_whole(path, frame_json(descriptor, summary, planes)); });
  files.put_in_place();
  written.missing = what_is_missing(bins);
  return written;
}

void write_timing(const std::filesystem::path& directory, const std::map<std::string, double>& seconds,
                  const std::string& profile) {
  nlohmann::ordered_json root;
  for (const auto& [name, value] : seconds) root[name] = value;
  if (!profile.empty()) root["profile"] = nlohmann::ordered_json::parse(profile);
  write_text(directory / "timing.json", root.dump(1) + "\n");
}

}  // namespace obliq
