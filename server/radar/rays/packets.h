#pragma once
// Which pixels are traced together. Embree traces the rays of a packet together while they go the same way:
// sixteen in a square part later than sixteen in a row (tests/bench/SPEED-2026-11.md).
#include <algorithm>
#include <array>
#include <cstddef>

namespace obliq {

constexpr int kSquare = 4;  ///< rows and columns of a packet of 16

/// Columns [from, to) of a row.
struct PixelSpan {
  int from = 0;
  int to = 0;
};

/// The pixels of kSquare neighbouring rows as they come: row by row, each odd row backwards.
class PixelRows {
 public:
  /// The rows from `first_row` on; an empty span for a row without pixels.
  PixelRows(int first_row, const std::array<PixelSpan, kSquare>& spans)
      : first_row_(first_row), spans_(spans) {
    for (std::size_t k = 0; k < kSquare; ++k) {
      first_[k] = size_;
      size_ += std::max(0, spans[k].to - spans[k].from);
    }
  }

  int size() const { return size_; }

  /// Calls next(n) for each pixel square by square, n its number.
  template <typename Next>
  void by_squares(const Next& next) const {
    int from = 0;
    int to = 0;
    for (const PixelSpan& span : spans_) {
      if (span.from >= span.to) continue;
      from = from < to ? std::min(from, span.from) : span.from;
      to = std::max(to, span.to);
    }
    const bool back = first_row_ / kSquare % 2 == 1;
    const int squares = (to - from + kSquare - 1) / kSquare;
    for (int square = 0; square < squares; ++square) {
      const int first = from + kSquare * (back ? squares - 1 - square : square);
      for (std::size_t k = 0; k < kSquare; ++k) {
        const PixelSpan& span = spans_[k];
        const int end = std::min(first + kSquare, span.to);
        const bool row_back = (first_row_ + static_cast<int>(k)) % 2 == 1;
        for (int column = std::max(first, span.from); column < end; ++column)
          next(first_[k] + (row_back ? span.to - 1 - column : column - span.from));
      }
    }
  }

 private:
  int first_row_;
  std::array<PixelSpan, kSquare> spans_;
  std::array<int, kSquare> first_{};
  int size_ = 0;
};

}  // namespace obliq
