#pragma once
#include <cstdint>
#include <filesystem>

namespace obliq {

/// Writes 8-bit RGB out of 0x00RRGGBB words, rows `stride` words apart. Compressed lightly: speckle does not
/// become smaller by trying harder, only later. Throws InputError that names the file.
void write_png(const std::filesystem::path& path, const std::uint32_t* pixels, int width, int height,
               int stride);

}  // namespace obliq
