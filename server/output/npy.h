#pragma once
#include <complex>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace obliq {

/// Writes a C-order [rows][columns] array as a NumPy .npy file, format version 1.0 (NEP 1), little-endian.
/// Throws InputError that names the file.
void write_npy(const std::filesystem::path& path, const std::vector<std::complex<float>>& data, int rows,
               int columns);
void write_npy(const std::filesystem::path& path, const std::vector<double>& data, int rows, int columns);
void write_npy(const std::filesystem::path& path, const std::vector<std::uint32_t>& data, int rows,
               int columns);
void write_npy(const std::filesystem::path& path, const std::vector<std::uint8_t>& data, int rows,
               int columns);

}  // namespace obliq
