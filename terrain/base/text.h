#pragma once
// Numbers as readers want them.
#include <string>

namespace obliq {

/// "0.0123", "1.5": three significant digits, no exponent between 1e-6 and 1e6.
std::string short_number(double value);
/// A fraction as "12.3 %".
std::string percent_text(double fraction);
/// A length as error messages show it: "12.30 m".
std::string metres_text(double value_m);

}  // namespace obliq
