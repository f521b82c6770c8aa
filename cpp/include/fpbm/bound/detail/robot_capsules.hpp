#pragma once

#include <string>
#include <vector>

#include "fpbm/bound/detail/arm_capsules.hpp"
#include "fpbm/model/detail/robot_presets.hpp"

namespace fpbm {

/// Appends the capsules of an arm to the capsules of a tree. Use the arguments with which add_arm() added the joints of
/// the arm to the tree. first: number of joints before the arm. Names of capsules start with the name of the arm.
template <typename Scalar>
void add_capsules(std::vector<LinkCapsule<Scalar>>& capsules, const std::vector<LinkCapsule<Scalar>>& arm,
                  const std::string& name, int first, int link = 0, const Transform<Scalar>& placement = {}) {
  const std::string prefix = name + "_";
  for (const auto& [own_link, capsule, own_name] : arm) {
    const bool is_base = own_link == 0;
    capsules.push_back(
        {is_base ? link : first + own_link, is_base ? placed(capsule, placement) : capsule, prefix + own_name});
  }
}

namespace presets {

namespace capsules {

/// presets::two_pandas(), without hands.
[[nodiscard]] inline std::vector<LinkCapsule<>> two_pandas() {
  std::vector<LinkCapsule<>> both;
  Transform<> place;
  place.p(1) = -kPandaOffset;
  add_capsules(both, panda(), "right", 0, 0, place);
  place.p(1) = kPandaOffset;
  add_capsules(both, panda(), "left", 7, 0, place);
  return both;
}

}  // namespace capsules

namespace never_collide {

[[nodiscard]] inline std::vector<LinkNames> two_pandas() {
  std::vector<LinkNames> both;
  for (const std::string arm : {"right_", "left_"}) {
    for (const auto& [first, second] : panda()) both.emplace_back(arm + first, arm + second);
  }
  return both;
}

}  // namespace never_collide

inline constexpr PresetCapsules kRobotCapsules[] = {{"two_pandas", capsules::two_pandas, never_collide::two_pandas}};

}  // namespace presets

}  // namespace fpbm
