#include "server/control/sections/dis_pattern.h"

#include <algorithm>
#include <charconv>

namespace obliq {

std::array<int, 7> DisEntityType::parts() const {
  return {kind, domain, country, category, subcategory, specific, extra};
}

std::string text_of(const DisEntityType& type) {
  std::string text;
  for (const int part : type.parts()) text += (text.empty() ? "" : ".") + std::to_string(part);
  return text;
}

std::optional<DisPattern> DisPattern::parse(std::string_view text) {
  constexpr std::size_t kCountry = 2;
  DisPattern pattern;
  for (std::size_t k = 0;; ++k) {
    if (k == pattern.parts_.size()) return std::nullopt;
    const std::string_view part = text.substr(0, text.find('.'));
    if (part != "*") {
      const auto [past, error] = std::from_chars(part.data(), part.data() + part.size(), pattern.parts_[k]);
      const int most = k == kCountry ? 65535 : 255;
      if (error != std::errc() || past != part.data() + part.size() || pattern.parts_[k] < 0 ||
          pattern.parts_[k] > most)
        return std::nullopt;
    }
    if (part.size() == text.size()) return pattern;
    text.remove_prefix(part.size() + 1);
  }
}

bool DisPattern::matches(const DisEntityType& type) const {
  const std::array<int, 7> found = type.parts();
  for (std::size_t k = 0; k < found.size(); ++k)
    if (parts_[k] != kAny && parts_[k] != found[k]) return false;
  return true;
}

int DisPattern::said() const {
  return static_cast<int>(std::ranges::count_if(parts_, [](int part) { return part != kAny; }));
}

}  // namespace obliq
