#pragma once
#include <string>

namespace obliq {

/// The parameters for a terminal: one line each.
std::string parameters_text();

/// The reference page server/control/PARAMETERS.md; a test compares the two.
std::string parameters_markdown();

}  // namespace obliq
