// The renderer's hits against CGAL's AABB tree, in double, on the mesh that Embree gets.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/control/scene_file.h"
#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/render.h"
#include "server/radar/samples.h"
#include "server/scene/scene_memory.h"
#include "tests/accuracy/radar/rays/reference_mesh.h"
#include "tests/support/figures.h"
#include "tests/support/scene_mesh.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::tracer_test {
namespace {

/// Every hit of a frame by pixel.
class HitsByPixel : public HitObserver {
 public:
  explicit HitsByPixel(std::size_t pixels) : hits(pixels) {}
  void on_hit(std::uint32_t pixel, double, const ExactHit& hit) override { hits.at(pixel) = hit; }
  std::vector<std::optional<ExactHit>> hits;
};

struct Comparison {
  std::uint64_t rays = 0, hits = 0, on_buildings = 0;
  std::uint64_t differ = 0;     ///< another triangle, or only one of the two tracers hit
  std::uint64_t near_edge = 0;  ///< of those, within 2 float steps of an edge or silhouette
  std::uint64_t sample = 0, sample_near_edge = 0;  ///< one ray in 16, whether it differs or not
  double worst_m = 0;                              ///< refined range against long double, same triangle
  double float_worst_m = 0, float_squares = 0;     ///< Embree's own distance, same triangle
};

test::Vector3 vector(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

/// Whether turning the ray by up to 2 float steps (angle = step / r, eight ways) meets other triangles.
bool near_edge(const test::ReferenceMesh& mesh, const test::Vector3& origin, const test::Vector3& direction,
               const std::optional<test::ReferenceMesh::Hit>& hit, double range_m) {
  const auto range = static_cast<float>(range_m);
  const double step = static_cast<double>(std::nextafter(range, HUGE_VALF) - range) / range_m;
  for (const double size : {1.0, 2.0}) {
    for (int way = 0; way < 8; ++way) {
      const double angle = way * M_PI / 4;
      const auto other = mesh.first_hit(
          origin, test::turned(direction, size * step * std::cos(angle), size * step * std::sin(angle)));
      if (other.has_value() != hit.has_value() || (hit && other->triangle != hit->triangle)) return true;
    }
  }
  return false;
}

Comparison compare(const Scene& scene, const FramePlan& plan, const test::ReferenceMesh& mesh) {
  const RadarSettings& settings = plan.settings();
  HitsByPixel observer(static_cast<std::size_t>(settings.pixel_columns) *
                       static_cast<std::size_t>(settings.pixel_rows));
  RenderOptions options;
  options.observer = &observer;
  options.on_wedge = [](Wedge&&) {};
  render_wedges(plan, {0, settings.azimuth_bins}, options);

  Comparison c;
  const glm::dvec3 antenna = plan.sector().antenna_m;
  const test::Vector3 origin = vector(antenna);
  const auto source = make_ray_source(plan.looks_at(), {0, settings.azimuth_bins});
  const auto rays = std::make_unique<RayBatch>();
  std::vector<RoughHit> rough(kBatch);
  while (source->generate(*rays)) {
    scene.tracer().trace(antenna, rays->dir_x.data(), rays->dir_y.data(), rays->dir_z.data(), rays->n,
                         rough.data());
    for (std::size_t k = 0; k < static_cast<std::size_t>(rays->n); ++k) {
      const test::Vector3 direction{rays->dir_x[k], rays->dir_y[k], rays->dir_z[k]};
      const auto& mine = observer.hits[rays->pixel[k]];
      const auto reference = mesh.first_hit(origin, direction);
      ++c.rays;
      const double range_m = reference ? reference->distance_m : mine ? mine->slant_range_m : 1e5;
      if (rays->pixel[k] % 16 == 0) {
        ++c.sample;
        c.sample_near_edge += near_edge(mesh, origin, direction, reference, range_m) ? 1U : 0U;
      }
      // Inside to 1e-6 of the triangle's size: a point on a shared edge belongs to both triangles.
      const bool same = mine.has_value() == reference.has_value() &&
                        (!mine || (mine->face == mesh.face(reference->triangle) &&
                                   mesh.on_triangle(reference->triangle, vector(mine->position_m), 1e-6)));
      if (!same) {
        ++c.differ;
        const bool excused = near_edge(mesh, origin, direction, reference, range_m);
        c.near_edge += excused ? 1 : 0;
        if (!excused && c.differ - c.near_edge < 5)
          std::printf("    pixel %u direction %.17g %.17g %.17g: product %s %.6f m, CGAL %s %.6f m\n",
                      rays->pixel[k], direction.x, direction.y, direction.z, mine ? "hit" : "miss",
                      mine ? mine->slant_range_m : 0.0, reference ? "hit" : "miss",
                      reference ? reference->distance_m : 0.0);
        continue;
      }
      if (!mine) continue;
      ++c.hits;
      c.on_buildings += mine->face != kNoFace ? 1U : 0U;
      c.worst_m = std::max(c.worst_m, std::abs(mine->slant_range_m - reference->distance_m));
      const double off_m = static_cast<double>(rough[k].distance_m) - reference->distance_m;
      c.float_worst_m = std::max(c.float_worst_m, std::abs(off_m));
      c.float_squares += off_m * off_m;
    }
  }
  return c;
}

/// Both frusta of one scene file.
void compare_all(const test::Folder& folder, const std::string& scene_text, bool with_buildings) {
  const std::string file = folder.text("scene.toml", scene_text);
  const std::string ply = folder.file("scene.ply");
  const SceneConfig config = load_scene_file(file);
  const auto world = std::make_shared<const World>(load_world(config.world));
  const auto scene = std::make_shared<const Scene>(world, config.materials, 0);
  test::write_scene_mesh(*world, ply);
  const test::ReferenceMesh mesh(ply);
  ASSERT_EQ(mesh.size(), surface_triangles(*world));
  std::vector<FieldError> errors;
  const auto pose = place_antenna(*world, config.radars[0].pose, errors);
  ASSERT_TRUE(pose);
  for (const FrustumKind kind : {FrustumKind::oblique, FrustumKind::symmetric}) {
    RadarSettings settings = config.radars[0].settings;
    settings.frustum = kind;
    const PlanResult planned = plan_frame(scene, test::snapshot(settings), *pose);
    ASSERT_TRUE(planned.plan) << planned.errors.front().text();
    const Comparison c = compare(*scene, *planned.plan, mesh);
    const char* name = kind == FrustumKind::oblique ? "oblique" : "symmetric";
    std::printf(
        "    %s: %zu triangles, %llu rays, %llu hits (%llu on buildings), %llu on other triangles, all but "
        "%llu "
        "near edges; %.2f %% of all rays near edges; range within %.1e m; Embree's float %.2f mm rms, %.1f "
        "mm worst\n",
        name, mesh.size(), static_cast<unsigned long long>(c.rays), static_cast<unsigned long long>(c.hits),
        static_cast<unsigned long long>(c.on_buildings), static_cast<unsigned long long>(c.differ),
        static_cast<unsigned long long>(c.differ - c.near_edge),
        100.0 * static_cast<double>(c.sample_near_edge) / static_cast<double>(c.sample), c.worst_m,
        1000 * std::sqrt(c.float_squares / static_cast<double>(c.hits)), 1000 * c.float_worst_m);
    const std::string figure = std::string("tracer_") + name;
    test::record_figure(figure + "_rays", static_cast<double>(c.rays));
    test::record_figure(figure + "_differ", static_cast<double>(c.differ - c.near_edge));
    test::record_figure(figure + "_worst_m", c.worst_m);
    test::record_figure(figure + "_float_rms_m", std::sqrt(c.float_squares / static_cast<double>(c.hits)));
    test::record_figure(figure + "_float_worst_m", c.float_worst_m);
    EXPECT_GT(c.hits, 50000u) << name;
    EXPECT_EQ(c.differ, c.near_edge) << name;
    EXPECT_LE(static_cast<double>(c.differ), 1e-3 * static_cast<double>(c.rays)) << name;
    EXPECT_LT(c.worst_m, 1e-6) << name;
    // The comparison can fail: Embree's float distance does.
    EXPECT_GT(c.float_worst_m, 1e-3) << name;
    if (with_buildings) {
      EXPECT_GT(c.on_buildings, 100u) << name;
    }
  }
}

std::string radar(double r_min_m, double r_max_m) {
  return "[radar]\nsector_deg = 100.0\nr_min_m = " + std::to_string(r_min_m) +
         "\nr_max_m = " + std::to_string(r_max_m) +
         "\n[frustum]\npixels = 400\n[bins]\nazimuth = 128\nrange = 128\n";
}

TEST(IndependentTracer, FindsTheSameTriangleAndRangeOnHillsWithPrisms) {
  const test::Folder folder;
  compare_all(folder,
              "[terrain]\nsynthetic = \"hills\"\ncell_m = 30.0\n[terrain.shape]\nheight_m = 900.0\n"
              "[earth]\nradius_factor = 1.3333333333333333\n"
              "[[prisms]]\nper_km2 = 20.0\nheight_m = [10.0, 60.0]\n"
              "[antenna]\nheight_m = 1800.0\nbearing_deg = 33.0\n" +
                  radar(2500, 15000),
              true);
}

/// A scene in the Los Angeles tile: its cells, the corners of what is loaded, the antenna, the swath.
void compare_los_angeles(const std::string& cell_and_area, const std::string& antenna,
                         const std::string& radar_text) {
  const std::string name = "la_nasadem_30m/NASADEM_HGT_n34w119.tif";
  const std::string dem = test::shared_file(name);
  if (dem.empty()) GTEST_SKIP() << test::no_shared_file(name);
  const test::Folder folder;
  compare_all(folder,
              "[terrain]\ndem = [\"" + dem + "\"]\n" + cell_and_area + "[antenna]\n" + antenna +
                  "bearing_deg = 15.0\n" + radar_text,
              false);
}

TEST(IndependentTracer, FindsTheSameTriangleAndRangeInLosAngelesToFifteenKilometres) {
  compare_los_angeles("cell_m = 30.0\n", "latitude_deg = 34.2\nlongitude_deg = -118.2\nheight_m = 2400.0\n",
                      radar(2500, 15000));
}

TEST(IndependentTracer, FindsTheSameTriangleAndRangeInLosAngelesToThirtySevenKilometres) {
  // The paper's swath; the edge of the tile lies inside the sector, so some rays meet nothing.
  compare_los_angeles("cell_m = 60.0\narea = [-118.85, 34.0, -118.0, 34.42]\n",
                      "latitude_deg = 34.05\nlongitude_deg = -118.45\nheight_m = 3000.0\n",
                      radar(3700, 37000));
}

}  // namespace
}  // namespace obliq::tracer_test
