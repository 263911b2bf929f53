#pragma once
// Every key that there is, described: for the reference, for variables of the environment, for near names.
#include <string>
#include <vector>

#include "server/control/key.h"

namespace obliq {

struct Parameter;

enum class KeyGroup {
  radar,       ///< a parameter of a radar
  short_form,  ///< stands for several parameters: frustum.quality
  section,     ///< of a table that stands once
  list,        ///< of [[buildings]], [[prisms]], [[surfaces]], [[target]]
  material     ///< of [materials.NAME]
};

struct KeyText {
  KeyGroup group;
  std::string name;  ///< "radar.r_max_m", "materials.NAME.gamma_db"
  Key key;           ///< unit, limits, choices, summary
  std::string type;  ///< "number", "integer", "boolean", "text", "choice"; "other": a list, a path
  std::string default_text;
  std::string allowed;
  Change change;
  const Parameter* parameter = nullptr;  ///< of a radar's
  bool special = false;                  ///< no row holds it
};

/// In the order of the reference page.
std::vector<KeyText> all_keys();

/// Those that a variable of the environment or a flag can name.
std::vector<std::string> names_of_flags();

}  // namespace obliq
