#include "terrain/buildings/gamma_raster.h"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <string>

#include "terrain/base/parallel.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/dem/pixel_mean.h"
#include "terrain/dem/raster_values.h"
#include "terrain/dem/resample.h"

namespace obliq {
namespace {

constexpr double kMost_db = 60;
constexpr const char* kAllowed = "decibels from -60 to 60";

/// Cells along a tile's side, and pixels of a tile that are held at once.
constexpr int kTileCells = 256;
constexpr double kMostTilePixels = 0x1p24;

/// Values that say of what unit they are: a raster of linear backscatter has no negative ones and is mostly
/// below 1, since ground returns less than a surface of gamma 0 dB; one of decibels like that would change
/// nothing by as much as 1 dB.
struct UnitEvidence {
  std::uint64_t negative = 0;
  std::uint64_t positive = 0;
  std::uint64_t below_1 = 0;  ///< of the positive ones
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();

  void add(double value) {
    negative += value < 0 ? 1 : 0;
    positive += value > 0 ? 1 : 0;
    below_1 += value > 0 && value < 1 ? 1 : 0;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  bool looks_linear() const { return negative == 0 && positive > 0 && 2 * below_1 > positive; }
  bool any() const { return least <= most; }
};

/// Whether the band says that it is in decibels; false where it says nothing. Throws where it says otherwise.
bool says_decibel(const Raster& raster) {
  std::string unit = raster.band().GetUnitType();
  std::string plain;
  for (const char c : unit)
    if (std::isalnum(static_cast<unsigned char>(c)))
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (plain.empty() || plain == "unknown" || plain == "none") return false;
  if (plain == "db" || plain == "decibel" || plain == "decibels") return true;
  raster.refuse(fmt::format("its unit is \"{}\"", unit),
                "decibels (linear values x become 10 log10(x); gdal_edit.py -units dB says so)");
}

/// Cells [i0, i1) x [j0, j1).
struct CellRect {
  int i0, j0, i1, j1;
};

class GammaRaster {
 public:
  GammaRaster(World& world, const SurfaceSpec& surface)
      : world_(world),
        surface_(surface),
        raster_(surface.gamma_raster, "[[surfaces]] gamma_raster", {}),
        coding_(raster_),
        says_decibel_(says_decibel(raster_)),
        reader_(raster_, raster_.band()) {
    require_whole_file(raster_, raster_.rows());
  }

  void apply() {
    const HeightGrid& grid = world_.grid;
    const GeodeticLattice geodetic =
        geodetic_lattice(world_.frame, {grid.x0_m, grid.z0_m, grid.x1_m(), grid.z1_m()});
    const PostLattice lattice = post_lattice(geodetic, raster_);
    const double turn = raster_.turn_columns();
    for (const double turns : {0.0, -1.0, 1.0}) {
      if (turns != 0 && turn == 0) continue;
      shift_columns_ = turns * turn;
      const PixelRect rect = needed_pixels(lattice, grid, raster_, 1, shift_columns_);
      if (rect.empty()) continue;
      if (static_cast<double>(rect.columns()) * rect.rows() > kMostPixels)
        raster_.refuse("the loaded area has more than 2^31 of its pixels",
                       "a coarser raster or a smaller area");
      for (int j = 0; j < grid.nz - 1; j += kTileCells)
        for (int i = 0; i < grid.nx - 1; i += kTileCells)
          tile(lattice, {i, j, std::min(i + kTileCells, grid.nx - 1), std::min(j + kTileCells, grid.nz - 1)});
    }
    judge();
    // Painted, but the raster says nothing.
    if (!surface_.source.empty())
      for (float& of_cell : world_.raster_gamma)
        if (std::isnan(of_cell)) of_cell = 1;
  }

 private:
  void judge() {
    if (!seen_.any()) {
      world_.report.notes.push_back(surface_.gamma_raster + ": no values in the loaded area");
    } else if (!says_decibel_ && seen_.looks_linear()) {
      raster_.refuse(
          fmt::format("values from {:g} to {:g}, which are linear: none is negative, most are below 1",
                      seen_.least, seen_.most),
          std::string(kAllowed) + ", 10 log10 of linear values (gdal_edit.py -units dB says that they are)");
    }
  }

