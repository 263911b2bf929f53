#pragma once
// Some of a raster's own posts, kept while it is read.
#include <vector>

#include "terrain/base/hash.h"
#include "terrain/dem/raster.h"

namespace obliq {

/// One post of every block of stride x stride, at a place in the block that a hash of the block chooses: an
/// even selection that cannot beat with the grid's cells, the same on every machine.
class PostSample {
 public:
  struct Post {
    int column = 0;  ///< of the raster
    int row = 0;
    double height_m = 0;
  };

  explicit PostSample(int stride) : stride_(stride) {}

  /// Keeps the chosen posts of a piece of the raster. height_m(row, column), counted from the piece's corner,
  /// is NaN where the raster knows no height: such posts are left out.
  template <typename HeightAt>
  void take(const PixelRect& piece, const HeightAt& height_m) {
    for (int row = piece.row0; row < piece.row1; ++row) {
      const int block_row = row / stride_;
      for (int block = piece.column0 / stride_; block * stride_ < piece.column1; ++block) {
        const std::uint64_t hash = hash_cell(0, block, block_row);
        const auto side = static_cast<std::uint64_t>(stride_);
        const int column = block * stride_ + static_cast<int>((hash & 0xffffffffu) % side);
        if (row != block_row * stride_ + static_cast<int>((hash >> 32) % side)) continue;
        if (column < piece.column0 || column >= piece.column1) continue;
        const double height = height_m(row - piece.row0, column - piece.column0);
        if (height == height) posts_.push_back({column, row, height});
      }
    }
  }

  const std::vector<Post>& posts() const { return posts_; }

 private:
  int stride_;
  std::vector<Post> posts_;
};

}  // namespace obliq
