#include "server/output/frame_files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <system_error>

#include "proto/obliq.pb.h"
#include "server/output/frame_json.h"
#include "server/output/frame_window.h"
#include "server/output/ground_map.h"
#include "server/output/ground_map_png.h"
#include "server/output/ground_map_tif.h"
#include "server/output/npy.h"
#include "terrain/errors.h"

namespace obliq {

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw InputError(path.string() + ": cannot be written (" + std::strerror(errno) + ")");
}

void prepare_output_folder(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw InputError(directory.string() + ": cannot be made (" + error.message() + ")");
  const std::filesystem::path probe = directory / ".obliq-write-test";
  write_text(probe, "");
  std::filesystem::remove(probe, error);
}

void write_frame_files(const std::filesystem::path& directory, const wire::FrameDescriptor& descriptor,
                       const wire::FrameSummary& summary, const BinBlock& bins, MapUp up) {
  prepare_output_folder(directory);
  write_npy(directory / "bins.npy", bins.iq, bins.n_azimuth, bins.n_range);
  write_npy(directory / "power.npy", bins.power_w, bins.n_azimuth, bins.n_range);
  write_npy(directory / "count.npy", bins.count, bins.n_azimuth, bins.n_range);
  write_npy(directory / "state.npy", bins.state, bins.n_azimuth, bins.n_range);
  write_text(directory / "frame.json", frame_json(descriptor, summary));
  const wire::FrameDescriptor placed = placed_window(descriptor);
  const GroundMap north_up = map_to_ground(placed, bins, 0);
  write_ground_map_tif(directory / "ground_map.tif", north_up, descriptor.pose().latitude_deg(),
                       descriptor.pose().longitude_deg());
  if (up == MapUp::north) {
    write_ground_map_png(directory / "ground_map.png", north_up, placed, summary);
  } else {
    const double bearing = descriptor.pose().bearing_deg() * std::numbers::pi / 180;
    write_ground_map_png(directory / "ground_map.png", map_to_ground(placed, bins, bearing), placed, summary);
  }
}

void write_timing(const std::filesystem::path& directory, const std::map<std::string, double>& seconds,
                  const std::string& profile) {
  nlohmann::ordered_json root;
  for (const auto& [name, value] : seconds) root[name] = value;
  if (!profile.empty()) root["profile"] = nlohmann::ordered_json::parse(profile);
  write_text(directory / "timing.json", root.dump(1) + "\n");
}

}  // namespace obliq
