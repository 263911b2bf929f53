// `obliq parameters`: what can be set, in which units and within which limits.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "server/apps/commands.h"
#include "server/control/parameter_reference.h"

namespace obliq {

void add_parameters(CLI::App& app) {
  CLI::App* command = app.add_subcommand("parameters", "List every parameter with unit, default and limits");
  auto markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *markdown, "As the Markdown page server/control/PARAMETERS.md");
  command->callback([markdown] { std::cout << (*markdown ? parameters_markdown() : parameters_text()); });
}

}  // namespace obliq
