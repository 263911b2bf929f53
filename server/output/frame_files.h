#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

/// Which way ground_map.png points; ground_map.tif is always north up.
enum class MapUp { bearing, north };

/// Makes the folder and proves that it can be written, before any long work. Throws InputError.
void prepare_output_folder(const std::filesystem::path& directory);

/// Writes bins.npy, power.npy, count.npy, state.npy, frame.json, ground_map.png and ground_map.tif into
/// `directory` (created if missing). The one writer behind `obliq render` and `obliq get`: the same
/// descriptor, summary and bins give the same files, bit for bit. Throws InputError that names the file.
void write_frame_files(const std::filesystem::path& directory, const wire::FrameDescriptor& descriptor,
                       const wire::FrameSummary& summary, const BinBlock& bins, MapUp up = MapUp::bearing);

/// Writes a whole text file. Throws InputError that names it.
void write_text(const std::filesystem::path& path, const std::string& text);

/// Writes timing.json, seconds by stage: outside the bit-for-bit promise. `profile`: a JSON object of its
/// own, or empty.
void write_timing(const std::filesystem::path& directory, const std::map<std::string, double>& seconds,
                  const std::string& profile = {});

}  // namespace obliq
