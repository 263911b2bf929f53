#include "server/output/describe_targets.h"

#include <algorithm>
#include <cmath>

#include "proto/obliq.pb.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr bool is_same(HiddenBy ours, wire::HiddenBy theirs) {
  return static_cast<int>(ours) == static_cast<int>(theirs);
}
static_assert(is_same(HiddenBy::nothing, wire::HiddenBy::nothing) &&
              is_same(HiddenBy::ground, wire::HiddenBy::ground) &&
              is_same(HiddenBy::building, wire::HiddenBy::building) &&
              is_same(HiddenBy::horizon, wire::HiddenBy::horizon) &&
              is_same(HiddenBy::unknown_ground, wire::HiddenBy::unknown_ground));

float decibels(double ratio) {
  return ratio > 0 ? std::max(static_cast<float>(10 * std::log10(ratio)), wire::kLeastSnr_db)
                   : wire::kLeastSnr_db;
}

}  // namespace

std::vector<wire::TargetRecord> target_records(const FramePlan& plan, std::span<const TargetTruth> truth,
                                               double noise_power_w) {
  const WorldFrame& frame = plan.scene().world().frame;
  const double start_deg = plan.pose().settings.bearing_deg - plan.settings().sector_deg / 2;
  const double loss = std::pow(10.0, -plan.settings().receiver.loss_db / 10);
  std::vector<wire::TargetRecord> records;
  for (const TargetTruth& each : truth) {
    if (records.size() == wire::kMaxTargetRecords) break;
    const Geodetic at = frame.geodetic_from_world({each.foot_m});
    wire::TargetRecord record;
    record.id = each.id;
    record.latitude_deg = at.latitude_rad / kDegree_rad;
    record.longitude_deg = at.longitude_rad / kDegree_rad;
    record.height_m = each.height_m;
    const double turns = (start_deg + each.azimuth_rad / kDegree_rad) / 360;
    record.bearing_deg = 360 * (turns - std::floor(turns));
    record.range_m = each.range_m;
    record.elevation_deg = static_cast<float>(each.elevation_rad / kDegree_rad);
    record.closing_m_s = static_cast<float>(each.closing_m_s);
    record.is_power = !(noise_power_w > 0);
    record.snr_db = decibels(each.power_w * loss / (record.is_power ? 1 : noise_power_w));
    record.rcs_dbsm = decibels(each.rcs_m2);
    record.share_seen = static_cast<float>(each.share);
    record.azimuth_bin = each.azimuth_bin;
    record.range_bin = each.range_bin;
    record.hidden_by = static_cast<wire::HiddenBy>(each.hidden_by);
    records.push_back(record);
  }
  return records;
}

void describe_targets(const TargetsPtr& targets, wire::FrameDescriptor& descriptor) {
  if (!targets) return;
  descriptor.set_targets_version(targets->version);
  descriptor.set_targets(static_cast<std::uint32_t>(targets->targets.size()));
}

}  // namespace obliq
