// Seeds that GDAL writes: elevation models and outlines of buildings.
#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/fuzz/make_seeds.h"

namespace obliq::fuzz {
namespace {

std::string read_and_remove(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  std::filesystem::remove_all(path);
  std::filesystem::remove(path + ".aux.xml");
  std::filesystem::remove(std::filesystem::path(path).replace_extension("prj"));
  return text.str();
}

/// A hill of 24 x 24 posts, and a post that is void.
GDALDataset* made_hill(const char* crs, double post) {
  constexpr int kSide = 24;
  GDALDataset* hill =
      GetGDALDriverManager()->GetDriverByName("MEM")->Create("", kSide, kSide, 1, GDT_Int16, nullptr);
  OGRSpatialReference system;
  system.SetFromUserInput(crs);
  hill->SetSpatialRef(&system);
  const bool degrees = system.IsGeographic() != 0;
  double transform[6] = {degrees ? -99.5 : 500000.0, post, 0, degrees ? 33.0 : 3650000.0, 0, -post};
  hill->SetGeoTransform(transform);
  std::int16_t values[kSide * kSide];
  for (int i = 0; i < kSide * kSide; ++i) {
    values[i] = static_cast<std::int16_t>(400 + 3 * (i % kSide) - 2 * (i / kSide));
  }
  values[100] = -9999;
  hill->GetRasterBand(1)->SetNoDataValue(-9999);
  const CPLErr written =
      hill->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, kSide, kSide, values, kSide, kSide, GDT_Int16, 0, 0);
  if (written != CE_None) std::abort();
  return hill;
}

void write_elevation(char name_byte, const char* driver, const std::string& seed, const char* crs,
                     double post, const std::vector<const char*>& options) {
  GDALDataset* hill = made_hill(crs, post);
  std::vector<char*> list;
  for (const char* option : options) list.push_back(const_cast<char*>(option));
  list.push_back(nullptr);
  const std::string path = (corpus_folder() / "written").string();
  GDALDataset* copy = GetGDALDriverManager()->GetDriverByName(driver)->CreateCopy(
      path.c_str(), hill, FALSE, list.data(), nullptr, nullptr);
  GDALClose(hill);
  if (copy == nullptr) return;
  GDALClose(copy);
  write_seed("elevation", seed, name_byte + read_and_remove(path));
}

}  // namespace

void write_elevations() {
  GDALAllRegister();
  write_elevation(0, "GTiff", "strips", "EPSG:4326", 1.0 / 3600, {});
  write_elevation(0, "GTiff", "tiles_deflate", "EPSG:26914", 30,
                  {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16", "COMPRESS=DEFLATE", "PREDICTOR=2"});
  write_elevation(0, "GTiff", "lzw", "EPSG:4269", 1.0 / 3600, {"COMPRESS=LZW", "INTERLEAVE=BAND"});
  write_elevation(2, "AAIGrid", "ascii_grid", "EPSG:4326", 1.0 / 3600, {"FORCE_CELLSIZE=YES"});
  write_elevation(3, "HFA", "imagine", "EPSG:26914", 30, {});
  write_elevation(1, "USGSDEM", "usgs_dem", "EPSG:26914", 30, {});
}

namespace {

constexpr const char* kTown = R"({"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"height":12,"building:levels":"3"},"geometry":{"type":"Polygon","coordinates":
[[[-99.501,33.0],[-99.5,33.0],[-99.5,33.001],[-99.501,33.001],[-99.501,33.0]],
[[-99.5008,33.0002],[-99.5002,33.0002],[-99.5002,33.0008],[-99.5008,33.0008],[-99.5008,33.0002]]]}},
{"type":"Feature","properties":{"height":"40 ft"},"geometry":{"type":"MultiPolygon","coordinates":
[[[[-99.499,33.001],[-99.498,33.001],[-99.499,33.002],[-99.498,33.002],[-99.499,33.001]]],
[[[-99.502,33.002],[-99.5015,33.002],[-99.5015,33.0025],[-99.502,33.002]]]]}},
{"type":"Feature","properties":null,"geometry":{"type":"LineString","coordinates":
[[-99.5,32.999],[-99.499,32.999],[-99.499,32.9995],[-99.5,32.999]]}},
{"type":"Feature","properties":{},"geometry":null}]})";

void write_outlines(char name_byte, const char* driver, const std::string& extension, const std::string& seed,
                    const std::vector<const char*>& dataset_options,
                    const std::vector<const char*>& layer_options) {
  const auto listed = [](const std::vector<const char*>& options) {
    std::vector<char*> list;
    for (const char* option : options) list.push_back(const_cast<char*>(option));
    list.push_back(nullptr);
    return list;
  };
  auto create = listed(dataset_options);
  auto layer = listed(layer_options);
  const std::string text = (corpus_folder() / "town.geojson").string();
  std::ofstream(text) << kTown;
  const std::string path = (corpus_folder() / "written.").string() + extension;
  GDALDataset* town = GDALDataset::Open(text.c_str(), GDAL_OF_VECTOR);
  GDALDataset* copy = GetGDALDriverManager()->GetDriverByName(driver)->Create(path.c_str(), 0, 0, 0,
                                                                              GDT_Unknown, create.data());
  if (copy != nullptr && town != nullptr) (void)copy->CopyLayer(town->GetLayer(0), "town", layer.data());
  if (copy != nullptr) GDALClose(copy);
  if (town != nullptr) GDALClose(town);
  std::filesystem::remove(text);
  write_seed("footprints", seed, name_byte + read_and_remove(path));
}

}  // namespace

void write_footprints() {
  GDALAllRegister();
  write_seed("footprints", "town_geojson", std::string(1, '\0') + kTown);
  write_seed("footprints", "prisms_geojson", std::string(1, '\3') + kTown);
  write_seed("footprints", "surface_geojson", std::string(1, '\6') + kTown);
  CPLSetConfigOption("OGR_SQLITE_PRAGMA", "page_size=512");
  write_outlines(1, "GPKG", "gpkg", "town_gpkg", {"ADD_GPKG_OGR_CONTENTS=NO"}, {"SPATIAL_INDEX=NO"});
  write_outlines(2, "FlatGeobuf", "fgb", "town_fgb", {}, {"SPATIAL_INDEX=NO"});
}

}  // namespace obliq::fuzz
