#pragma once
#include <string>

namespace obliq {

/// The parameters for a terminal: one line each.
std::string parameters_text();

/// Every key as an object of a JSON array: key, message_field (or null), type, unit, default, limits
/// (at_least, above, at_most, below, one_of), allowed in words, change (live, reload, restart), text.
std::string parameters_json();

/// The reference page server/control/PARAMETERS.md; a test compares the two.
std::string parameters_markdown();

}  // namespace obliq
