#pragma once
// A small frame over hills, and the files that are written of it.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "server/output/frame_files.h"
#include "server/radar/frame_plan.h"
#include "tests/support/scenes.h"

namespace obliq {

namespace fs = std::filesystem;

class FrameFilesTest : public testing::Test {
 protected:
  FrameFilesTest();
  ~FrameFilesTest() override;
  void SetUp() override;
  void render_to(const fs::path& folder, HitObserver* observer = nullptr);
  void render_frame(HitObserver* observer = nullptr);

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;

 protected:
  fs::path folder_;
  RadarSettings settings_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const FramePlan> plan_;
  Frame frame_;
  wire::FrameDescriptor& descriptor_;
  wire::FrameSummary& summary_;
};

std::string slurp(const fs::path& path);
/// Every file of a folder with its bytes, hidden ones too.
std::map<std::string, std::string> contents(const fs::path& folder);

}  // namespace obliq
