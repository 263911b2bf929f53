#pragma once
// Which entity types of DIS a target type is for.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace obliq {

/// IEEE 1278.1-2012, 6.2.30: what an entity is, by numbers of SISO-REF-010.
struct DisEntityType {
  std::uint8_t kind = 0;
  std::uint8_t domain = 0;
  std::uint16_t country = 0;
  std::uint8_t category = 0;
  std::uint8_t subcategory = 0;
  std::uint8_t specific = 0;
  std::uint8_t extra = 0;
  bool operator==(const DisEntityType&) const = default;
  auto operator<=>(const DisEntityType&) const = default;

  std::array<int, 7> parts() const;
};

/// "1.1.225.7.2.0.0".
std::string text_of(const DisEntityType& type);

/// "1.1.*.81": kind.domain.country.category.subcategory.specific.extra. "*" stands for any number, and so
/// does each part that is left out at the end.
class DisPattern {
 public:
  static constexpr const char* kAllowed =
      "one to seven parts kind.domain.country.category.subcategory.specific.extra, each 0 to 255 (country: "
      "to "
      "65535) or \"*\", such as \"1.1.225.7\"";

  /// Empty: it is none.
  static std::optional<DisPattern> parse(std::string_view text);

  bool matches(const DisEntityType& type) const;
  /// How many parts it says; of two that match the one with more wins.
  int said() const;

 private:
  static constexpr int kAny = -1;
  std::array<int, 7> parts_{kAny, kAny, kAny, kAny, kAny, kAny, kAny};
};

}  // namespace obliq
