#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace obliq {

/// What something in a cache was made from, spelled out line by line: another text, another thing.
class CacheKey {
 public:
  void add(std::string_view name, std::string_view value);
  void add(std::string_view name, double value);  ///< to the last bit
  void add(std::string_view name, const std::vector<double>& values);
  /// Name, size, time of change, and of files on this machine some of the contents (all of small ones).
  void add_file(const std::string& path);
  /// Something in it cannot be told from another version of itself: nothing is to be kept under this key.
  void refuse() { usable_ = false; }

  /// Of the files, the latest that anything about one of them has changed; seconds since 1970, UTC.
  double newest_change_s() const { return newest_change_s_; }
  bool usable() const { return usable_; }
  const std::string& text() const { return text_; }
  /// 32 hexadecimal digits.
  std::string name() const;

 private:
  std::string text_;
  double newest_change_s_ = 0;
  bool usable_ = true;
};

}  // namespace obliq
