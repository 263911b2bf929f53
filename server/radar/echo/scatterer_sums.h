#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/echo/speckle.h"
#include "server/radar/simd/echoes/bin_samples.h"

namespace obliq {

/// The power that each scatterer gave to each range bin of one azimuth bin: P_bc of PAPER.md. Samples
/// are kept as they come and added up when there are many, or at the end.
class ScattererSums {
 private:
  struct ScattererArrays {
    std::vector<std::uint32_t> bin;
    std::vector<std::uint64_t> place;
    std::vector<std::uint64_t> kind;
    std::vector<double> power_w;

    void resize(std::size_t n);
  };

 public:
  /// Memory that merging needs for the time being.
  struct Scratch {
    ScattererArrays sorted;          // by bin
    std::vector<std::uint32_t> end;  // of each bin in it
    std::vector<std::uint32_t> order;
  };

  /// Several may share their scratch memory, one at a time.
  explicit ScattererSums(Scratch& scratch) : scratch_(&scratch) {}

  /// With room to grow into: a bin, a place, a kind and a power.
  static std::int64_t bytes(double samples);

  /// Empties it and keeps its memory.
  void restart(int n_range);

  void add(std::uint32_t range_bin, const ScattererKey& key, double power_w) {
    if (n_ == room_) make_room();
    samples_.bin[n_] = range_bin;
    samples_.place[n_] = key.place;
    samples_.kind[n_] = key.kind;
    samples_.power_w[n_] = power_w;
    ++n_;
  }

  /// Adds up: from now on each scatterer of a bin is there once, by bin and in order of its first sample. Its
  /// power is the sum in the order that the samples came in.
  void merge();

  std::size_t size() const { return n_; }
  std::uint32_t range_bin(std::size_t k) const { return samples_.bin[k]; }
  const std::uint64_t* places() const { return samples_.place.data(); }
  const std::uint64_t* kinds() const { return samples_.kind.data(); }
  const double* powers_w() const { return samples_.power_w.data(); }

 private:
  void make_room();
  void merge_large(ScattererLists& lists, std::uint32_t bin);

  Scratch* scratch_;
  std::size_t n_range_ = 0;
  std::size_t n_ = 0;
  std::size_t room_ = 0;
  ScattererArrays samples_;
};

}  // namespace obliq
