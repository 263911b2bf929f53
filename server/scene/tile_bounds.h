#pragma once
#include <vector>

#include "terrain/height_grid.h"

namespace obliq {

/// Lowest and highest known node of each square tile of a grid (tiles share their border nodes), so that a
/// frame can bound its ground without touching every post.
class TileBounds {
 public:
  static constexpr int kCells = 32;     ///< a side, unless told
  static constexpr int kFineCells = 8;  ///< of the tiles within them

  struct Tile {
    float lowest_m;   ///< world y; +infinity when nothing in the tile is known
    float highest_m;  ///< world y; -infinity when nothing in the tile is known
    bool whole;       ///< all of its nodes are known
  };

  explicit TileBounds(const HeightGrid& grid, int cells = kCells);
  /// Tiles of `factor` times as many cells a side.
  TileBounds(const TileBounds& finer, int factor);

  int cells() const { return cells_; }
  int tiles_x() const { return tiles_x_; }
  int tiles_z() const { return tiles_z_; }
  const Tile& tile(int ti, int tj) const { return tiles_[index(ti, tj)]; }
  std::size_t bytes() const { return tiles_.capacity() * sizeof(Tile); }
  /// Over all tiles; as of a tile.
  double lowest_m() const { return all_.lowest_m; }
  double highest_m() const { return all_.highest_m; }
  bool whole() const { return all_.whole; }

 private:
  std::size_t index(int ti, int tj) const {
    return static_cast<std::size_t>(tj) * static_cast<std::size_t>(tiles_x_) + static_cast<std::size_t>(ti);
  }
  void sum_up();

  int cells_;
  Tile all_{};
  int tiles_x_;
  int tiles_z_;
  std::vector<Tile> tiles_;
};

/// A rectangle of posts that are all known, for one grid primitive.
struct GridTile {
  std::size_t first_post;  ///< index of its lowest i and j
  int posts_x;
  int posts_z;
};

/// Covers the known cells of a grid with rectangles, so that no grid primitive touches an unknown node.
std::vector<GridTile> known_tiles(const HeightGrid& grid);

}  // namespace obliq
