#include "server/accuracy/truth_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>

#include "terrain/base/errors.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

constexpr std::uint64_t kMagic = 0x3230485552545142;  // "BQTRUH02", read back on the same machine only

/// A building that has anything to say.
struct BuildingRecord {
  std::uint32_t index;
  std::uint32_t zero = 0;
  BuildingTruth truth;
};

struct RecordHead {
  std::int32_t first_azimuth;
  std::int32_t n_azimuth;
  std::int32_t n_range;
  std::int32_t n_buildings;  ///< records that follow the planes
};

/// Bytes of one record, its hash behind them.
std::string record_of(const ReferenceBins& bins) {
  std::vector<BuildingRecord> seen;
  for (std::uint32_t i = 0; i < bins.buildings.size(); ++i)
    if (bins.buildings[i].unoccluded_sr > 0 || bins.buildings[i].visible_sr > 0)
      seen.push_back({i, 0, bins.buildings[i]});
  const RecordHead head{bins.first_azimuth, bins.n_azimuth, bins.n_range,
                        static_cast<std::int32_t>(seen.size())};
  std::string bytes;
  const auto put = [&](const void* from, std::size_t n) { bytes.append(static_cast<const char*>(from), n); };
  put(&head, sizeof head);
  put(bins.ground_w.data(), bins.ground_w.size() * sizeof(double));
  put(bins.building_w.data(), bins.building_w.size() * sizeof(double));
  put(seen.data(), seen.size() * sizeof(BuildingRecord));
  return bytes;
}

/// The next record if it is the one that is wanted, whole and undamaged.
std::optional<ReferenceBins> read_record(std::ifstream& file, const AzimuthRange& wanted, int n_range,
                                         std::size_t n_buildings) {
  RecordHead head{};
  std::string bytes(sizeof head, '\0');
  if (!file.read(bytes.data(), sizeof head)) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof head);
  if (head.first_azimuth != wanted.first || head.n_azimuth != wanted.count || head.n_range != n_range ||
      head.n_buildings < 0 || static_cast<std::size_t>(head.n_buildings) > n_buildings)
    return std::nullopt;
  const std::size_t plane = static_cast<std::size_t>(head.n_azimuth) * static_cast<std::size_t>(n_range);
  const std::size_t rest =
      2 * plane * sizeof(double) + static_cast<std::size_t>(head.n_buildings) * sizeof(BuildingRecord);
  bytes.resize(sizeof head + rest);
  std::uint64_t hash = 0;
  if (!file.read(bytes.data() + sizeof head, static_cast<std::streamsize>(rest)) ||
      !file.read(reinterpret_cast<char*>(&hash), sizeof hash) || hash != checksum(bytes.data(), bytes.size()))
    return std::nullopt;

  ReferenceBins bins{head.first_azimuth, head.n_azimuth, n_range, {}, {}, {}};
  const char* from = bytes.data() + sizeof head;
  const auto take = [&](void* to, std::size_t n) {
    std::memcpy(to, from, n);
    from += n;
  };
  bins.ground_w.resize(plane);
  bins.building_w.resize(plane);
  bins.buildings.resize(n_buildings);
  take(bins.ground_w.data(), plane * sizeof(double));
  take(bins.building_w.data(), plane * sizeof(double));
  for (std::int32_t k = 0; k < head.n_buildings; ++k) {
    BuildingRecord record{};
    take(&record, sizeof record);
    if (record.index >= n_buildings) return std::nullopt;
    bins.buildings[record.index] = record.truth;
  }
  return bins;
}

/// Each run in stretches of one wedge.
AzimuthRuns stretches_of(const AzimuthRuns& runs) {
  AzimuthRuns stretches;
  for (const AzimuthRange& run : runs)
    for (int at = run.first; at < run.first + run.count; at += kWedgeAzimuthBins)
      stretches.push_back({at, std::min(kWedgeAzimuthBins, run.first + run.count - at)});
  return stretches;
}

}  // namespace

TruthBins integrate_truth_in_file(const std::filesystem::path& path, std::uint64_t key, const FramePlan& plan,
                                  const AzimuthRuns& runs, const ReferenceSampling& sampling,
                                  const Progress& progress) {
  const AzimuthRuns stretches = stretches_of(runs);
  const World& world = plan.scene().world();
  const std::uint64_t head[2] = {kMagic, key};
  TruthBins truth;
  std::uintmax_t good = 0;  // bytes of the file that are worth keeping
  if (std::ifstream file(path, std::ios::binary); file) {
    std::uint64_t found[2] = {0, 0};
    file.read(reinterpret_cast<char*>(found), sizeof found);
    if (file && found[0] == head[0] && found[1] == head[1]) good = sizeof head;
    while (good > 0 && truth.runs.size() < stretches.size()) {
      const auto bins =
          read_record(file, stretches[truth.runs.size()], plan.bins().n_range, world.buildings.list.size());
      if (!bins) break;
      truth.append(*bins);
      good = static_cast<std::uintmax_t>(file.tellg());
    }
  }
  const auto refuse = [&] { throw InputError(path.string() + ": cannot be written (disk full?)"); };
  if (good > 0) std::filesystem::resize_file(path, good);
  std::ofstream file(path, std::ios::binary | (good > 0 ? std::ios::app : std::ios::trunc));
  if (good == 0) file.write(reinterpret_cast<const char*>(head), sizeof head);

  for (std::size_t k = truth.runs.size(); k < stretches.size(); ++k) {
    const ReferenceBins bins = integrate_reference(world, plan.scene().materials(), reference_view(plan),
                                                   sampling, stretches[k].first, stretches[k].count);
    truth.append(bins);
    const std::string bytes = record_of(bins);
    const std::uint64_t hash = checksum(bytes.data(), bytes.size());
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.write(reinterpret_cast<const char*>(&hash), sizeof hash);
    file.flush();
    if (!file) refuse();
    if (progress) progress("truth", static_cast<double>(k + 1) / static_cast<double>(stretches.size()));
  }
  if (!file) refuse();
  truth.runs = runs;  // joined again
  return truth;
}

}  // namespace obliq
