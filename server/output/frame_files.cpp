#include "server/output/frame_files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <system_error>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/output/frame_json.h"
#include "server/output/frame_window.h"
#include "server/output/ground_map.h"
#include "server/output/ground_map_png.h"
#include "server/output/ground_map_tif.h"
#include "server/output/new_files.h"
#include "server/output/npy.h"
#include "server/output/sample_textures.h"
#include "terrain/errors.h"

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

void add_maps(NewFiles& files, const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
              const BinBlock& bins, const FrameFileOptions& options) {
  const wire::FrameDescriptor placed = placed_window(descriptor);
  const GroundMap north_up = map_to_ground(placed, bins, 0);
  files.add("ground_map.tif", [&](const auto& path) {
    write_ground_map_tif(path, north_up, descriptor.pose().latitude_deg(), descriptor.pose().longitude_deg());
  });
  files.add("ground_map.png", [&](const auto& path) {
    if (options.up == MapUp::north) {
      write_ground_map_png(path, north_up, placed, summary);
    } else {
      const double bearing = descriptor.pose().bearing_deg() * std::numbers::pi / 180;
      write_ground_map_png(path, map_to_ground(placed, bins, bearing), placed, summary);
    }
  });
}

/// "a, b and c".
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

std::string what_is_missing(const BinBlock& bins) {
  std::vector<std::string> planes;
  std::vector<std::string> files;
  const auto check = [&](bool there, const char* plane, const char* file) {
    if (there) return;
    planes.emplace_back(plane);
    files.emplace_back(file);
  };
  check(!bins.iq.empty(), "iq", "bins.npy");
  check(!bins.power_w.empty(), "power", "power.npy");
  check(!bins.count.empty(), "count", "count.npy");
  check(!bins.state.empty(), "state", "state.npy");
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

std::string write_frame_files(const std::filesystem::path& directory, const wire::FrameDescriptor& descriptor,
                              const wire::FrameSummary& summary, const BinBlock& bins,
                              const FrameFileOptions& options) {
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
    add_maps(files, descriptor, summary, bins, options);
  } else {
    files.leave_out("ground_map.tif");
    files.leave_out("ground_map.png");
  }
  if (options.samples) {
    files.add("samples.exr", [&](const auto& path) { options.samples->write(path); });
  } else {
    files.leave_out("samples.exr");
  }
  files.leave_out("timing.json");  // of an older frame; that of this one comes when all is written
  files.add("frame.json", [&](const auto& path) { write_whole(path, frame_json(descriptor, summary)); });
  files.put_in_place();
  return what_is_missing(bins);
}

void write_timing(const std::filesystem::path& directory, const std::map<std::string, double>& seconds,
                  const std::string& profile) {
  nlohmann::ordered_json root;
  for (const auto& [name, value] : seconds) root[name] = value;
  if (!profile.empty()) root["profile"] = nlohmann::ordered_json::parse(profile);
  write_text(directory / "timing.json", root.dump(1) + "\n");
}

}  // namespace obliq
