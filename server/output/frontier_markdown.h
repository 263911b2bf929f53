#pragma once
#include <string>
#include <vector>

#include "server/output/frontier_header.h"
#include "server/output/frontier_table.h"

namespace obliq {

/// frontier.md: what was measured and how, the comparison with the paper's setting, one table for each part
/// of the returns, and what was not possible.
std::string frontier_markdown(const FrontierHeader& header, const std::vector<FrontierRow>& rows);

/// One line: machine, threads, tracer, repeats.
std::string machine_text(const FrontierHeader& header);

/// "0.0123", "1.5": three significant digits, no exponent between 1e-6 and 1e6.
std::string short_number(double value);
/// A fraction as "12.3 %".
std::string percent_text(double fraction);

}  // namespace obliq
