#pragma once

#include "fpbm/model/presets.hpp"
#include "fpbm/model/tree.hpp"

namespace fpbm::presets {

/// Two Pandas at a table, side by side, 0.8 m apart along y: "right" and "left", with the frames right_tip and
/// left_tip.
[[nodiscard]] inline Tree<> two_pandas() {
  Tree<> tree;
  Transform<> place;
  for (const char* name : {"right", "left"}) {
    place.p(1) = tree.joints.empty() ? -0.4 : 0.4;
    add_arm(tree, panda(), name, 0, place);
  }
  return tree;
}

/// A preset by name, for programs that learn it at run time.
struct RobotPreset {
  const char* name;
  Tree<> (*tree)();
};
inline constexpr RobotPreset kRobots[] = {{"two_pandas", two_pandas}};

}  // namespace fpbm::presets
