#include "server/accuracy/sampling_case.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace obliq {

namespace {

constexpr int kPaperPixels = 2048;

constexpr std::array kPlates{PlateKind::nearest, PlateKind::spread};

class CaseList {
 public:
  explicit CaseList(double cell_m) : cell_m_(cell_m) {}

  void add(FrustumKind kind, PlateKind plates, double columns, double rows, int sub_columns = 0) {
    SamplingCase c{
        kind,    plates,     static_cast<int>(std::lround(columns)), static_cast<int>(std::lround(rows)),
        cell_m_, sub_columns};
    const bool sweep = kind == FrustumKind::sweep;
    if (c.columns < 1 || c.columns > kMostSide || c.rows < (sweep ? 0 : 1) || c.rows > kMostSide) return;
    if (std::ranges::find(cases_, c) == cases_.end()) cases_.push_back(c);
  }
  std::vector<SamplingCase> take() { return std::move(cases_); }

 private:
  double cell_m_;
  std::vector<SamplingCase> cases_;
};

std::vector<SamplingCase> all_samplings(const RadarSettings& settings, const FrontierRange& range,
                                        double cell_m) {
  CaseList list(cell_m);
  std::vector<int> pixels = range.pixels;
  std::ranges::sort(pixels);
  for (const PlateKind plates : kPlates)
    for (const int n : pixels) list.add(FrustumKind::symmetric, plates, n, n);
  if (std::ranges::find(pixels, kPaperPixels) == pixels.end()) {
    pixels.push_back(kPaperPixels);
    std::ranges::sort(pixels);
  }
  for (const PlateKind plates : kPlates)
    for (const int n : pixels) list.add(FrustumKind::oblique, plates, n, n);
  for (const int sub_columns : range.sub_columns)
    for (const double planes : range.sweeps)
      list.add(FrustumKind::sweep, PlateKind::spread, planes * settings.azimuth_bins, 0, sub_columns);
  return list.take();
}

/// What tells how much a coarser grid saves and costs.
std::vector<SamplingCase> few_samplings(const RadarSettings& settings, const FrontierRange& range,
                                        double cell_m) {
  CaseList list(cell_m);
  list.add(FrustumKind::oblique, PlateKind::spread, kPaperPixels, kPaperPixels);
  for (std::size_t k = 0; k < std::min<std::size_t>(3, range.sweeps.size()); ++k)
    list.add(FrustumKind::sweep, PlateKind::spread, range.sweeps[k] * settings.azimuth_bins, 0,
             range.sub_columns.front());
  return list.take();
}

constexpr std::array kSides{256, 512, 1024, 2048, 4096, 8192, kMostSide};
constexpr std::array kPerBin{1, 2, 4, 8, 16};

}  // namespace

SamplingCase paper_sampling(double cell_m) {
  return {FrustumKind::oblique, PlateKind::nearest, kPaperPixels, kPaperPixels, cell_m};
}

RadarSettings with_sampling(RadarSettings settings, const SamplingCase& sampling) {
  settings.frustum = sampling.kind;
  settings.plates = sampling.plates;
  settings.pixel_columns = sampling.columns;
  settings.planes_per_bin = 0;
  settings.sub_columns = sampling.sub_columns;
  if (sampling.kind == FrustumKind::sweep && settings.speckle == SpeckleKind::geometric)
    settings.speckle = SpeckleKind::ground;
  if (sampling.kind != FrustumKind::sweep) settings.pixel_rows = sampling.rows;
  return settings;
}

RadarSettings settings_for_truth(const RadarSettings& settings, const std::vector<Material>& materials) {
  if (!flat_plates(materials).empty()) return settings;
  SamplingCase sweep;
  sweep.kind = FrustumKind::sweep;
  return with_sampling(settings, sweep);
}

std::string sampling_text(const SamplingCase& c) {
  if (c.kind == FrustumKind::sweep)
    return fmt::format("sweep {}, {}", c.columns,
                       c.sub_columns > 0 ? fmt::format("{} sub-columns", c.sub_columns) : "exact");
  return fmt::format("{} {} x {} {}", frustum_name(c.kind), c.columns, c.rows, plates_name(c.plates));
}

std::vector<SamplingCase> frontier_cases(const RadarSettings& settings, const FrontierRange& range) {
  std::vector<SamplingCase> cases;
  for (std::size_t k = 0; k < range.cells_m.size(); ++k) {
    const auto more = k == 0 ? all_samplings(settings, range, range.cells_m[k])
                             : few_samplings(settings, range, range.cells_m[k]);
    cases.insert(cases.end(), more.begin(), more.end());
  }
  if (!range.kinds.empty())
    std::erase_if(cases, [&](const SamplingCase& c) {
      return std::ranges::find(range.kinds, c.kind) == range.kinds.end();
    });
  return cases;
}

std::vector<SamplingCase> sampling_ladder(const RadarSettings& s, double cell_m) {
  std::vector<SamplingCase> ladder;
  if (s.frustum != FrustumKind::sweep) {
    for (const int side : kSides) ladder.push_back({s.frustum, s.plates, side, side, cell_m, s.sub_columns});
    return ladder;
  }
  for (const int per_bin : kPerBin) {
    const int planes = per_bin * s.azimuth_bins;
    if (planes <= kMostSide) ladder.push_back({s.frustum, s.plates, planes, 0, cell_m, s.sub_columns});
  }
  return ladder;
}

std::vector<TriedSampling> climb(const std::vector<SamplingCase>& ladder, const AccuracyLimit& limit,
                                 const std::function<BinErrors(const SamplingCase&)>& measure) {
  std::vector<TriedSampling> tried;
  for (const SamplingCase& sampling : ladder) {
    tried.push_back({sampling, measure(sampling)});
    if (limit.met_by(tried.back().errors)) break;
  }
  return tried;
}

}  // namespace obliq
