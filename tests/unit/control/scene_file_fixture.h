#pragma once
// Scene files in a scratch folder, and what load_scene_file says about them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "server/control/scene_file.h"

namespace obliq {

constexpr auto kFlat = "[terrain]\nsynthetic = \"flat\"\n";

class SceneFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text, const std::string& name = "scene.toml") {
    const auto path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  SceneConfig read(const std::string& text, const std::vector<std::string>& set = {}) {
    return load_scene_file(write(text), {set});
  }
  /// The complaint about a text, with the file's own path shortened to "FILE".
  std::string complaint(const std::string& text, const std::vector<std::string>& set = {}) {
    const auto path = write(text);
    try {
      load_scene_file(path, {set});
    } catch (const InputError& e) {
      std::string what = e.what();
      for (std::size_t at; (at = what.find(path.string())) != std::string::npos;)
        what.replace(at, path.string().size(), "FILE");
      return what;
    }
    return "accepted";
  }
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("obliq_scene_" + std::to_string(getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

}  // namespace obliq
