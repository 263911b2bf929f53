#pragma once
// Numbers as readers want them, and text of strangers made fit to show.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace obliq {

/// A number as one reads it, with about so many significant digits and never an exponent: "3000", "4.52",
/// "0.149"; "-" for one that is not finite.
std::string short_number(double value, int digits = 3);
/// A fraction as "12.3 %".
std::string percent_text(double fraction);
/// A length as error messages show it: "12.30 m".
std::string metres_text(double value_m);
/// "45 s", "12 min", rounded up.
std::string duration_text(double seconds);

/// "1 frame", "2 frames".
std::string counted(std::uint64_t number, const std::string& thing);

/// Without the spaces, tabs and carriage returns at its ends.
std::string_view trimmed(std::string_view text);

/// All of the text as a number, written as from_chars has it; nothing else.
std::optional<double> number_in(std::string_view text);

/// With spaces for line breaks.
std::string one_line(std::string text);
/// The first `most` bytes, with '?' for everything but printable ASCII: control characters and broken UTF-8
/// have no business on an operator's terminal.
std::string printable_text(std::string_view text, std::size_t most = std::string_view::npos);

/// A CSV field: in quotes, quotes doubled, where it needs them (RFC 4180).
std::string csv_field(const std::string& text);
/// Fields of a line; those in quotes may hold commas and doubled quotes.
std::vector<std::string> csv_fields(const std::string& line);

}  // namespace obliq
