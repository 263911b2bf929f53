#include "terrain/buildings/class_raster.h"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>

#include "terrain/base/errors.h"
#include "terrain/base/parallel.h"
#include "terrain/dem/cell_places.h"
#include "terrain/dem/gdal_messages.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/dem/resample.h"

namespace obliq {
namespace {

constexpr double kMostPixels = 0x1p30;

/// What a pixel's byte says: nothing is wanted of it, its class has no material, or which of the materials it
/// has, counted from kFirst on.
constexpr std::uint8_t kUnwanted = 0;
constexpr std::uint8_t kNone = 1;
constexpr std::uint8_t kFirst = 2;

/// Materials of a raster's classes.
class Legend {
 public:
  explicit Legend(const SurfaceSpec& surface) : whole_(!surface.scheme.empty()) {
    for (const int value : surface.classes) add(value, surface.material);
    for (const auto& [value, material] : surface.scheme_materials) add(value, material);
  }

  std::uint8_t code(double value) {
    if (value != newest_) {
      newest_ = value;
      newest_code_ = look_up(value);
    }
    return newest_code_;
  }

  std::uint8_t material(std::uint8_t code) const { return materials_[code - kFirst]; }

  /// The first few values that have no material.
  std::string without() const {
    std::string text;
    for (const double value : without_) {
      const std::string number = fmt::format("{}{:g}", text.empty() ? "" : ", ", value);
      text += number;
    }
    return text.empty() ? "no value" : text;
  }

 private:
  void add(int value, std::uint8_t material) {
    auto at = std::ranges::find(materials_, material);
    if (at == materials_.end()) at = materials_.insert(at, material);
    codes_[value] = static_cast<std::uint8_t>(kFirst + (at - materials_.begin()));
  }

  std::uint8_t look_up(double value) {
    const auto found = std::isnan(value) ? codes_.end() : codes_.find(value);
    if (found != codes_.end()) return found->second;
    if (!whole_) return kUnwanted;
    constexpr std::size_t kMostNamed = 8;
    if (without_.size() < kMostNamed && std::ranges::find(without_, value) == without_.end() &&
        !std::isnan(value))
      without_.push_back(value);
    return kNone;
  }

  bool whole_;  ///< every class should have a material
  std::map<double, std::uint8_t> codes_;
  std::vector<std::uint8_t> materials_;
  std::vector<double> without_;
  double newest_ = std::numeric_limits<double>::quiet_NaN();  ///< neighbours are mostly alike
  std::uint8_t newest_code_ = kUnwanted;
};

/// One byte a pixel of a window.
struct ClassWindow {
  PixelRect rect;
  std::vector<std::uint8_t> code;

  std::uint8_t at(double column, double row) const {
    const double c = std::floor(column + 0.5) - rect.column0;
    const double r = std::floor(row + 0.5) - rect.row0;
    if (!(c >= 0 && r >= 0 && c < rect.columns() && r < rect.rows())) return kUnwanted;
    return code[static_cast<std::size_t>(r) * static_cast<std::size_t>(rect.columns()) +
                static_cast<std::size_t>(c)];
  }
};

ClassWindow read_classes(const Raster& raster, const PixelRect& rect, Legend& legend) {
  if (static_cast<double>(rect.columns()) * rect.rows() > kMostPixels) {
    raster.refuse("the loaded area has more than 2^30 of its pixels", "a coarser raster or a smaller area");
  }
  ClassWindow window;
  window.rect = rect;
  window.code.reserve(static_cast<std::size_t>(rect.columns()) * static_cast<std::size_t>(rect.rows()));
  std::vector<double> line(static_cast<std::size_t>(rect.columns()));
  GdalMessages messages;
  for (int r = rect.row0; r < rect.row1; ++r) {
    const CPLErr error = raster.band().RasterIO(GF_Read, rect.column0, r, rect.columns(), 1, line.data(),
                                                rect.columns(), 1, GDT_Float64, 0, 0, nullptr);
    if (error != CE_None || !messages.failure().empty()) {
      raster.refuse(fmt::format("row {} cannot be read: {}", r, messages.reason("the file is damaged")),
                    "a whole, readable raster");
    }
    for (const double value : line) window.code.push_back(legend.code(value));
  }
  return window;
}

}  // namespace

void paint_classes(World& world, const SurfaceSpec& surface) {
  const HeightGrid& grid = world.grid;
  const Raster raster(surface.source, "[[surfaces]] source", {});
  const GeodeticLattice geodetic =
      geodetic_lattice(world.frame, {grid.x0_m, grid.z0_m, grid.x1_m(), grid.z1_m()});
  const PostLattice lattice = post_lattice(geodetic, raster);
  const double turn = raster.turn_columns();
  Legend legend(surface);
  std::atomic<std::uint64_t> without{0};
  for (double turns : {0.0, -1.0, 1.0}) {
    if (turns != 0 && turn == 0) continue;
    const PixelRect rect = needed_pixels(lattice, grid, raster, 1, turns * turn);
    if (rect.empty()) continue;
    const ClassWindow window = read_classes(raster, rect, legend);
    for_each_row(grid.nz - 1, [&](int j) {
      std::uint8_t* materials =
          world.surface_material.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.nx - 1);
      std::uint64_t none = 0;
      for_each_cell_place(grid, j, lattice, [&](int i, double column, double row) {
        const std::uint8_t code = window.at(column + turns * turn, row);
        if (code >= kFirst) materials[i] = legend.material(code);
        if (code == kNone && grid.cell_known(i, j)) ++none;
      });
      without += none;
    });
  }
  if (without == 0) return;
  const double cells = static_cast<double>(grid.nx - 1) * (grid.nz - 1);
  const std::string count =
      fmt::format("{} cells ({:.2g} %) are of a class without a material in the scheme \"", without.load(),
                  100 * static_cast<double>(without) / cells);
  world.report.notes.push_back(
      fmt::format("[[surfaces]] {}: {}{}\" ({}); they keep the material that they have without it",
                  surface.source, count, surface.scheme, legend.without()));
}

}  // namespace obliq
