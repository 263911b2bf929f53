// The paper's bits: nearest bins, rendered before plates could be spread (2026-11), summed for each
// instruction set. Whatever is improved for others, these frames stay the same.
//
// The sums hold for Embree 3.13.5 and a C library that uses fused multiply-add (the planning of a frame
// calls its sin and asin); elsewhere the test is skipped and says so.
#include <gtest/gtest.h>

#include <cinttypes>
#include <cstring>
#include <string>

#include "server/scene/embree_tracer.h"
#include "tests/support/fnv1a.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

struct Case {
  const char* name;
  FrustumKind kind;
  SpeckleKind speckle;
  std::uint64_t sum[kNamedIsas.size()];  ///< SSE4.2, AVX, AVX2, AVX-512
};

// With ground speckle, as since the faces of buildings have a scatterer in each of their cells: power, counts
// and states, and all of geometric speckle, are the paper's as ever.
constexpr Case kCases[] = {
    {"symmetric, ground speckle",
     FrustumKind::symmetric,
     SpeckleKind::ground,
     {0x6512b98532e505fa, 0x6512b98532e505fa, 0x6512b98532e505fa, 0x6512b98532e505fa}},
    {"symmetric, geometric speckle",
     FrustumKind::symmetric,
     SpeckleKind::geometric,
     {0x8c85878cb537a357, 0x8c85878cb537a357, 0x8c85878cb537a357, 0x8c85878cb537a357}},
    {"oblique, ground speckle",
     FrustumKind::oblique,
     SpeckleKind::ground,
     {0x604f00dabf6d1806, 0x604f00dabf6d1806, 0x604f00dabf6d1806, 0x604f00dabf6d1806}},
    {"oblique, geometric speckle",
     FrustumKind::oblique,
     SpeckleKind::geometric,
     {0x86c9ef3817710053, 0x86c9ef3817710053, 0x86c9ef3817710053, 0x86c9ef3817710053}},
};

/// Fractal hills over a 4/3 earth with 60 random prisms a square kilometre.
std::shared_ptr<const World> hills_with_prisms() {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 9000, 32);
  spec.terrain.shape.height_m = 500;
  spec.radius_factor = 4.0 / 3;
  spec.prisms.emplace_back();
  spec.prisms[0].per_km2 = 60;
  return std::make_shared<const World>(load_world(spec));
}

RadarSettings paper_settings(const Case& k) {
  RadarSettings s;
  s.frustum = k.kind;
  s.speckle = k.speckle;
  s.plates = PlateKind::nearest;
  s.r_min_m = 2000;
  s.r_max_m = 8000;
  s.pixel_columns = 400;
  s.pixel_rows = 400;
  s.azimuth_bins = 72;
  s.range_bins = 64;
  return s;
}

TEST(PaperBits, AreWhatTheyWereBeforePlatesCouldBeSpread) {
  if (EmbreeTracer::version() != "Embree 3.13.5")
    GTEST_SKIP() << "no sums recorded for " << EmbreeTracer::version();
  if (!has_isa(TracerIsa::avx2)) GTEST_SKIP() << "no sums recorded without fused multiply-add";
  const auto world = hills_with_prisms();
  for (std::size_t i = 0; i < kNamedIsas.size(); ++i) {
    const TracerIsa isa = kNamedIsas[i];
    if (!has_isa(isa)) {
      std::printf("    %s: this processor has none\n", isa_name(isa));
      continue;
    }
    const auto scene = std::make_shared<const Scene>(world, test::two_materials(), 0, RayMethod::embree, isa);
    for (const Case& k : kCases) {
      const RadarSettings settings = paper_settings(k);
      const Frame frame = render(scene, test::snapshot(settings), test::pose_over_origin(*world, 1500, 40),
                                 {0, settings.azimuth_bins});
      test::Fnv1a all;
      all.add(frame.bins.iq);
      all.add(frame.bins.power_w);
      all.add(frame.bins.count);
      all.add(frame.bins.state);
      std::printf("    %s, %s: 0x%016" PRIx64 ", %llu samples, %u rejected\n", isa_name(isa), k.name,
                  all.sum(), static_cast<unsigned long long>(frame.stats.samples),
                  static_cast<unsigned>(frame.stats.rejected));
      EXPECT_GT(frame.stats.samples, 50000u) << k.name;
      EXPECT_EQ(all.sum(), k.sum[i]) << isa_name(isa) << ", " << k.name;
    }
  }
}

}  // namespace
}  // namespace obliq
