// Grids that are kept: the second load has the same bits, and nothing that has changed since is used.
#include "terrain/cache/ground_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "terrain/base/hash.h"
#include "terrain/dem/gdal_messages.h"
#include "tests/unit/terrain_files.h"

namespace obliq::ground_cache_test {
namespace {

namespace fs = std::filesystem;
using test::Folder;
using test::RasterPlan;

constexpr double kLon = -99.5;
constexpr double kLat = 33;

double hills(double x, double y) { return 300 + 200 * std::sin(x * 700) * std::cos(y * 900); }

/// An elevation model with a hole that is filled, and a scene of it.
class TerrainCacheTest : public testing::Test {
 protected:
  TerrainCacheTest() {
    plan = test::around(kLon, kLat, [](double x, double y) {
      return std::hypot(x - kLon, y - kLat) < 0.001 ? -9999.0 : hills(x, y);
    });
    plan.nodata = -9999;
    plan.columns = plan.rows = 101;
    dem = write_raster(folder, "dem.tif", plan);
    spec = test::scene(kLon, kLat, 3000, {dem});
    spec.terrain.cell_m = 20;
    spec.radius_factor = 4.0 / 3;
    spec.terrain.cache_folder = folder.file("cache");
  }

  std::vector<fs::path> kept() const {
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder.file("cache"), none))
      found.push_back(entry.path());
    return found;
  }

  static bool says(const World& world, const std::string& what) {
    return std::ranges::any_of(world.report.notes,
                               [&](const std::string& note) { return note.find(what) != std::string::npos; });
  }
  static bool from_cache(const World& world) { return says(world, "heights read from"); }

  static void expect_same(const World& a, const World& b) {
    ASSERT_EQ(a.grid.y_m.size(), b.grid.y_m.size());
    EXPECT_EQ(std::memcmp(a.grid.y_m.data(), b.grid.y_m.data(), a.grid.y_m.size() * sizeof(float)), 0);
    EXPECT_EQ(a.report.posts_filled, b.report.posts_filled);
    EXPECT_EQ(a.report.posts_absent, b.report.posts_absent);
    EXPECT_EQ(a.report.source_error.posts, b.report.source_error.posts);
    EXPECT_EQ(a.report.source_error.median_m, b.report.source_error.median_m);
    EXPECT_EQ(a.report.source_error.p95_m, b.report.source_error.p95_m);
    EXPECT_EQ(a.report.source_error.rms_m, b.report.source_error.rms_m);
    EXPECT_EQ(a.report.source_error.greatest_m, b.report.source_error.greatest_m);
  }

  /// Loads without any cache.
  World fresh() const {
    WorldSpec alone = spec;
    alone.terrain.cache_folder.clear();
    return load_world(alone);
  }

