#include "server/output/new_files.h"

#include <system_error>

#include "terrain/base/errors.h"

namespace obliq {

std::filesystem::path NewFiles::beside(const std::string& name) const {
  return directory_ / ("." + name + ".new");
}

NewFiles::~NewFiles() {
  std::error_code none;
  for (const std::string& name : written_) std::filesystem::remove(beside(name), none);
}

void NewFiles::add(const std::string& name, const Writer& writer) {
  const std::filesystem::path path = beside(name);
  written_.push_back(name);
  try {
    writer(path);
  } catch (const InputError& error) {
    std::string text = error.what();
    for (auto at = text.find(path.string()); at != std::string::npos; at = text.find(path.string(), at + 1))
      text.replace(at, path.string().size(), (directory_ / name).string());
    throw InputError(text);
  }
}

void NewFiles::leave_out(const std::string& name) { left_out_.push_back(name); }

void NewFiles::put_in_place() {
  std::error_code error;
  for (const std::string& name : left_out_) std::filesystem::remove(directory_ / name, error);
  for (const std::string& name : written_) {
    std::filesystem::rename(beside(name), directory_ / name, error);
    if (error)
      throw InputError((directory_ / name).string() + ": cannot be put in place (" + error.message() + ")");
  }
  written_.clear();
}

void replace_file(const std::filesystem::path& path, const NewFiles::Writer& writer) {
  std::error_code none;
  if (std::filesystem::exists(path, none) && !std::filesystem::is_regular_file(path, none)) {
    writer(path);
    return;
  }
  NewFiles file(path.parent_path());
  file.add(path.filename().string(), writer);
  file.put_in_place();
}

}  // namespace obliq
