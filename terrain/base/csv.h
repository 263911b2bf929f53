#pragma once
#include <string>
#include <vector>

namespace obliq {

/// A CSV field: in quotes, quotes doubled, where it needs them (RFC 4180).
std::string csv_field(const std::string& text);
/// Fields of a line; those in quotes may hold commas and doubled quotes.
std::vector<std::string> csv_fields(const std::string& line);

}  // namespace obliq
