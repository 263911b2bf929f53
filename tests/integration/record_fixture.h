#pragma once
// obliq record and obliq replay against a real obliqd.
#include <gtest/gtest.h>

#include <map>
#include <thread>

#include "client/recording/recorded_frames.h"
#include "tests/integration/daemon.h"

namespace obliq::test {

class RecordTest : public ProgramTest {
 protected:
  std::vector<std::string> record(const std::string& address, std::vector<std::string> more) const {
    std::vector<std::string> all = {"record", "--server", address, "--radar", "main", "--rate", "50"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Waits until the file has so many bytes, or the recorder has ended.
  static void await_size(const std::filesystem::path& file, std::uintmax_t bytes, const Running& recorder) {
    std::error_code none;
    while (!recorder.has_ended()) {
      const auto size = std::filesystem::file_size(file, none);
      if (!none && size >= bytes) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  std::string scene = folder.write(
      "scene.toml",
      text_of(SmallScene{.antenna = "latitude_deg = 33.0\nlongitude_deg = -99.5\nbearing_deg = 20.0\n",
                         .radars = kTwoRadars}));
  std::string file = folder / "main.obliq";
};

/// All frames of a recording by number.
std::map<std::uint64_t, client::AssembledFrame> frames_of(const std::string& file,
                                                          wire::PlaneSet planes = wire::kAllPlanes);

}  // namespace obliq::test
