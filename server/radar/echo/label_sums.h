#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/bins.h"
#include "terrain/base/asking.h"

namespace obliq {

/// One wedge's sums of power by material, of buildings, and of heights by power, in double and in the order
/// of arrival. A sum has memory once something has come to it.
class LabelSums {
 public:
  explicit LabelSums(LabelParts parts) : parts_(parts), row_of_(LabelShare::kHeights + 1, kNone) {}

  LabelParts parts() const { return parts_; }
  /// Empties the sums, of `bins` bins.
  void restart(std::size_t bins);

  /// An echo in bin `at`; height_w(): its power times its height above the datum, asked where heights are
  /// wanted.
  template <class HeightW>
  void add(std::size_t at, double power_w, std::uint8_t material, bool of_building, const HeightW& height_w) {
    if (parts_ == LabelParts::none) return;
    if (material != 0) row(material)[at] += power_w;
    if (parts_ != LabelParts::all) return;
    row(LabelShare::kHeights)[at] += height_w();
    if (of_building) row(LabelShare::kBuildings)[at] += power_w;
  }

  /// Writes the shares of the bins' power; index(azimuth, range) is a bin's `at`.
  template <class Index>
  void write(BinBlock& block, const Index& index) const {
    for (const Row& row : rows_) {
      std::vector<float>& share = label_share(block, row.kind);
      std::size_t bin = 0;
      for (int a = 0; a < block.n_azimuth; ++a) {
        ask(block.n_range);
        for (int r = 0; r < block.n_range; ++r, ++bin)
          if (block.power_w[bin] > 0)
            share[bin] = static_cast<float>(row.sum[index(a, r)] / block.power_w[bin]);
      }
    }
  }

  /// Of a scene of so many materials; 0: no labels.
  static std::int64_t bytes(int n_range, int materials) {
    return materials == 0 ? 0 : 2 * LabelShare::bytes_a_bin(materials) * n_range * kWedgeAzimuthBins;
  }

 private:
  static constexpr int kNone = -1;
  struct Row {
    int kind;
    std::vector<double> sum;
  };
  double* row(int kind) {
    const int at = row_of_[static_cast<std::size_t>(kind)];
    return (at == kNone ? new_row(kind) : rows_[static_cast<std::size_t>(at)]).sum.data();
  }
  Row& new_row(int kind);

  LabelParts parts_;
  std::size_t bins_ = 0;
  std::vector<Row> rows_;
  std::vector<std::vector<double>> spare_;  // memory of the wedge before
  std::vector<int> row_of_;                 // by kind
};

}  // namespace obliq
