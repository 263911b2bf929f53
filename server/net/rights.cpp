#include "server/net/rights.h"

#include <algorithm>
#include <array>

namespace obliq::net {
namespace {

using wire::MessageType;

// SetPose: where the antenna looks from its platform (aim.h) is the settings' where another client holds
// them.
constexpr wire::ClaimSet kBoth = wire::kPoseClaim | wire::kSettingsClaim;

constexpr std::array kRights{
    Right{MessageType::list_radars, "ListRadars"},
    Right{MessageType::get_radar, "GetRadar"},
    Right{MessageType::get_status, "GetStatus"},
    Right{MessageType::claim_control, "ClaimControl", security::Role::controller},
    Right{MessageType::set_settings, "SetSettings", security::Role::controller, wire::kSettingsClaim},
    Right{MessageType::set_state, "SetState", security::Role::controller, wire::kSettingsClaim},
    Right{MessageType::set_pose, "SetPose", security::Role::controller, wire::kPoseClaim},
    Right{MessageType::release_control, "ReleaseControl", security::Role::controller},
    Right{MessageType::subscribe, "Subscribe"},
    Right{MessageType::unsubscribe, "Unsubscribe"},
    Right{MessageType::render_once, "RenderOnce"},
    Right{MessageType::query_ground, "QueryGround"},
    Right{MessageType::set_replay, "SetReplay", security::Role::controller},
    Right{MessageType::set_targets, "SetTargets", security::Role::controller, wire::kTargetsClaim},
    Right{MessageType::get_targets, "GetTargets", security::Role::viewer, 0, false, true},
    Right{MessageType::get_exercise, "GetExercise"},
    Right{MessageType::reset_exercise, "ResetExercise", security::Role::controller, kBoth, true},
    Right{MessageType::load_exercise, "LoadExercise", security::Role::controller, kBoth, true},
    Right{MessageType::set_exercise, "SetExercise", security::Role::controller, kBoth, true},
    Right{MessageType::get_events, "GetEvents"},
    Right{MessageType::add_bookmark, "AddBookmark", security::Role::controller},
};

}  // namespace

std::span<const Right> rights() { return kRights; }

const Right* right_of(MessageType request) {
  const auto* at = std::ranges::find(kRights, request, &Right::request);
  return at == kRights.end() ? nullptr : &*at;
}

}  // namespace obliq::net
