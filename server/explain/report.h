#pragma once
#include <string>

#include "server/explain/explanation.h"

namespace obliq {

/// For a terminal of 100 columns.
std::string plain_report(const Explanation& explanation);
std::string markdown_report(const Explanation& explanation);
/// A header line, then a line for the scene, for each of the two noises and for every comparison; RFC 4180.
std::string csv_report(const Explanation& explanation);

}  // namespace obliq
