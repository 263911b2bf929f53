#pragma once
#include <map>
#include <string>
#include <vector>

#include "server/control/sections/dis_pattern.h"
#include "server/control/sections/target_config.h"

namespace obliq {

/// deploy/target_types.toml as it was when the program was built.
const char* shipped_target_types();

/// Which target type an entity of DIS is, by the patterns of the types.
class EntityKinds {
 public:
  struct Match {
    const TargetType* type = nullptr;  ///< null: it is no target
    bool of_server = false;            ///< the server knows the type by its name
    bool by_domain = false;            ///< only a shipped pattern of kind and domain has caught it
  };

  /// own: of --types; of_server: of the server's scene. The shipped ones take what neither catches.
  EntityKinds(std::vector<TargetType> own, std::vector<TargetType> of_server);
  EntityKinds(const EntityKinds&) = delete;
  EntityKinds& operator=(const EntityKinds&) = delete;

  /// Of the patterns that match, the one that says most numbers; of two such --types' before the server's,
  /// then the first by the name of its type.
  Match of(const DisEntityType& type);
  /// Which types were met that only kind and domain, or nothing, has caught: a sentence for each, once.
  std::vector<std::string> take_news();

 private:
  struct Rule {
    DisPattern pattern;
    Match match;
  };
  void add(std::vector<Rule>& rules, const std::vector<TargetType>& types, bool of_server);
  Match search(const DisEntityType& type) const;

  std::vector<TargetType> own_, of_server_, shipped_;
  std::vector<Rule> rules_, shipped_rules_;
  std::map<DisEntityType, Match> known_;
  std::vector<std::string> news_;
};

}  // namespace obliq
