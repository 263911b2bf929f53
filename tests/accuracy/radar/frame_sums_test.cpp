// The bits of whole frames, plane by plane, recorded in frame_sums.txt: a change of the code that should not
// move them does not. One that should is recorded anew, and CHANGES.md says so:
//
//   OBLIQ_WRITE_FRAME_SUMS=tests/accuracy/radar/frame_sums.txt build/release/bin/frame_sums_test
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

#include "server/radar/beam/echo_rows.h"
#include "server/scene/embree_tracer.h"
#include "tests/support/fnv1a.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::frame_sums_test {
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
  double height_m = 1500;  ///< of the antenna above the datum
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
  for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
    if (kind == FrustumKind::sweep && rays == RayMethod::embree) continue;  // casts none
    for (const PlateKind plates : {PlateKind::spread, PlateKind::nearest}) {
      if (kind == FrustumKind::sweep && plates == PlateKind::nearest) continue;  // has none
      for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::geometric}) {
        if (kind == FrustumKind::sweep && speckle == SpeckleKind::geometric) continue;
        const RadarSettings s = settings_of(kind, plates, speckle);
        cases.push_back({named(name, s, more), scene, s});
      }
    }
  }
  return cases;
}

/// 360 degrees and one bin.
std::vector<Case> odd_cases(const std::string& name, const std::shared_ptr<const World>& world) {
  const auto scene = std::make_shared<const Scene>(world, test::two_materials(), 0, RayMethod::march);
  std::vector<Case> cases;
  RadarSettings s = settings_of(FrustumKind::sweep, PlateKind::spread, SpeckleKind::ground);
  s.sector_deg = 360;
  s.r_min_m = 0;
  cases.push_back({named(name, s, "/360 deg"), scene, s});
  s.azimuth_bins = s.range_bins = 1;
  cases.push_back({named(name, s, "/one bin"), scene, s});
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

/// Radars over bins of 0.1 degrees, each by draft and by standard.
std::vector<Case> radar_cases(const std::string& name, const std::shared_ptr<const World>& world,
                              double height_m, double r_min_m, double r_max_m) {
  const auto scene = std::make_shared<const Scene>(world, test::two_materials(), 0, RayMethod::march);
  std::vector<Case> cases;
  for (const int planes : {1, 2}) {
    RadarSettings sharp = settings_of(FrustumKind::sweep, PlateKind::spread, SpeckleKind::ground);
    sharp.azimuth_bins = 120;
    sharp.sector_deg = 12;
    sharp.pixel_columns = planes * sharp.azimuth_bins;
    sharp.r_min_m = r_min_m;
    sharp.r_max_m = r_max_m;
    const auto take = [&](const std::string& radar, const RadarSettings& s) {
      const std::string quality = planes == 1 ? "draft" : "standard";
      cases.push_back({name + "/" + quality + "/" + radar, scene, s, height_m});
    };
    take("sharp", sharp);
    RadarSettings s = sharp;
    s.beam.pattern = BeamPattern::gaussian;
    s.beam.width_deg = 0.6;
    take("beam", s);
    s = sharp;
    s.pulse.kind = PulseKind::rectangular;
    s.pulse.length_us = 1;
    take("pulse", s);
    s = sharp;
    s.receiver.noise = true;
    s.receiver.stc_range_m = 6000;
    s.receiver.adc_bits = 12;
    s.atmosphere.rain_mm_h = 4;
    take("receiver", s);
    s = sharp;
    s.beam.pattern = BeamPattern::taylor;
    s.beam.width_deg = 0.8;
    s.beam.elevation = ElevationPattern::gaussian;
    s.beam.elevation_width_deg = 40;
    s.pulse.kind = PulseKind::compressed;
    take("beam and pulse", s);
    s.receiver.noise = true;
    s.video.looks = 4;
    take("video", s);
    s.scan_mode = ScanMode::sector;
    s.speckle = SpeckleKind::ground;
    take("dwells", s);
    s.speckle = SpeckleKind::independent;
    take("dwells, independent", s);
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
    take(radar_cases(name, world, 1500, 2000, 8000));
  }
  take(radar_cases("city", hills(300), 1500, 2000, 8000));
  take(radar_cases("street", hills(600), 560, 30, 1500));
  const auto traced = std::make_shared<const Scene>(worlds[1].second, test::two_materials(), 0,
                                                    RayMethod::embree, TracerIsa::avx2);
  for (Case k : cases_of("houses", worlds[1].second, RayMethod::embree, embree)) {
    k.scene = traced;
    cases.push_back(std::move(k));
  }
  return cases;
}

/// "iq power count state video", the sum of each plane.
std::string sums_of(const BinBlock& bins) {
  return sum_of(bins.iq) + " " + sum_of(bins.power_w) + " " + sum_of(bins.count) + " " + sum_of(bins.state) +
         " " + sum_of(bins.video16);
}

/// Of a radar that scans, its dwells from an antenna that moves 3 m from one to the next.
Frame frame_of(const Case& k, int threads) {
  const RadarSettings& s = k.settings;
  const int dwell = s.scan_mode == ScanMode::frame ? s.azimuth_bins : s.scan_dwell_bins;
  SharpStore store;
  RenderOptions options;
  options.threads = threads;
  options.video16 = true;
  options.draw = 5;
  if (dwell < s.azimuth_bins) options.sharp = &store;
  Frame frame;
  frame.bins = BinBlock(0, s.azimuth_bins, s.range_bins);
  Pose pose = test::pose_over_origin(k.scene->world(), k.height_m, 40);
  for (int first = 0; first < s.azimuth_bins; first += dwell) {
    const Frame part = render(k.scene, test::snapshot(s), pose, {first, dwell}, options);
    copy_azimuths(part.bins, frame.bins);
    frame.stats.add(part.stats);
    pose.antenna.m.x += 3;
  }
  return frame;
}

constexpr const char* kFile = OBLIQ_SOURCE_DIR "/tests/accuracy/radar/frame_sums.txt";

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
    written << "# case, a tab, then the sums (FNV-1a, 64 bits) of the planes iq, power, count, state, "
               "video.\n"
               "# Written by frame_sums_test, see there.\n";
  }
  const auto sums = recorded();
  const auto cases = all_cases();
  EXPECT_GE(cases.size(), 120u);
  for (const Case& k : cases) {
    std::string by_threads[2];
    for (const int threads : {1, 3}) {
      const Frame frame = frame_of(k, threads);
      EXPECT_GT(frame.stats.samples, 100u) << k.name;
      by_threads[threads == 3] = sums_of(frame.bins);
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
}  // namespace obliq::frame_sums_test
