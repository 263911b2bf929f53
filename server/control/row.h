#pragma once
// A key of the configuration in two lines: its name, unit, limits and sentence, and by pointers to members
// where its value lives.
#include <array>
#include <span>
#include <string_view>

#include "server/control/key.h"

namespace obliq {

/// One key of a T.
template <class T>
struct Row {
  Key key;
  Slot (*slot)(T&);
};

/// What a value may be: within limits, or one of a list of names.
struct Accepts {
  Limits limits = {};
  std::span<const Choice> choices = {};

  constexpr Accepts() = default;
  constexpr Accepts(const Limits& all) : limits(all) {}
  template <std::size_t n>
  constexpr Accepts(const std::array<Choice, n>& names) : choices(names) {}
};

template <class T, class Member>
T owner_of(Member T::*);

/// The row of a value that lies behind these members, one in the other.
template <auto first, auto... rest>
constexpr auto row(std::string_view name, std::string_view unit, Accepts accepts, std::string_view summary) {
  using T = decltype(owner_of(first));
  return Row<T>{{name, unit, accepts.limits, accepts.choices, summary},
                [](T& object) -> Slot { return &((object.*first).*....*rest); }};
}
template <auto... members>
constexpr auto row(std::string_view name, Accepts accepts, std::string_view summary) {
  return row<members...>(name, "", accepts, summary);
}
template <auto... members>
constexpr auto row(std::string_view name, std::string_view summary) {
  return row<members...>(name, "", {}, summary);
}

/// row() for the members of one part: RowsOf<&SceneConfig::http>::row<&HttpConfig::port>(...).
template <auto... part>
struct RowsOf {
  template <auto... members>
  static constexpr auto row(const auto&... text) {
    return obliq::row<part..., members...>(text...);
  }
};

}  // namespace obliq
