#pragma once
// A small frame over hills, and the files that are written of it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"
#include "server/output/frame_files.h"
#include "server/radar/frame_plan.h"
#include "tests/support/scenes.h"

namespace obliq {

namespace fs = std::filesystem;

inline std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class FrameFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("obliq_files_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    settings_.frustum = FrustumKind::polar;
    settings_.r_min_m = 1500;
    settings_.r_max_m = 9000;
    settings_.pixel_columns = 90;
    settings_.pixel_rows = 70;
    settings_.azimuth_bins = 45;
    settings_.range_bins = 33;
    scene_ = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 12000, 100)));
  }

  void render_to(const fs::path& folder, SampleTap* tap = nullptr) {
    render_frame(tap);
    EXPECT_EQ(write_frame_files(folder, descriptor_, summary_, frame_.bins).missing, "");
  }

  void render_frame(SampleTap* tap = nullptr) {
    const Pose pose = test::pose_over_origin(scene_->world(), 1200, 40);
    plan_ = plan_frame(scene_, test::snapshot(settings_), pose).plan;
    ASSERT_TRUE(plan_);
    RenderOptions options;
    options.tap = tap;
    frame_ = render(scene_, test::snapshot(settings_), pose, {0, settings_.azimuth_bins}, options);
    descriptor_.Clear();
    summary_.Clear();
    describe_frame(*plan_, "main", "test", descriptor_);
    summarise_frame(*plan_, frame_.stats, summary_);
  }

  fs::path folder_;
  RadarSettings settings_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const FramePlan> plan_;
  Frame frame_;
  wire::FrameDescriptor descriptor_;
  wire::FrameSummary summary_;
};

/// Every file of a folder with its bytes, hidden ones too.
inline std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) files[entry.path().filename()] = slurp(entry);
  return files;
}

}  // namespace obliq
