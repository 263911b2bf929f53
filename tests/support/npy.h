#pragma once
#include <fstream>
#include <string>
#include <vector>

namespace obliq::test {

/// What follows the header of a version 1 .npy file.
template <class T>
std::vector<T> read_npy(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char head[10] = {};
  file.read(head, sizeof head);
  file.seekg(10 + static_cast<unsigned char>(head[8]) + 256 * static_cast<unsigned char>(head[9]));
  std::vector<T> values;
  for (T value; file.read(reinterpret_cast<char*>(&value), sizeof value);) values.push_back(value);
  return values;
}

}  // namespace obliq::test
