#include "server/output/frame_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "proto/bin_window.h"
#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"
#include "server/output/ground_map.h"
#include "server/output/sample_textures.h"
#include "terrain/base/errors.h"

namespace obliq {

namespace {

void check_written(const std::filesystem::path& path, const std::ofstream& file) {
  if (!file) throw InputError(path.string() + ": cannot be written (" + std::strerror(errno) + ")");
}

void write_whole(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  check_written(path, file);
}

/// Writes a C-order array as a NumPy .npy file, format version 1.0 (NEP 1), little-endian.
/// `type` as numpy spells it. Throws InputError that names the file.
template <class Value>
void write_npy(const std::filesystem::path& path, const char* type, const std::vector<Value>& data,
               const std::vector<int>& shape) {
  std::string dictionary =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, fmt::join(shape, ", "));
  // Magic, version and length take 10 bytes; the header is padded so that data starts at a multiple of 64.
  while ((10 + dictionary.size() + 1) % 64 != 0) dictionary += ' ';
  dictionary += '\n';
  std::ofstream file(path, std::ios::binary);
  file.write("\x93NUMPY\x01\x00", 8);
  file.put(static_cast<char>(dictionary.size() & 0xff));
  file.put(static_cast<char>(dictionary.size() >> 8));
  file << dictionary;
  file.write(reinterpret_cast<const char*>(data.data()),
             static_cast<std::streamsize>(data.size() * sizeof data[0]));
  file.close();
  check_written(path, file);
}

/// Trains are alike.
void write_pulses(const std::filesystem::path& path, const std::vector<PulseTrain>& trains) {
  std::vector<std::complex<float>> all;
  for (const PulseTrain& train : trains) all.insert(all.end(), train.iq.begin(), train.iq.end());
  write_npy(path, "<c8", all, {static_cast<int>(trains.size()), trains[0].n_pulses, trains[0].n_range});
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
    GroundMapRequest request;
    request.least_pixel_m = placed.range_spacing_m();
    request.ground = options.ground;
    const GroundMap map = map_to_ground(MapProjection(placed), bins.n_azimuth, bins.n_range, request);
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

/// Calls use(plane, file, numpy's name of the type, values) for each plane; an empty one is not there.
template <class Use>
void each_plane(const BinBlock& bins, const Use& use) {
  use("iq", "bins.npy", "<c8", bins.iq);
  use("power", "power.npy", "<f8", bins.power_w);
  use("count", "count.npy", "<u4", bins.count);
  use("state", "state.npy", "|u1", bins.state);
  if (bins.video16.empty())
    use("video", "video.npy", "|u1", bins.video8);
  else
    use("video", "video.npy", "<u2", bins.video16);
  use("material", "material.npy", "|u1", bins.labels.material);
  use("building", "building.npy", "<f4", bins.labels.building);
  use("height", "height.npy", "<f4", bins.labels.height_m);
  use("returns", "returns.npy", "|u1", bins.labels.returns);
  use("target", "target.npy", "<u4", bins.target);
}

/// Video and labels come where they were asked for.
bool is_of_every_frame(const std::string& plane) {
  return plane == "iq" || plane == "power" || plane == "count" || plane == "state";
}

std::string what_is_missing(const BinBlock& bins, bool has_pulses) {
  std::vector<std::string> planes;
  std::vector<std::string> files;
  each_plane(bins, [&](const std::string& plane, const char* file, const char*, const auto& values) {
    if (!values.empty() || !is_of_every_frame(plane)) return;
    planes.push_back(plane);
    files.emplace_back(file);
  });
  if (planes.empty() || (has_pulses && planes.size() == 4)) return {};
  std::string text = "the frame came without " + listed(planes);
  if (!can_be_drawn(bins)) {
    files.insert(files.end(), {"ground_map.png", "ground_map.tif"});
  } else if (bins.iq.empty()) {
    text += std::string(", so the ground map shows its ") + (bins.power_w.empty() ? "video" : "power");
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
  std::vector<std::string> planes;
  each_plane(bins, [&](const char* plane, const char* file, const char* type, const auto& values) {
    if (values.empty()) return files.leave_out(file);
    files.add(file, [&](const auto& path) { write_npy(path, type, values, {bins.n_azimuth, bins.n_range}); });
    planes.emplace_back(plane);
  });
  if (!options.trains.empty()) {
    files.add("pulses.npy", [&](const auto& path) { write_pulses(path, options.trains); });
    planes.emplace_back("pulses");
  } else {
    files.leave_out("pulses.npy");
  }
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
  files.leave_out("timing.json");  // of an older frame; that of this one comes when all is written
  files.add("frame.json",
            [&](const auto& path) { write_whole(path, frame_json(descriptor, summary, planes)); });
  files.put_in_place();
  written.missing = what_is_missing(bins, !options.trains.empty());
  return written;
}

void write_timing(const std::filesystem::path& directory, const std::map<std::string, double>& seconds,
                  const std::string& profile) {
  nlohmann::ordered_json root;
  for (const auto& [name, value] : seconds) root[name] = value;
  if (!profile.empty()) root["profile"] = nlohmann::ordered_json::parse(profile);
  write_text(directory / "timing.json", root.dump(1) + "\n");
}

std::filesystem::path NewFiles::beside(const std::string& name) const {
  return directory_ / ("." + name + ".new");
}

NewFiles::~NewFiles() {
  std::error_code none;
  for (const std::string& name : written_) std::filesystem::remove(beside(name), none);
}

void NewFiles::add(const std::string& name, const Writer& writer) {
  const std::filesystem::path path = beside(name);
  written_.push_back(name);
  try {
    writer(path);
  } catch (const InputError& error) {
    std::string text = error.what();
    for (auto at = text.find(path.string()); at != std::string::npos; at = text.find(path.string(), at + 1))
      text.replace(at, path.string().size(), (directory_ / name).string());
    throw InputError(text);
  }
}

void NewFiles::leave_out(const std::string& name) { left_out_.push_back(name); }

void NewFiles::put_in_place() {
  std::error_code error;
  for (const std::string& name : left_out_) std::filesystem::remove(directory_ / name, error);
  for (const std::string& name : written_) {
    std::filesystem::rename(beside(name), directory_ / name, error);
    if (error)
      throw InputError((directory_ / name).string() + ": cannot be put in place (" + error.message() + ")");
  }
  written_.clear();
}

void replace_file(const std::filesystem::path& path, const NewFiles::Writer& writer) {
  std::error_code none;
  if (std::filesystem::exists(path, none) && !std::filesystem::is_regular_file(path, none)) {
    writer(path);
    return;
  }
  NewFiles file(path.parent_path());
  file.add(path.filename().string(), writer);
  file.put_in_place();
}

wire::FrameDescriptor placed_window(const wire::FrameDescriptor& descriptor) {
  wire::FrameDescriptor placed = descriptor;
  if (!descriptor.has_window()) return placed;
  const auto window =
      wire::cut_window(wire::read_window(descriptor.window()), descriptor.settings().azimuth_bins(),
                       descriptor.settings().range_bins());
  if (!window)
    throw InputError("frame descriptor: window: found no bin of the frame in it; allowed: at least one");
  const wire::BinRun& azimuth = window->azimuth;
  const wire::BinRun& range = window->range;
  placed.clear_window();
  placed.set_azimuth_start_deg(descriptor.azimuth_start_deg() +
                               azimuth.first * descriptor.azimuth_width_deg());
  placed.set_azimuth_width_deg(azimuth.step * descriptor.azimuth_width_deg());
  placed.set_range_start_m(descriptor.range_start_m() + range.first * descriptor.range_spacing_m());
  placed.set_range_spacing_m(range.step * descriptor.range_spacing_m());
  placed.mutable_settings()->set_azimuth_bins(static_cast<int>(azimuth.kept()));
  placed.mutable_settings()->set_range_bins(static_cast<int>(range.kept()));
  return placed;
}

}  // namespace obliq
