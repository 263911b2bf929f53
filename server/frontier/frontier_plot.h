#pragma once
#include <filesystem>
#include <vector>

#include "server/frontier/frontier_header.h"
#include "server/frontier/frontier_table.h"

namespace obliq {

/// Writes frontier.svg and frontier.png into the folder: frame time against E, median dB, gaps and false
/// light of all returns, one colour for each kind, the paper's setting as a star. Throws InputError that
/// names the file.
void draw_frontier(const std::filesystem::path& folder, const FrontierHeader& header,
                   const std::vector<FrontierRow>& rows);

}  // namespace obliq
