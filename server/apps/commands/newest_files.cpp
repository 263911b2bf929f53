#include "server/apps/commands/newest_files.h"

#include <cstdio>
#include <filesystem>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/output/frame_files.h"
#include "server/output/frame_window.h"
#include "server/output/new_files.h"
#include "terrain/base/errors.h"

namespace obliq {

NewestFiles::NewestFiles(std::string folder, const PictureOptions& picture)
    : folder_(std::move(folder)), picture_(picture), scale_(picture.db_range) {
  prepare_output_folder(folder_);
}

void NewestFiles::write(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                        const BinBlock& bins) {
  FrameFileOptions options;
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

BinBlock take_bins(client::AssembledFrame& frame) {
  BinBlock bins;
  bins.n_azimuth = frame.n_azimuth;
  bins.n_range = frame.n_range;
  bins.iq = std::move(frame.iq);
  bins.power_w = std::move(frame.power_w);
  bins.count = std::move(frame.count);
  bins.state = std::move(frame.state);
  return bins;
}

}  // namespace obliq
