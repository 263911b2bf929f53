#pragma once
#include <functional>
#include <string_view>

namespace obliq {

/// Told how far a long stage has come, 0 to 1. Called from one thread at a time; may be empty.
using Progress = std::function<void(std::string_view stage, double fraction)>;

}  // namespace obliq
