#pragma once
// What to say of a command line that does not parse.
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace obliq {

/// One sentence: the word that is not understood, what was likely meant, and where all of them stand. `app`
/// has parsed the line as far as it goes.
std::string explain_parse_failure(const CLI::App& app, const CLI::ParseError& error, int argc,
                                  const char* const* argv);

}  // namespace obliq
