#pragma once
#include <filesystem>

#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

/// Writes bins.npy, power.npy, count.npy, state.npy, frame.json, ground_map.png and ground_map.tif into
/// `directory` (created if missing). The one writer behind `obliq render` and `obliq get`: the same
/// descriptor, summary and bins give the same files, bit for bit. Throws InputError that names the file.
void write_frame_files(const std::filesystem::path& directory, const wire::FrameDescriptor& descriptor,
                       const wire::FrameSummary& summary, const BinBlock& bins);

}  // namespace obliq
