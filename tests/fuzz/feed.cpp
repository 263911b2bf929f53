// Runs a fuzz target over files instead of under libFuzzer, in any build: each file as it is, cut at some
// places, and with some bytes changed, always the same ones.
//   fuzz_NAME_seeds FOLDER
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* argc, char*** argv);

namespace {

constexpr std::size_t kCuts = 24;
constexpr std::size_t kFlips = 48;

void feed(const std::string& bytes) {
  // A copy of its own length, so that a sanitizer sees a step beyond it.
  const std::vector<std::uint8_t> input(bytes.begin(), bytes.end());
  (void)LLVMFuzzerTestOneInput(input.data(), input.size());
}

void feed_damaged(const std::string& bytes) {
  for (std::size_t i = 0; i < kCuts; ++i) feed(bytes.substr(0, bytes.size() * i / kCuts));
  for (std::size_t i = 0; i < kFlips && !bytes.empty(); ++i) {
    std::string wrong = bytes;
    char& hit = wrong[(bytes.size() * i / kFlips + i * 7) % bytes.size()];
    hit = static_cast<char>(hit ^ static_cast<char>(1U << (i % 8)));
    feed(wrong);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  if (LLVMFuzzerInitialize != nullptr) (void)LLVMFuzzerInitialize(&argc, &argv);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    std::stringstream text;
    text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    feed(text.str());
    feed_damaged(text.str());
    ++files;
  }
  std::printf("%d files, each with %zu cuts and %zu wrong bytes\n", files, kCuts, kFlips);
  return files > 0 ? 0 : 1;
}
