#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "server/output/ground_map_png.h"
#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {
struct HeightGrid;
class SampleTextures;

/// Makes the folder and proves that it can be written, before any long work. Throws InputError.
void prepare_output_folder(const std::filesystem::path& directory);

struct FrameFileOptions {
  PictureOptions picture;                   ///< ground_map.tif is always north up
  const SampleTextures* samples = nullptr;  ///< for samples.exr
  /// World coordinates; ground_map.tif is placed by its heights. Without: as if all ground lay at one.
  const HeightGrid* ground = nullptr;
};

struct WrittenFrame {
  std::string missing;  ///< a sentence about the planes that the frame came without; empty: all are there
  std::optional<DbRange> scale;  ///< of the picture; none where there was nothing to see
};

/// Writes bins.npy, power.npy, count.npy, state.npy, ground_map.png, ground_map.tif and, last, frame.json
/// into `directory` (created if missing): all of them or, where one cannot be written, none. A plane that
/// `bins` does not have gives no file, and an older frame's file of that name goes. The one writer behind
/// `obliq render` and `obliq get`: the same descriptor, summary and bins give the same files, bit for bit.
/// Throws InputError that names the file.
WrittenFrame write_frame_files(const std::filesystem::path& directory,
                               const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                               const BinBlock& bins, const FrameFileOptions& options = {});

/// Writes a text file, whole or not at all. Throws InputError that names it.
void write_text(const std::filesystem::path& path, const std::string& text);

/// Writes timing.json, seconds by stage: outside the bit-for-bit promise. `profile`: a JSON object of its
/// own, or empty.
void write_timing(const std::filesystem::path& directory, const std::map<std::string, double>& seconds,
                  const std::string& profile = {});

}  // namespace obliq
