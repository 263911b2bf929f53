#include "server/output/npy.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "terrain/base/errors.h"

namespace obliq {
namespace {

void write(const std::filesystem::path& path, const char* type, const void* data, std::size_t bytes, int rows,
           int columns) {
  std::string dictionary =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}", type, rows, columns);
  // Magic, version and length take 10 bytes; the header is padded so that data starts at a multiple of 64.
  while ((10 + dictionary.size() + 1) % 64 != 0) dictionary += ' ';
  dictionary += '\n';
  std::ofstream file(path, std::ios::binary);
  file.write("\x93NUMPY\x01\x00", 8);
  file.put(static_cast<char>(dictionary.size() & 0xff));
  file.put(static_cast<char>(dictionary.size() >> 8));
  file << dictionary;
  file.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  file.close();
  if (!file) throw InputError(path.string() + ": cannot be written (" + std::strerror(errno) + ")");
}

}  // namespace

void write_npy(const std::filesystem::path& path, const std::vector<std::complex<float>>& data, int rows,
               int columns) {
  write(path, "<c8", data.data(), data.size() * sizeof data[0], rows, columns);
}

void write_npy(const std::filesystem::path& path, const std::vector<double>& data, int rows, int columns) {
  write(path, "<f8", data.data(), data.size() * sizeof data[0], rows, columns);
}

void write_npy(const std::filesystem::path& path, const std::vector<std::uint32_t>& data, int rows,
               int columns) {
  write(path, "<u4", data.data(), data.size() * sizeof data[0], rows, columns);
}

void write_npy(const std::filesystem::path& path, const std::vector<std::uint8_t>& data, int rows,
               int columns) {
  write(path, "|u1", data.data(), data.size() * sizeof data[0], rows, columns);
}

}  // namespace obliq
