#include "server/output/png_file.h"

#include <png.h>

#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "terrain/base/errors.h"

namespace obliq {
namespace {

/// All of the picture in libpng's hands; false when it could not be written. Nothing in here has a
/// destructor: libpng leaves by longjmp.
bool encode(png_structp png, png_infop info, std::FILE* file, const std::uint32_t* pixels, int width,
            int height, int stride, std::uint8_t* row) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  png_set_compression_level(png, 1);
  png_set_filter(png, 0, PNG_FILTER_SUB);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < height; ++y) {
    const std::uint32_t* from = pixels + static_cast<std::ptrdiff_t>(y) * stride;
    for (int x = 0; x < width; ++x) {
      row[3 * x] = static_cast<std::uint8_t>(from[x] >> 16);
      row[3 * x + 1] = static_cast<std::uint8_t>(from[x] >> 8);
      row[3 * x + 2] = static_cast<std::uint8_t>(from[x]);
    }
    png_write_row(png, row);
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

void write_png(const std::filesystem::path& path, const std::uint32_t* pixels, int width, int height,
               int stride) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  // A failing write is reported once, by us.
  const auto quiet = [](png_structp png, png_const_charp) { png_longjmp(png, 1); };
  const auto silent = [](png_structp, png_const_charp) {};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, quiet, silent);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  std::vector<std::uint8_t> row(3 * static_cast<std::size_t>(width));
  errno = 0;
  bool good = file && info && encode(png, info, file.get(), pixels, width, height, stride, row.data());
  png_destroy_write_struct(&png, &info);
  good = file && std::fclose(file.release()) == 0 && good;
  if (!good)
    throw InputError(path.string() + ": cannot be written (" +
                     (errno != 0 ? std::strerror(errno) : "libpng gave no reason") + ")");
}

}  // namespace obliq
