#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace obliq {

/// Files of a folder that change together: each is written beside its place, under another name, and all are
/// renamed into place when all are whole. What fails leaves the folder as it was: a full disk never mixes the
/// files of two frames, and a reader never opens half a file.
class NewFiles {
 public:
  explicit NewFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}
  /// Removes what was not put in place.
  ~NewFiles();
  NewFiles(const NewFiles&) = delete;
  NewFiles& operator=(const NewFiles&) = delete;

  using Writer = std::function<void(const std::filesystem::path&)>;
  /// `writer` writes the path that it is given; its InputError comes out naming the file itself.
  void add(const std::string& name, const Writer& writer);
  /// An older file of that name goes when the new ones come.
  void leave_out(const std::string& name);
  /// In the order in which they were added: the last one tells a reader that all are there. Throws
  /// InputError.
  void put_in_place();

 private:
  std::filesystem::path beside(const std::string& name) const;

  std::filesystem::path directory_;
  std::vector<std::string> written_;
  std::vector<std::string> left_out_;
};

/// One such file. A device or a pipe is written as it is.
void replace_file(const std::filesystem::path& path, const NewFiles::Writer& writer);

}  // namespace obliq
