#pragma once
#include <cstdio>
#include <string>

namespace obliq {

/// A length as error messages show it: "12.30 m".
inline std::string metres_text(double value_m) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f m", value_m);
  return text;
}

}  // namespace obliq
