#include "server/apps/commands/frame_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/apps/replay/received_train.h"
#include "server/output/describe_frame.h"
#include "server/output/frame_files.h"
#include "terrain/base/errors.h"

namespace obliq {

namespace {

std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; });
  return text;
}

bool holds(const std::vector<std::string>& warnings, const std::string& warning) {
  return std::ranges::any_of(warnings, [&, text = without_numbers(warning)](const std::string& other) {
    return without_numbers(other) == text;
  });
}

}  // namespace

void print_frame_report(const std::string& out, const wire::FrameDescriptor& descriptor,
                        const wire::FrameSummary& summary, const std::string& times,
                        const std::vector<std::string>& said) {
  for (const std::string& warning : frame_warnings(descriptor, summary)) {
    if (std::ranges::find(said, warning) == said.end())
      std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
  if (descriptor.settings().frustum() == wire::SWEEP) {
    std::printf("%s: %llu planes", out.c_str(), static_cast<unsigned long long>(summary.rays()));
  } else {
    std::printf("%s: %.2f M rays", out.c_str(), static_cast<double>(summary.rays()) / 1e6);
  }
  std::printf(", %.2f M samples %s", static_cast<double>(summary.samples()) / 1e6, times.c_str());
  if (summary.lit_bins() > 0)
    std::printf(
        ", %llu gaps: %.2f %% of the lit bins unsampled",
        static_cast<unsigned long long>(summary.unsampled_bins()),
        100 * static_cast<double>(summary.unsampled_bins()) / static_cast<double>(summary.lit_bins()));
  if (descriptor.buildings_in_scene() > 0)
    std::printf(", %u of %u buildings seen", summary.buildings_seen(), descriptor.buildings_in_scene());
  std::printf("\n");
}

std::string milliseconds_text(double seconds) { return fmt::format("{:.0f} ms", 1000 * seconds); }

std::string pose_text(const wire::Pose& pose) {
  const std::string tilt = pose.tilt_auto()       ? ", tilt automatic"
                           : pose.tilt_deg() == 0 ? ""
                                                  : fmt::format(", tilt {:.3g} degrees", pose.tilt_deg());
  std::string motion;
  if (pose.has_velocity_north_m_s())
    motion = fmt::format(", {:.1f} m/s north, {:.1f} east, {:.1f} up", pose.velocity_north_m_s(),
                         pose.velocity_east_m_s(), pose.velocity_up_m_s());
  if (pose.roll_deg() != 0 || pose.pitch_deg() != 0)
    motion += fmt::format(", roll {:.1f}, pitch {:.1f} degrees", pose.roll_deg(), pose.pitch_deg());
  return fmt::format("{:.7f} {}, {:.7f} {}, {:.2f} m above {}, bearing {:.3f} degrees{}{}",
                     std::abs(pose.latitude_deg()), pose.latitude_deg() < 0 ? 'S' : 'N',
                     std::abs(pose.longitude_deg()), pose.longitude_deg() < 0 ? 'W' : 'E', pose.height_m(),
                     pose.height_reference() == wire::GROUND      ? "ground"
                     : pose.height_reference() == wire::ELLIPSOID ? "ellipsoid"
                                                                  : "datum",
                     compass_deg(pose.bearing_deg()), tilt, motion);
}

void WarningChanges::tell(std::vector<std::string> now, const std::string& where) {
  if (now == held_) return;
  for (const std::string& warning : now)
    if (!holds(held_, warning)) std::fprintf(stderr, "warning: %s%s\n", where.c_str(), warning.c_str());
  for (const std::string& warning : held_)
    if (!holds(now, warning)) std::fprintf(stderr, "over: %s%s\n", where.c_str(), warning.c_str());
  held_ = std::move(now);
}

NewestFiles::NewestFiles(std::string folder, const PictureOptions& picture)
    : folder_(std::move(folder)), picture_(picture), scale_(picture.db_range) {
  prepare_output_folder(folder_);
}

void NewestFiles::write(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                        const BinBlock& bins, std::vector<PulseTrain> trains) {
  FrameFileOptions options;
  options.trains = std::move(trains);
  options.picture = picture_;
  options.picture.db_range = scale_.next(descriptor);
  const WrittenFrame written = write_frame_files(folder_, descriptor, summary, bins, options);
  scale_.drawn(written.scale);
  if (written.missing != missing_ && !written.missing.empty())
    std::fprintf(stderr, "warning: %s: %s\n", folder_.c_str(), written.missing.c_str());
  missing_ = written.missing;
}

NewestPicture::NewestPicture(std::string file, const PictureOptions& picture)
    : file_(std::move(file)), picture_(picture), scale_(picture.db_range) {
  const std::filesystem::path path(file_);
  if (path.filename().empty() || std::filesystem::is_directory(path))
    throw InputError("--picture: found \"" + file_ + "\", a folder; allowed: a file, such as " +
                     (path / "radar.png").string());
  prepare_output_folder(path.has_parent_path() ? path.parent_path() : ".");
}

void NewestPicture::write(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                          const BinBlock& bins, const std::string& time) {
  const wire::FrameDescriptor placed = placed_window(descriptor);
  picture_.db_range = scale_.next(descriptor);
  picture_.time = time;
  replace_file(file_, [&](const std::filesystem::path& path) {
    scale_.drawn(write_ground_map_png(path, placed, summary, bins, picture_));
  });
}

std::vector<PulseTrain> take_trains(client::AssembledFrame& frame) {
  std::vector<PulseTrain> trains;
  for (client::AssembledTrain& train : frame.trains) trains.push_back(received_train(std::move(train)));
  return trains;
}

BinBlock take_bins(client::AssembledFrame& frame) {
  BinBlock bins;
  bins.n_azimuth = frame.n_azimuth;
  bins.n_range = frame.n_range;
  bins.iq = std::move(frame.iq);
  bins.power_w = std::move(frame.power_w);
  bins.count = std::move(frame.count);
  bins.state = std::move(frame.state);
  bins.labels = {std::move(frame.material), std::move(frame.building), std::move(frame.height_m),
                 std::move(frame.returns)};
  bins.target = std::move(frame.target);
  if (frame.video_bits == 8)
    bins.video8.assign(frame.video.begin(), frame.video.end());
  else
    bins.video16 = std::move(frame.video);
  return bins;
}

}  // namespace obliq
