#pragma once
#include <string>

#include "client/frame_assembler.h"

namespace obliq {

/// Keeps a folder that always holds the files of the newest frame, for watch and replay. What a frame's files
/// lack is told on stderr, once as long as it stays the same.
class NewestFiles {
 public:
  /// Makes the folder. Throws InputError.
  explicit NewestFiles(std::string folder);
  /// Throws InputError.
  void write(client::AssembledFrame frame);

 private:
  std::string folder_;
  std::string missing_;  ///< as it was told
};

}  // namespace obliq
