#include "server/control/complaints.h"

#include <numeric>

namespace obliq {

namespace {

/// Levenshtein distance: the fewest characters to insert, drop or replace.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string without_underscores(std::string_view word) {
  std::string plain(word);
  std::erase(plain, '_');
  return plain;
}

}  // namespace

std::string nearest_name(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t kLongestWord = 64;  // longer ones are no slip of ours
  std::string best;
  if (word.size() > kLongestWord) return best;
  const std::string plain = without_underscores(word);
  std::size_t best_distance = 1 + std::max<std::size_t>(1, word.size() / 3);
  for (const std::string& candidate : candidates) {
    // A name without its unit ("r_max", "rmax" for "r_max_m") counts as a single slip.
    const std::string stem = without_underscores(candidate.substr(0, candidate.rfind('_')));
    const bool lacks_unit = !plain.empty() && stem == plain;
    const std::size_t distance = lacks_unit ? 1 : edit_distance(plain, without_underscores(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace obliq