  Folder folder;
  RasterPlan plan;
  std::string dem;
  WorldSpec spec;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST_F(TerrainCacheTest, TheSecondLoadHasTheSameBitsAndReport) {
  const World first = load_world(spec);
  EXPECT_FALSE(from_cache(first));
  EXPECT_GT(first.report.posts_filled, 0u);
  EXPECT_GT(first.report.source_error.posts, 0u);
  ASSERT_EQ(kept().size(), 1u);
  const World second = load_world(spec);
  EXPECT_TRUE(from_cache(second));
  expect_same(second, first);
  expect_same(second, fresh());
}

TEST_F(TerrainCacheTest, WithoutAFolderNothingIsKeptOrSaid) {
  const World world = fresh();
  EXPECT_TRUE(world.report.notes.empty() || !says(world, "terrain.cache"));
  EXPECT_TRUE(kept().empty());
}

TEST_F(TerrainCacheTest, WhoMayNotKeepStillUses) {
  spec.terrain.cache_keeps = false;
  load_world(spec);
  EXPECT_TRUE(kept().empty());
  spec.terrain.cache_keeps = true;
  load_world(spec);
  spec.terrain.cache_keeps = false;
  EXPECT_TRUE(from_cache(load_world(spec)));
}

TEST_F(TerrainCacheTest, EachThingThatAGridIsMadeFromMakesAnother) {
  load_world(spec);
  const auto another = [&](const char* what) {
    const World changed = load_world(spec);
    EXPECT_FALSE(from_cache(changed)) << what;
    expect_same(changed, fresh());
    EXPECT_TRUE(from_cache(load_world(spec))) << what << ", the second time";
  };
  const WorldSpec usual = spec;
  spec.origin.longitude_deg += 1e-7;
  another("origin's longitude");
  spec = usual;
  spec.origin.latitude_deg += 1e-7;
  another("origin's latitude");
  spec = usual;
  spec.terrain.cell_m = 19.96875;
  another("cell");
  spec = usual;
  spec.radius_factor = 1;
  another("earth");
  spec = usual;
  spec.terrain.fill_void_m = 0;
  another("fill");
  spec = usual;
  spec.reaches[0].radius_m = 2900;
  another("reach");
  spec = usual;
  spec.terrain.area = {{kLon - 0.03, kLat - 0.03}, {kLon + 0.03, kLat - 0.03}, {kLon, kLat + 0.03}};
  another("area");
  spec.terrain.area[2].longitude_deg += 0.01;  // within the same rectangle
  another("area's shape");
  spec = usual;
  spec.terrain.unit = VerticalUnit::foot;
  another("unit");
  spec = usual;
  fs::copy_file(dem, folder.file("copy.tif"));
  spec.terrain.dem = {folder.file("copy.tif")};
  another("name");
  spec = usual;
  spec.terrain.dem.push_back(folder.file("copy.tif"));
  another("a second file");
}

TEST_F(TerrainCacheTest, AFileThatHasChangedIsReadAnew) {
  load_world(spec);
  const auto time = fs::last_write_time(dem);
  const std::string bytes = bytes_of(dem);

  fs::last_write_time(dem, time + std::chrono::seconds(1));
  EXPECT_FALSE(from_cache(load_world(spec))) << "time of change";
  fs::last_write_time(dem, time);
  EXPECT_TRUE(from_cache(load_world(spec)));

  // Same name, size and time: the contents tell.
  plan.value = [](double x, double y) { return hills(x, y) + 1; };
  write_raster(folder, "dem.tif", plan);
  ASSERT_EQ(fs::file_size(dem), bytes.size());
  fs::last_write_time(dem, time);
  const World changed = load_world(spec);
  EXPECT_FALSE(from_cache(changed)) << "contents";
  expect_same(changed, fresh());

  write_bytes(dem, bytes + std::string(4096, '\0'));
  fs::last_write_time(dem, time);
  EXPECT_FALSE(from_cache(load_world(spec))) << "size";
}

TEST_F(TerrainCacheTest, WhatStandsBesideAFileCounts) {
  load_world(spec);
  folder.text("dem.tif.aux.xml",
              "<PAMDataset><PAMRasterBand band=\"1\"><UnitType>ft</UnitType></PAMRasterBand></PAMDataset>");
  const World feet = load_world(spec);
  EXPECT_FALSE(from_cache(feet));
  expect_same(feet, fresh());
}

TEST_F(TerrainCacheTest, TheSourcesOfVirtualRastersCountHoweverDeep) {
  const auto virtual_raster = [&](const std::string& name, const std::string& source) {
    std::ostringstream xml;
    xml.precision(17);
    xml << "<VRTDataset rasterXSize=\"101\" rasterYSize=\"101\"><SRS>EPSG:4326</SRS><GeoTransform>";
    for (int k = 0; k < 6; ++k) xml << (k > 0 ? "," : "") << plan.geotransform[static_cast<std::size_t>(k)];
    xml << "</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename "
           "relativeToVRT=\"1\">"
        << source
        << "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>";
    return folder.text(name, xml.str());
  };
  virtual_raster("inner.vrt", "dem.tif");
  spec.terrain.dem = {virtual_raster("outer.vrt", "inner.vrt")};
  load_world(spec);
  EXPECT_TRUE(from_cache(load_world(spec)));
  fs::last_write_time(dem, fs::last_write_time(dem) + std::chrono::seconds(1));
  EXPECT_FALSE(from_cache(load_world(spec)));
}

TEST_F(TerrainCacheTest, DamageAtAnyByteIsSeenAndMended) {
  const World whole = load_world(spec);
  ASSERT_EQ(kept().size(), 1u);
  const fs::path file = kept()[0];
  const std::string good = bytes_of(file);
  const auto expect_mended = [&](const std::string& what) {
    const World again = load_world(spec);
    EXPECT_FALSE(from_cache(again)) << what;
    EXPECT_TRUE(says(again, "is damaged")) << what;
    expect_same(again, whole);
    EXPECT_EQ(bytes_of(file), good) << what;
  };
  // All of the head and the key, every 997th byte of the heights, and the last.
  HeightGrid grid = whole.grid;
  const std::size_t heights = good.size() - grid.y_m.size() * sizeof(float);
  std::vector<std::size_t> places;
  for (std::size_t at = 0; at < heights; at += 7) places.push_back(at);
  for (std::size_t at = heights; at < good.size(); at += 9973) places.push_back(at);
  places.push_back(good.size() - 1);
  for (const std::size_t at : places) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << (at % 8)));
    write_bytes(file, bad);
    expect_mended("byte " + std::to_string(at));
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{87}, heights, good.size() - 1}) {
    write_bytes(file, good.substr(0, size));
    expect_mended("cut to " + std::to_string(size) + " bytes");
  }
  write_bytes(file, good + "x");
  expect_mended("a byte too many");
  std::string swapped = good;
  std::swap_ranges(swapped.begin() + static_cast<std::ptrdiff_t>(heights),
                   swapped.begin() + static_cast<std::ptrdiff_t>(heights) + 4096,
                   swapped.begin() + static_cast<std::ptrdiff_t>(heights) + 8192);
  write_bytes(file, swapped);
  expect_mended("two blocks exchanged");
}

