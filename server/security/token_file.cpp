#include "server/security/token_file.h"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <sstream>
#include <system_error>

#include "terrain/base/errors.h"
#include "terrain/base/files.h"

namespace obliq::security {
namespace {

constexpr off_t kMaxFileBytes = 1 << 20;
constexpr std::size_t kMaxEntries = 1000;
constexpr std::size_t kMaxNameBytes = 64;

TokenDigest digest_of(std::string_view token) {
  TokenDigest digest;
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
  return digest;
}

std::string last_error() { return std::system_category().message(errno); }

/// Looks at the open file, not at its name: what is checked is what is read.
std::string text_of_private_file(const std::filesystem::path& path) {
  const std::string where = "server.tokens: " + path.string();
  const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!fd || ::fstat(fd.get(), &status) != 0) throw InputError(where + ": " + last_error());
  if (!S_ISREG(status.st_mode)) throw InputError(where + ": found no file; allowed: a file of tokens");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    std::ostringstream mode;
    mode << std::oct << (status.st_mode & 07777);
    throw InputError(where + ": found mode " + mode.str() +
                     "; allowed: a file that only its owner may read (chmod 600)");
  }
  if (status.st_uid != ::geteuid() && status.st_uid != 0)
    throw InputError(where + ": found the owner with uid " + std::to_string(status.st_uid) +
                     "; allowed: " + std::to_string(::geteuid()) + ", which this program runs as, or root");
  if (status.st_size > kMaxFileBytes) throw InputError(where + ": found more than 1 MiB");
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t have = 0;
  while (have < text.size()) {
    const ssize_t n = ::read(fd.get(), text.data() + have, text.size() - have);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw InputError(where + ": " + last_error());
    if (n == 0) break;
    have += static_cast<std::size_t>(n);
  }
  text.resize(have);
  return text;
}

std::optional<Role> role_of(std::string_view word) {
  for (const Role role : {Role::viewer, Role::controller, Role::admin}) {
    if (word == role_name(role)) return role;
  }
  return std::nullopt;
}

}  // namespace

TokenFile TokenFile::read(const std::filesystem::path& path) {
  std::string text = text_of_private_file(path);
  TokenFile tokens;
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    tokens.add(rest.substr(0, end), "server.tokens: " + path.string() + ", line " + std::to_string(number));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  OPENSSL_cleanse(text.data(), text.size());
  if (tokens.entries_.empty())
    throw InputError("server.tokens: " + path.string() +
                     ": found no token; allowed: lines of ROLE TOKEN [NAME]");
  return tokens;
}

void TokenFile::add(std::string_view line, const std::string& where) {
  const auto next_word = [&line] {
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
    if (line.starts_with('#')) line = {};  // a comment; within a word it is part of it
    std::size_t length = 0;
    while (length < line.size() && !is_space(line[length])) ++length;
    const std::string_view word = line.substr(0, length);
    line.remove_prefix(length);
    return word;
  };
  const auto printable = [](std::string_view word) {
    return std::ranges::all_of(word, [](char c) { return c > ' ' && c <= '~'; });
  };
  const std::string_view role_word = next_word();
  if (role_word.empty()) return;
  const std::string_view token = next_word();
  const std::string_view name = next_word();
  const auto role = role_of(role_word);
  // What was found is not shown: if the columns are mixed up, it is the token.
  if (!role) throw InputError(where + ": the first word is no role; allowed: viewer, controller, admin");
  if (token.size() < kMinTokenBytes || token.size() > kMaxTokenBytes || !printable(token))
    throw InputError(where + ": found a token of " + std::to_string(token.size()) +
                     " bytes; allowed: " + std::to_string(kMinTokenBytes) + " to " +
                     std::to_string(kMaxTokenBytes) + " printable ones (openssl rand -hex 24)");
  if (!next_word().empty() || name.size() > kMaxNameBytes || !printable(name))
    throw InputError(where + ": allowed after the token: one printable name of at most " +
                     std::to_string(kMaxNameBytes) + " bytes");
  Grant grant{*role, std::string(name), digest_of(token)};
  if (find(grant.digest)) throw InputError(where + ": this token is there twice");
  if (entries_.size() >= kMaxEntries)
    throw InputError(where + ": found more than " + std::to_string(kMaxEntries) + " tokens");
  entries_.push_back(std::move(grant));
}

std::optional<Grant> TokenFile::find(std::string_view token) const {
  if (token.size() > kMaxTokenBytes) return std::nullopt;
  return find(digest_of(token));
}

std::optional<Grant> TokenFile::find(const TokenDigest& digest) const {
  std::size_t found = entries_.size();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (CRYPTO_memcmp(entries_[i].digest.data(), digest.data(), digest.size()) == 0) found = i;
  }
  if (found == entries_.size()) return std::nullopt;
  return entries_[found];
}

}  // namespace obliq::security