  void tile(const PostLattice& lattice, const CellRect& cells) {
    const int across = cells.i1 - cells.i0 + 1;
    const auto down = static_cast<std::size_t>(cells.j1 - cells.j0 + 1);
    std::vector<glm::dvec2> nodes(static_cast<std::size_t>(across) * down);
    for_each_row(static_cast<int>(down), [&](int row) {
      glm::dvec2* const to = nodes.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(across);
      node_places(world_.grid, cells.j0 + row, cells.i0, cells.i1 + 1, lattice, to);
      for (int k = 0; k < across; ++k) to[k].x += shift_columns_;
    });
    const PixelRect rect = pixels_under(nodes);
    if (rect.empty()) return;
    if (static_cast<double>(rect.columns()) * rect.rows() > kMostTilePixels) return divide(lattice, cells);
    read(rect);
    for_each_row(cells.j1 - cells.j0, [&](int row) {
      const glm::dvec2* const near =
          nodes.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(across);
      const glm::dvec2* const far = near + across;
      for (int k = 0; k + 1 < across; ++k) {
        const PixelMean under = mean_under({near[k], near[k + 1], far[k + 1], far[k]}, pixels_);
        if (under.share >= 0.5) set(cells.i0 + k, cells.j0 + row, under.mean);
      }
    });
  }

  void divide(const PostLattice& lattice, const CellRect& cells) {
    const int across = cells.i1 - cells.i0;
    const int down = cells.j1 - cells.j0;
    if (across == 1 && down == 1)
      raster_.refuse("a cell of the terrain has more than 2^24 of its pixels", "a coarser raster");
    CellRect first = cells, second = cells;
    if (across > down)
      first.i1 = second.i0 = cells.i0 + across / 2;
    else
      first.j1 = second.j0 = cells.j0 + down / 2;
    tile(lattice, first);
    tile(lattice, second);
  }

  PixelRect pixels_under(const std::vector<glm::dvec2>& nodes) const {
    double c0 = HUGE_VAL, c1 = -HUGE_VAL, r0 = HUGE_VAL, r1 = -HUGE_VAL;
    for (const glm::dvec2& node : nodes) {
      if (!std::isfinite(node.x) || !std::isfinite(node.y)) continue;
      c0 = std::min(c0, node.x);
      c1 = std::max(c1, node.x);
      r0 = std::min(r0, node.y);
      r1 = std::max(r1, node.y);
    }
    if (!(c0 <= c1)) return {};
    const auto clip = [](double v, int n) {
      return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(n)));
    };
    return {clip(std::floor(c0 + 0.5), raster_.columns()), clip(std::floor(r0 + 0.5), raster_.rows()),
            clip(std::ceil(c1 + 0.5), raster_.columns()), clip(std::ceil(r1 + 0.5), raster_.rows())};
  }

  /// The rectangle's values as powers.
  void read(const PixelRect& rect) {
    reader_.read(rect, stored_);
    pixels_.rect = rect;
    pixels_.value.resize(stored_.size());
    for (std::size_t k = 0; k < stored_.size(); ++k) {
      if (std::isinf(stored_[k]) && !coding_.is_nodata(stored_[k])) refuse_value(rect, k, stored_[k]);
      const double value_db = coding_.value(stored_[k]);
      if (std::isnan(value_db)) continue;
      if (!(std::abs(value_db) <= kMost_db)) refuse_value(rect, k, value_db);
      seen_.add(value_db);
    }
    const auto columns = static_cast<std::size_t>(rect.columns());
    for_each_row(rect.rows(), [&](int row) {
      const std::size_t first = static_cast<std::size_t>(row) * columns;
      for (std::size_t k = first; k < first + columns; ++k)
        pixels_.value[k] = static_cast<float>(std::pow(10, coding_.value(stored_[k]) / 10));
    });
  }

  [[noreturn]] void refuse_value(const PixelRect& rect, std::size_t k, double value) const {
    const auto columns = static_cast<std::size_t>(rect.columns());
    raster_.refuse(
        fmt::format("{:g} in column {}, row {}", value, static_cast<std::size_t>(rect.column0) + k % columns,
                    static_cast<std::size_t>(rect.row0) + k / columns),
        std::string(kAllowed) + "; voids are told by a nodata value or NaN");
  }

  void set(int i, int j, double power) {
    const std::size_t cell = world_.cell_index(i, j);
    float& of_cell = world_.raster_gamma[cell];
    if (!surface_.source.empty()) {
      if (!std::isnan(of_cell)) return;
    } else if (surface_.paints) {
      world_.surface_material[cell] = surface_.material;
    }
    of_cell = static_cast<float>(surface_.raster_is_gamma ? -power : power);
  }

  World& world_;
  const SurfaceSpec& surface_;
  Raster raster_;
  ValueCoding coding_;
  bool says_decibel_;
  PixelReader reader_;
  double shift_columns_ = 0;
  UnitEvidence seen_;
  std::vector<double> stored_;
  PixelValues pixels_;  // as powers
};

}  // namespace

void apply_gamma_raster(World& world, const SurfaceSpec& surface) { GammaRaster(world, surface).apply(); }

}  // namespace obliq
