#pragma once
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace obliq::test {

/// Of a page's block "```name": offset, colon, bytes, a bar and a comment in each line.
inline std::vector<std::byte> bytes_of_block(const std::string& page, const std::string& name) {
  std::ifstream file(page);
  std::vector<std::byte> bytes;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      inside = line == "```" + name;
      continue;
    }
    if (!inside) continue;
    std::istringstream rest(line.substr(line.find(':') + 1));
    for (std::string word; rest >> word && word != "|";)
      bytes.push_back(static_cast<std::byte>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

}  // namespace obliq::test
