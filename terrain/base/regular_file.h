#pragma once
#include <string>

namespace obliq {

/// Where this name stands for what may not be opened, as opening or reading it may never end: "a pipe", "a
/// socket", "a device"; empty for all else. A folder is for its reader to judge (GDAL has formats that are
/// one), and so is what is not there: a URL, or one of GDAL's own names (/vsizip/...).
std::string endless_file(const std::string& path);

/// Throws InputError "WHERE: found a pipe; allowed: a regular file" for such a name.
void refuse_endless_file(const std::string& where, const std::string& path);

}  // namespace obliq
