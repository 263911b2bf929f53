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
  Change change;
};

/// What a value may be: within limits, or one of a list of names.
struct Accepts {
  Limits limits = {};
  std::span<const Choice> choices = {};

  constexpr Accepts() = default;
  constexpr Accepts(const Limits& all) : limits(all) {}
  template <std::size_t n>
  constexpr Accepts(const std::array<Choice, n>& names) : choices(names) {}
  constexpr Accepts(std::span<const Choice> names) : choices(names) {}
};

template <class T, class Member>
T owner_of(Member T::*);

/// Makes the rows of one part: Http::row<&HttpConfig::port>("http.port", ...) with
/// Http = RowsOf<Change::restart, &SceneConfig::http>. The pointers to members lead to the value, one in the
/// other.
template <Change change, auto... part>
struct RowsOf {
  template <auto... members>
  static constexpr auto row(std::string_view name, std::string_view unit, Accepts accepts,
                            std::string_view summary) {
    return make<part..., members...>({name, unit, accepts.limits, accepts.choices, summary});
  }
  template <auto... members>
  static constexpr auto row(std::string_view name, Accepts accepts, std::string_view summary) {
    return row<members...>(name, "", accepts, summary);
  }
  template <auto... members>
  static constexpr auto row(std::string_view name, std::string_view summary) {
    return row<members...>(name, "", kAny, summary);
  }

 private:
  template <auto first, auto... rest>
  static constexpr auto make(const Key& key) {
    using T = decltype(owner_of(first));
    return Row<T>{key, [](T& object) -> Slot { return &((object.*first).*....*rest); }, change};
  }
};

/// The row of a member of a struct that is read again with the scene.
template <auto... members>
constexpr auto row(const auto&... text) {
  return RowsOf<Change::reload>::row<members...>(text...);
}

}  // namespace obliq
