#pragma once
#include <optional>
#include <string>

#include "server/output/ground_map_png.h"

namespace obliq {

/// Keeps a stream's grey scale at that of the first frame that showed something, until the radar's settings
/// change: two pictures of it can be compared.
class SteadyScale {
 public:
  /// `given`: for all frames.
  explicit SteadyScale(std::optional<DbRange> given) : given_(given) {}
  /// For the next frame; nothing: whatever it shows.
  std::optional<DbRange> next(const wire::FrameDescriptor& descriptor);
  void drawn(std::optional<DbRange> scale) { kept_ = scale; }

 private:
  std::optional<DbRange> given_;
  std::optional<DbRange> kept_;
  std::string settings_;  ///< of the frames it was kept for
};

/// Keeps a folder that always holds the files of the newest frame, for watch and replay. What a frame's files
/// lack is told on stderr, once as long as it stays the same.
class NewestFiles {
 public:
  /// Makes the folder. Throws InputError.
  NewestFiles(std::string folder, const PictureOptions& picture);
  /// Throws InputError.
  void write(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
             const BinBlock& bins);

 private:
  std::string folder_;
  PictureOptions picture_;
  SteadyScale scale_;
  std::string missing_;  ///< as it was told
};

/// Keeps a picture of the newest frame.
class NewestPicture {
 public:
  /// Makes the file's folder. Throws InputError.
  NewestPicture(std::string file, const PictureOptions& picture);
  /// time: of the frame, for its caption. Throws InputError.
  void write(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary, const BinBlock& bins,
             const std::string& time);

 private:
  std::string file_;
  PictureOptions picture_;
  SteadyScale scale_;
};

}  // namespace obliq
