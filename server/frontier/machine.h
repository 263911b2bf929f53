#pragma once
#include <string>

namespace obliq {

/// The processor's name as the system reports it; "unknown processor" where it does not.
std::string processor_name();

/// Programs that wanted to run, mean over the last minute; 0 where the system does not say.
double load_average();

}  // namespace obliq
