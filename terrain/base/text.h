#pragma once
// Numbers as readers want them.
#include <string>

namespace obliq {

/// A number as one reads it, with about so many significant digits and never an exponent: "3000", "4.52",
/// "0.149"; "-" for one that is not finite.
std::string short_number(double value, int digits = 3);
/// A fraction as "12.3 %".
std::string percent_text(double fraction);
/// A length as error messages show it: "12.30 m".
std::string metres_text(double value_m);

}  // namespace obliq
