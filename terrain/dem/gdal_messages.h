#pragma once
#include <string>

namespace obliq {

/// While one lives, GDAL's messages on this thread are kept here instead of printed. Registers GDAL's
/// drivers on first use. Lives on the stack, nests.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  /// The first failure since construction or clear(), without line ends; empty when there was none.
  const std::string& failure() const { return failure_; }
  /// failure(), or the fallback when GDAL gave no reason.
  std::string reason(const char* fallback) const { return failure_.empty() ? fallback : failure_; }
  /// As reason(), without the path that GDAL begins with: for sentences that have named it.
  std::string reason_without(const std::string& path, const char* fallback) const;
  void clear() { failure_.clear(); }
  void keep(const char* message);

 private:
  std::string failure_;
};

/// Release of the GDAL in use, "3.6.2".
std::string gdal_version();

/// Of everything that a grid's heights go through.
std::string terrain_library_versions();

}  // namespace obliq