TEST_F(TerrainCacheTest, WhatIsNoFileInAFilesPlaceIsNamedAndPassedBy) {
  load_world(spec);
  ASSERT_EQ(kept().size(), 1u);
  const fs::path grid = kept().front();
  fs::remove(grid);
  ASSERT_EQ(mkfifo(grid.c_str(), 0600), 0);
  World world = load_world(spec);
  EXPECT_TRUE(says(world, grid.string() + " is not a file"));
  expect_same(world, fresh());
  EXPECT_TRUE(from_cache(load_world(spec))) << "a pipe is replaced";
  fs::remove(grid);
  fs::create_directory(grid);
  for (int start = 0; start < 2; ++start) {
    world = load_world(spec);
    EXPECT_TRUE(says(world, grid.string() + " is not a file"));
    EXPECT_FALSE(says(world, "is damaged"));
    expect_same(world, fresh());
  }
}

TEST_F(TerrainCacheTest, AnotherGridsFileIsNotTakenForThisOnes) {
  load_world(spec);
  const fs::path mine = kept()[0];
  WorldSpec other = spec;
  other.radius_factor = 1;
  load_world(other);
  for (const fs::path& file : kept())
    if (file != mine) fs::copy_file(file, mine, fs::copy_options::overwrite_existing);
  const World again = load_world(spec);
  EXPECT_FALSE(from_cache(again));
  expect_same(again, fresh());
}

TEST_F(TerrainCacheTest, AFolderThatCannotBeWrittenIsOneLineAndNoMore) {
  spec.terrain.cache_folder = dem + "/cache";  // below a file: not even root makes that
  const World world = load_world(spec);
  expect_same(world, fresh());
  EXPECT_EQ(std::ranges::count_if(world.report.notes,
                                  [](const std::string& n) { return n.find("terrain.cache") == 0; }),
            1);
  EXPECT_TRUE(says(world, "nothing can be kept in " + spec.terrain.cache_folder));
}

TEST_F(TerrainCacheTest, SeveralAtOnceAgree) {
  std::vector<World> worlds(4);
  {
    std::vector<std::jthread> loading;
    for (World& world : worlds) loading.emplace_back([&] { world = load_world(spec); });
  }
  const World alone = fresh();
  for (const World& world : worlds) {
    expect_same(world, alone);
    EXPECT_FALSE(says(world, "is damaged"));
  }
  EXPECT_EQ(kept().size(), 1u) << "and no half-written ones";
  EXPECT_TRUE(from_cache(load_world(spec)));
}

