// The bits of whole frames, plane by plane, recorded in frame_sums.txt: a change of the code that should not
// move them does not. One that should is recorded anew, and CHANGES.md says so:
//
//   OBLIQ_WRITE_FRAME_SUMS=tests/accuracy/frame_sums.txt build/release/bin/frame_sums_test
//
// The sums hold for a C library that uses fused multiply-add in sin and asin, those of traced rays for the
// version of Embree and the instruction set that their names carry; elsewhere they are skipped by name.
#include <gtest/gtest.h>

#include <cinttypes>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "server/scene/embree_tracer.h"
#include "tests/support/fnv1a.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

template <class T>
std::string sum_of(const std::vector<T>& values) {
  test::Fnv1a all;
  all.add(values);
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, all.sum());
  return text;
}

struct Case {
  std::string name;
  std::shared_ptr<const Scene> scene;
  RadarSettings settings;
};

std::shared_ptr<const World> hills(double prisms_per_km2) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 9000, 32);
  spec.terrain.shape.height_m = 500;
  spec.radius_factor = 4.0 / 3;
  if (prisms_per_km2 > 0) {
    spec.prisms.emplace_back();
    spec.prisms[0].per_km2 = prisms_per_km2;
  }
  return std::make_shared<const World>(load_world(spec));
}

/// Waves with holes in the elevation model, one of them under the antenna, and four buildings.
std::shared_ptr<const World> holes() {
  World world = test::made_world(9000, 40, [](double x, double z) {
    const bool hole = std::hypot(x, z) < 300 || std::hypot(x - 2500, z + 4000) < 700;
    return hole ? test::kUnknown : 120 * std::sin(x / 700) * std::cos(z / 900) + 150;
  });
  test::add_prism(world, test::rectangle(0, -3200, 60, 40), 25);
  test::add_prism(world, test::rectangle(900, -4100, 9, 15), 8);
  test::add_prism(world, test::rectangle(-1200, -5000, 300, 20), 60);
  test::add_prism(world, test::rectangle(-300, -6500, 25, 25), 120);
  return std::make_shared<const World>(std::move(world));
}

RadarSettings settings_of(FrustumKind kind, PlateKind plates, SpeckleKind speckle) {
  RadarSettings s;
  s.frustum = kind;
  s.plates = plates;
  s.speckle = speckle;
  s.sector_deg = 60;
  s.r_min_m = 2000;
  s.r_max_m = 8000;
  s.pixel_columns = 256;
  s.pixel_rows = 192;
  s.azimuth_bins = 40;
  s.range_bins = 96;
  return s;
}

std::string named(const std::string& world, const RadarSettings& s, const std::string& more = "") {
  std::string name = world + "/" + frustum_name(s.frustum);
  if (s.frustum != FrustumKind::sweep) name += "/" + plates_name(s.plates);
  return name + (s.speckle == SpeckleKind::ground ? "/ground" : "/geometric") + more;
}

std::vector<Case> cases_of(const std::string& name, const std::shared_ptr<const World>& world, RayMethod rays,
                           const std::string& more) {
  const auto scene = std::make_shared<const Scene>(world, test::two_materials(), 0, rays);
  std::vector<Case> cases;
  for (const FrustumKind kind :
       {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::polar, FrustumKind::sweep}) {
    if (kind == FrustumKind::sweep && rays == RayMethod::embree) continue;  // casts none
    for (const PlateKind plates : {PlateKind::spread, PlateKind::nearest}) {
      if (kind == FrustumKind::sweep && plates == PlateKind::nearest) continue;  // has none
      for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::geometric}) {
        const RadarSettings s = settings_of(kind, plates, speckle);
        cases.push_back({named(name, s, more), scene, s});
      }
    }
  }
  return cases;
}

/// 360 degrees and one bin, for the frusta that can look all round.
std::vector<Case> odd_cases(const std::string& name, const std::shared_ptr<const World>& world) {
  const auto scene = std::make_shared<const Scene>(world, test::two_materials(), 0, RayMethod::march);
  std::vector<Case> cases;
  for (const FrustumKind kind : {FrustumKind::polar, FrustumKind::sweep}) {
    RadarSettings s = settings_of(kind, PlateKind::spread, SpeckleKind::ground);
    s.sector_deg = 360;
    s.r_min_m = 0;
    cases.push_back({named(name, s, "/360 deg"), scene, s});
    s.azimuth_bins = s.range_bins = 1;
    cases.push_back({named(name, s, "/one bin"), scene, s});
  }
  return cases;
}

