#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace obliq::security {

/// What a client may do; each role includes the ones before it.
enum class Role : std::uint8_t {
  viewer,      ///< list, watch, status, RenderOnce
  controller,  ///< claims radars, sets them, subscribes without losses
  admin,       ///< takes control from others
};

constexpr std::string_view role_name(Role role) {
  switch (role) {
    case Role::viewer:
      return "viewer";
    case Role::controller:
      return "controller";
    case Role::admin:
      break;
  }
  return "admin";
}

constexpr std::size_t kMinTokenBytes = 16;
constexpr std::size_t kMaxTokenBytes = 256;

/// SHA-256 of a token: what is kept of it.
using TokenDigest = std::array<std::uint8_t, 32>;

/// What a token grants.
struct Grant {
  Role role = Role::viewer;
  std::string name;  ///< from the file; may be empty
  TokenDigest digest{};
};

/// The tokens of a file, of which only digests are kept. Never changes once read.
class TokenFile {
 public:
  /// One token a line: ROLE TOKEN [NAME]; # begins a comment. Throws InputError that names file, line and
  /// reason, never a token: a role that is none, a token that is short, there twice or not printable, no
  /// token at all, a file that group or others may read or write, or whose owner is neither this process's
  /// user nor root.
  static TokenFile read(const std::filesystem::path& path);

  /// Takes the same time whichever entry matches, if any.
  std::optional<Grant> find(std::string_view token) const;
  std::optional<Grant> find(const TokenDigest& digest) const;
  std::size_t size() const { return entries_.size(); }

 private:
  void add(std::string_view line, const std::string& where);

  std::vector<Grant> entries_;
};

}  // namespace obliq::security
