#pragma once
#include <string>
#include <vector>

#include "server/frontier/frontier_header.h"
#include "server/frontier/frontier_table.h"

namespace obliq {

/// frontier.md: what was measured and how, the comparison with the paper's setting, one table for each part
/// of the returns, and what was not possible.
std::string frontier_markdown(const FrontierHeader& header, const std::vector<FrontierRow>& rows);

/// One line: machine, threads, tracer, repeats.
std::string machine_text(const FrontierHeader& header);

}  // namespace obliq
