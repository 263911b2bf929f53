#pragma once
#include <string>

#include "client/frame_assembler.h"
#include "server/output/steady_scale.h"

namespace obliq {

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

/// A received frame's planes as the file writer takes them; they are moved out of the frame.
BinBlock take_bins(client::AssembledFrame& frame);

}  // namespace obliq
