#pragma once
#include <span>
#include <vector>

#include "proto/target_record.h"
#include "server/radar/frame_plan.h"
#include "server/radar/targets/target_echoes.h"

namespace obliq::wire {
class FrameDescriptor;
}

namespace obliq {

/// Where targets are in a frame. noise_power_w: of its receiver; 0: none, the records have powers.
std::vector<wire::TargetRecord> target_records(const FramePlan& plan, std::span<const TargetTruth> truth,
                                               double noise_power_w);

/// How many there are; null: none.
void describe_targets(const TargetsPtr& targets, wire::FrameDescriptor& descriptor);

}  // namespace obliq
