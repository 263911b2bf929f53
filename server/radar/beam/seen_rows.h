#pragma once
#include <optional>
#include <vector>

#include "server/radar/beam/echo_rows.h"

namespace obliq {

/// Rows that outputs are made from, out of the sharp wedges that are looked at: the same ones, or, of an
/// antenna that is not stabilised, those of the ground's azimuths, by way of scan angles. From any thread.
class SeenRows {
 public:
  /// plan must outlive it. planes: that rows have. look_key: SharpWedge's.
  SeenRows(const EchoPlan& plan, const RowWindow& window, std::vector<int> outputs, const SharpPlanes& planes,
           std::uint64_t look_key);

  /// What is to be looked at.
  const EchoRows& looks_at() const { return ground_ ? *ground_ : rows_; }
  /// One of those. Scan angles are made as soon as all that they see is there.
  void take(int wedge, SharpWedgePtr sharp);
  bool next_ready(EchoRows::Ready& ready) { return rows_.next_ready(ready); }

 private:
  const EchoPlan& plan_;
  const SharpPlanes planes_;
  const std::uint64_t look_key_;
  EchoRows rows_;
  std::optional<EchoRows> ground_;
};

}  // namespace obliq