TEST_F(TerrainCacheTest, TheLeastRecentlyUsedGoBeyondTheLimit) {
  HeightGrid grid;
  grid.nx = grid.nz = 100;
  grid.y_m.assign(10000, 1.5f);
  std::vector<std::string> notes;
  const GroundCache cache(folder.file("cache"), notes);
  const auto key = [](int n) {
    CacheKey made;
    made.add("number", std::to_string(n));
    return made;
  };
  const auto path = [&](int n) { return folder.file("cache/" + key(n).name() + ".grid"); };
  const std::uint64_t three = 3 * 41000;
  const auto now = fs::file_time_type::clock::now();
  for (int n = 0; n < 3; ++n) {
    cache.store(key(n), grid, {}, three);
    fs::last_write_time(path(n), now - std::chrono::minutes(10 - n));
  }
  EXPECT_TRUE(cache.load(key(0), grid)) << "which makes 1 the one that was not used for longest";
  const std::string abandoned = folder.text("cache/0123.grid.aBcDeF", "half");
  fs::last_write_time(abandoned, now - std::chrono::hours(2));
  const std::string in_hand = folder.text("cache/0123.grid.gHiJkL", "half");
  cache.store(key(3), grid, {}, three);
  EXPECT_TRUE(fs::exists(path(0)));
  EXPECT_FALSE(fs::exists(path(1)));
  EXPECT_TRUE(fs::exists(path(2)));
  EXPECT_TRUE(fs::exists(path(3)));
  EXPECT_FALSE(fs::exists(abandoned));
  EXPECT_TRUE(fs::exists(in_hand));
}

/// One grid at the posts' own distance, with filled and open voids, seams and an area; one four times
/// coarser.
TEST_F(TerrainCacheTest, OtherHeightsOfTheSameFilesHaveAnotherAlgorithmsNumber) {
  if (terrain_library_versions() != "GDAL 3.6.2, PROJ 9.1.1, GeographicLib 2.1.2" ||
      __builtin_cpu_supports("fma") == 0)
    GTEST_SKIP() << "no sums recorded for " << terrain_library_versions();
  RasterPlan east = plan;
  east.geotransform[0] += 100 * east.geotransform[1];
  spec.terrain.dem.push_back(write_raster(folder, "east.tif", east));
  spec.terrain.area = {{kLon - 0.03, kLat - 0.03}, {kLon + 0.05, kLat - 0.03}, {kLon, kLat + 0.06}};
  const auto sum = [&](double cell_m) {
    spec.terrain.cell_m = cell_m;
    const HeightGrid grid = load_world(spec).grid;
    return checksum(grid.y_m.data(), grid.y_m.size() * sizeof(float));
  };
  EXPECT_EQ(sum(90), 8933575081585973285u)
      << "raise kAlgorithm in terrain/ground.cpp, and record the new sum";
  EXPECT_EQ(sum(360), 4840701678561832659u)
      << "raise kAlgorithm in terrain/ground.cpp, and record the new sum";
}

TEST(CacheFolder, IsTheFirstOfTheUsualPlaces) {
  const char* names[] = {"OBLIQ_CACHE_DIR", "CACHE_DIRECTORY", "XDG_CACHE_HOME", "HOME"};
  std::vector<std::optional<std::string>> before;
  for (const char* name : names) {
    const char* value = std::getenv(name);
    before.push_back(value ? std::optional<std::string>(value) : std::nullopt);
    unsetenv(name);
  }
  EXPECT_EQ(usual_cache_folder(), "");
  setenv("HOME", "/home/me", 1);
  EXPECT_EQ(usual_cache_folder(), "/home/me/.cache/obliq");
  setenv("XDG_CACHE_HOME", "/elsewhere", 1);
  EXPECT_EQ(usual_cache_folder(), "/elsewhere/obliq");
  setenv("CACHE_DIRECTORY", "/var/cache/obliq:/var/cache/more", 1);
  EXPECT_EQ(usual_cache_folder(), "/var/cache/obliq");
  setenv("OBLIQ_CACHE_DIR", "/mine", 1);
  EXPECT_EQ(usual_cache_folder(), "/mine");
  setenv("OBLIQ_CACHE_DIR", "", 1);
  EXPECT_EQ(usual_cache_folder(), "");
  for (std::size_t k = 0; k < std::size(names); ++k)
    before[k] ? setenv(names[k], before[k]->c_str(), 1) : unsetenv(names[k]);
}

}  // namespace
}  // namespace obliq::ground_cache_test
