#pragma once
#include <string>

namespace obliq::wire {
class Pose;
}

namespace obliq {

/// Where an antenna stands and looks, for people.
std::string pose_text(const wire::Pose& pose);

}  // namespace obliq