/// Narrow azimuth bins, with and without buildings' own planes.
std::vector<Case> narrow_cases(const std::string& name, const std::shared_ptr<const World>& world) {
  const auto scene = std::make_shared<const Scene>(world, test::two_materials(), 0, RayMethod::march);
  std::vector<Case> cases;
  for (const int planes : {1, 2, 8}) {
    RadarSettings s = settings_of(FrustumKind::sweep, PlateKind::spread, SpeckleKind::ground);
    s.sector_deg = 16;
    s.pixel_columns = planes * s.azimuth_bins;
    s.sub_columns = 64;
    cases.push_back({named(name, s, "/sub-columns, " + std::to_string(planes) + " planes"), scene, s});
  }
  return cases;
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  const auto take = [&cases](std::vector<Case> more) {
    for (Case& k : more) cases.push_back(std::move(k));
  };
  const std::string embree = std::string("/") + EmbreeTracer::version() + " " + isa_name(TracerIsa::avx2);
  const std::pair<std::string, std::shared_ptr<const World>> worlds[] = {
      {"hills", hills(0)}, {"houses", hills(60)}, {"holes", holes()}};
  for (const auto& [name, world] : worlds) {
    take(cases_of(name, world, RayMethod::march, ""));
    take(odd_cases(name, world));
    take(narrow_cases(name, world));
  }
  const auto traced = std::make_shared<const Scene>(worlds[1].second, test::two_materials(), 0,
                                                    RayMethod::embree, TracerIsa::avx2);
  for (Case k : cases_of("houses", worlds[1].second, RayMethod::embree, embree)) {
    k.scene = traced;
    cases.push_back(std::move(k));
  }
  return cases;
}

/// "iq power count state", the sum of each plane.
std::string sums_of(const Frame& frame) {
  return sum_of(frame.bins.iq) + " " + sum_of(frame.bins.power_w) + " " + sum_of(frame.bins.count) + " " +
         sum_of(frame.bins.state);
}

constexpr const char* kFile = OBLIQ_SOURCE_DIR "/tests/accuracy/frame_sums.txt";

std::map<std::string, std::string> recorded() {
  std::map<std::string, std::string> sums;
  std::ifstream file(kFile);
  for (std::string line; std::getline(file, line);) {
    const std::size_t tab = line.find('\t');
    if (line.rfind('#', 0) == 0 || tab == std::string::npos) continue;
    sums[line.substr(0, tab)] = line.substr(tab + 1);
  }
  return sums;
}

TEST(FrameSums, AreThoseRecordedForAnyNumberOfThreads) {
  if (!has_isa(TracerIsa::avx2)) GTEST_SKIP() << "no sums recorded without fused multiply-add";
  const char* target = std::getenv("OBLIQ_WRITE_FRAME_SUMS");
  std::ofstream written;
  if (target) {
    written.open(target);
    written << "# case, a tab, then the sums (FNV-1a, 64 bits) of the planes iq, power, count, state. "
               "Written by\n"
               "# frame_sums_test, see there.\n";
  }
  const auto sums = recorded();
  const auto cases = all_cases();
  EXPECT_GE(cases.size(), 40u);
  for (const Case& k : cases) {
    const Pose pose = test::pose_over_origin(k.scene->world(), 1500, 40);
    std::string by_threads[2];
    for (const int threads : {1, 3}) {
      RenderOptions options;
      options.threads = threads;
      const Frame frame =
          render(k.scene, test::snapshot(k.settings), pose, {0, k.settings.azimuth_bins}, options);
      EXPECT_GT(frame.stats.samples, 100u) << k.name;
      by_threads[threads == 3] = sums_of(frame);
    }
    EXPECT_EQ(by_threads[0], by_threads[1]) << k.name << ": one thread, three threads";
    if (target) {
      written << k.name << '\t' << by_threads[0] << '\n';
      continue;
    }
    const auto line = sums.find(k.name);
    if (line == sums.end() && k.name.find("Embree") != std::string::npos) {
      std::printf("    no sums recorded: %s\n", k.name.c_str());
      continue;
    }
    ASSERT_NE(line, sums.end()) << k.name << " is not in " << kFile;
    EXPECT_EQ(by_threads[0], line->second) << k.name;
  }
}

}  // namespace
}  // namespace obliq
