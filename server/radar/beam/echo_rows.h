#pragma once
#include <array>
#include <deque>
#include <map>
#include <mutex>
#include <vector>

#include "server/radar/beam/sharp_wedge.h"

namespace obliq {

/// Sharp wedges that outlive a rendering: the next dwell of a scan looks at most of them again. Bounded; from
/// any thread.
class SharpStore {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;

  /// Drops what is of sharp bins that stand elsewhere: how far a beam reaches follows from the antenna's
  /// height.
  void fit(const EchoPlan& plan);
  /// Null: not there, or without a plane that is wanted.
  SharpWedgePtr find(int sharp_wedge, const SharpPlanes& wanted) const;
  /// Keeps it; evicts the oldest when full.
  void keep(int sharp_wedge, const SharpPlanes& planes, SharpWedgePtr wedge);
  void clear();
  std::size_t bytes() const;

 private:
  struct Kept {
    SharpWedgePtr wedge;
    SharpPlanes planes;
  };
  mutable std::mutex mutex_;
  std::map<int, Kept> kept_;
  std::deque<int> order_;
  std::size_t bytes_ = 0;
  std::array<int, 4> layout_{};  // of the sharp bins
};

/// The sharp wedges that some output wedges of one rendering are made from, in the order in which they are
/// wanted, and those that are there. An output wedge is ready when all of its own are. From any thread.
class EchoRows {
 public:
  EchoRows(const RowWindow& window, std::vector<int> outputs);

  /// Sharp wedges to render, in order.
  int n_sharp() const { return static_cast<int>(order_.size()); }
  int sharp_wedge(int k) const { return order_[static_cast<std::size_t>(k)]; }
  const std::vector<int>& sharp_wedges() const { return order_; }

  void take(int sharp_wedge, SharpWedgePtr wedge);

  /// An output wedge that is ready and has not been handed out.
  struct Ready {
    int wedge = 0;
    AzimuthRange azimuths;
    std::vector<SharpWedgePtr> owners;    ///< of what `rows` points to
    std::vector<const SharpWedge*> rows;  ///< by sharp azimuth, as EchoSums takes them
    FrameStats stats;                     ///< of the sharp wedges that count as its own
  };
  /// False: none at the moment.
  bool next_ready(Ready& ready);

 private:
  /// Neighbouring sharp wedges, on from the last to the first.
  struct Output {
    int first;
    int count;
    int missing;
  };
  AzimuthRange azimuths_of(int output) const;
  int place_in(const Output& output, int sharp_wedge) const;
  int owner_of(int sharp_wedge) const;

  const RowWindow window_;
  const std::vector<int> wedges_;  // of the outputs
  const int n_wedges_;             // sharp ones
  std::vector<int> order_;
  std::mutex mutex_;  // guards what follows
  std::vector<Output> outputs_;
  std::vector<SharpWedgePtr> there_;
  std::vector<int> users_;  // [n_wedges] outputs that still need a sharp wedge
  std::deque<int> ready_;   // places in outputs_
};

}  // namespace obliq
