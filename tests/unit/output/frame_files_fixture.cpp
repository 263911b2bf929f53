#include "tests/unit/output/frame_files_fixture.h"

#include <fstream>
#include <sstream>

#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"

namespace obliq {

struct FrameFilesTest::Messages {
  wire::FrameDescriptor descriptor;
  wire::FrameSummary summary;
};

FrameFilesTest::FrameFilesTest()
    : messages_(std::make_unique<Messages>()),
      descriptor_(messages_->descriptor),
      summary_(messages_->summary) {}
FrameFilesTest::~FrameFilesTest() = default;

void FrameFilesTest::SetUp() {
  folder_ = fs::path(testing::TempDir()) /
            ("obliq_files_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  fs::remove_all(folder_);
  settings_.frustum = FrustumKind::symmetric;
  settings_.r_min_m = 1500;
  settings_.r_max_m = 9000;
  settings_.pixel_columns = 90;
  settings_.pixel_rows = 70;
  settings_.azimuth_bins = 45;
  settings_.range_bins = 33;
  scene_ = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 12000, 100)));
}

void FrameFilesTest::render_to(const fs::path& folder, HitObserver* observer) {
  render_frame(observer);
  EXPECT_EQ(write_frame_files(folder, descriptor_, summary_, frame_.bins).missing, "");
}

void FrameFilesTest::render_frame(HitObserver* observer) {
  const Pose pose = test::pose_over_origin(scene_->world(), 1200, 40);
  plan_ = plan_frame(scene_, test::snapshot(settings_), pose).plan;
  ASSERT_TRUE(plan_);
  RenderOptions options;
  options.observer = observer;
  frame_ = render(scene_, test::snapshot(settings_), pose, {0, settings_.azimuth_bins}, options);
  descriptor_.Clear();
  summary_.Clear();
  describe_frame(*plan_, "main", "test", descriptor_);
  summarise_frame(*plan_, frame_.stats, summary_);
}

std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) files[entry.path().filename()] = slurp(entry);
  return files;
}

}  // namespace obliq
