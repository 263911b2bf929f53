#include "server/apps/dis/entity_kinds.h"

#include <fmt/core.h>

#include <utility>

#include "server/control/config_tree.h"
#include "server/control/sections/targets.h"

namespace obliq {
namespace {

constexpr int kDomainParts = 2;
// Types are any bytes that come: what is known of more of them is forgotten.
constexpr std::size_t kMostKnown = 10'000;
constexpr std::size_t kMostNews = 16;

}  // namespace

EntityKinds::EntityKinds(std::vector<TargetType> own, std::vector<TargetType> of_server)
    : own_(std::move(own)),
      of_server_(std::move(of_server)),
      shipped_(read_type_file(parse_config_text(shipped_target_types(), "target_types.toml"))) {
  add(rules_, own_, false);
  add(rules_, of_server_, true);
  add(shipped_rules_, shipped_, false);
}

void EntityKinds::add(std::vector<Rule>& rules, const std::vector<TargetType>& types, bool of_server) {
  for (const TargetType& type : types)
    for (const std::string& text : type.dis)
      if (const auto pattern = DisPattern::parse(text))
        rules.push_back({*pattern, {&type, of_server, false}});
}

EntityKinds::Match EntityKinds::search(const DisEntityType& type) const {
  const auto best = [&](const std::vector<Rule>& rules) {
    const Rule* found = nullptr;
    for (const Rule& rule : rules)
      if (rule.pattern.matches(type) && (found == nullptr || rule.pattern.said() > found->pattern.said()))
        found = &rule;
    return found;
  };
  if (const Rule* rule = best(rules_)) return rule->match;
  const Rule* rule = best(shipped_rules_);
  if (rule == nullptr) return {};
  Match match = rule->match;
  match.by_domain = rule->pattern.said() <= kDomainParts;
  return match;
}

EntityKinds::Match EntityKinds::of(const DisEntityType& type) {
  if (const auto known = known_.find(type); known != known_.end()) return known->second;
  const Match match = search(type);
  if ((match.type == nullptr || match.by_domain) && news_.size() < kMostNews) {
    const std::string pattern = text_of(type);
    news_.push_back(
        match.type == nullptr
            ? fmt::format("entities {} are no targets: no type has a pattern for them, such as dis "
                          "= [\"{}\"]",
                          pattern, pattern)
            : fmt::format("entities {} are of type {} by kind and domain alone; dis = [\"{}\"] of "
                          "another type would catch them",
                          pattern, toml_string(match.type->name), pattern));
  }
  if (known_.size() >= kMostKnown) known_.clear();
  known_.emplace(type, match);
  return match;
}

std::vector<std::string> EntityKinds::take_news() { return std::exchange(news_, {}); }

}  // namespace obliq
