#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fpbm/bound/clearance.hpp"

/// Capsules on the links of the presets [m]. The capsules contain the collision meshes of the manufacturers in every
/// posture, but no cables, tools or other mounted parts. Written by tools/preset_capsules.py.
namespace fpbm::presets::capsules {

/// Franka Emika Panda, without a hand.
///
/// Meshes: example-robot-data 6.0.0, from Franka's franka_description, Apache-2.0.
[[nodiscard]] inline std::vector<LinkCapsule<>> panda() {
  return {
      {0, {{-0.0001, 0.0000, 0.0514}, {-0.0567, -0.0001, 0.0151}, 0.1045}, "panda_link0"},
      {1, {{0.0000, -0.0002, -0.1397}, {0.0000, -0.0534, 0.0008}, 0.0763}, "panda_link1"},
      {2, {{-0.0001, -0.1418, 0.0000}, {-0.0001, 0.0015, 0.0535}, 0.0762}, "panda_link2"},
      {3, {{0.0003, 0.0001, -0.0798}, {0.0829, 0.0426, 0.0004}, 0.0693}, "panda_link3"},
      {4, {{-0.0817, 0.0831, 0.0003}, {0.0000, -0.0001, 0.0425}, 0.0695}, "panda_link4"},
      {5, {{0.0002, 0.0104, -0.2438}, {0.0000, 0.0639, 0.0030}, 0.0674}, "panda_link5"},
      {6, {{0.0872, 0.0088, -0.0003}, {0.0230, 0.0070, 0.0060}, 0.0751}, "panda_link6"},
      {7, {{-0.0051, -0.0051, 0.0733}, {0.0329, 0.0330, 0.0808}, 0.0494}, "panda_link7"},
  };
}

/// Franka Research 3, without a hand.
///
/// Meshes: franky-sim 1.0.4, from Franka's franka_description, Apache-2.0.
[[nodiscard]] inline std::vector<LinkCapsule<>> fr3() {
  return {
      {0, {{-0.0564, -0.0009, 0.0172}, {-0.0007, 0.0001, 0.0521}, 0.1055}, "fr3_link0"},
      {1, {{0.0003, 0.0004, -0.1396}, {0.0000, -0.0535, 0.0003}, 0.0767}, "fr3_link1"},
      {2, {{-0.0001, -0.1423, 0.0001}, {0.0000, 0.0018, 0.0538}, 0.0764}, "fr3_link2"},
      {3, {{0.0004, 0.0006, -0.0823}, {0.0830, 0.0420, -0.0018}, 0.0699}, "fr3_link3"},
      {4, {{-0.0821, 0.0842, 0.0005}, {0.0007, -0.0005, 0.0426}, 0.0694}, "fr3_link4"},
      {5, {{0.0024, 0.0121, -0.2448}, {0.0000, 0.0663, 0.0027}, 0.0678}, "fr3_link5"},
      {6, {{0.0222, 0.0073, 0.0040}, {0.0871, 0.0085, -0.0024}, 0.0753}, "fr3_link6"},
      {7, {{0.0326, 0.0326, 0.0838}, {-0.0056, -0.0057, 0.0715}, 0.0493}, "fr3_link7"},
  };
}

/// KUKA LBR iiwa 14 R820.
///
/// Meshes: rtb-data 2.0.0, from ROS-Industrial's kuka_lbr_iiwa_support, Apache-2.0.
[[nodiscard]] inline std::vector<LinkCapsule<>> iiwa14() {
  return {
      {0, {{0.0000, 0.0000, 0.0553}, {-0.0368, 0.0000, 0.0672}, 0.1334}, "base_link"},
      {1, {{-0.0001, 0.0001, 0.1847}, {-0.0001, -0.0307, 0.3617}, 0.0909}, "link_1"},
      {2, {{0.0001, 0.0016, 0.0398}, {-0.0004, -0.1402, 0.0000}, 0.0948}, "link_2"},
      {3, {{0.0001, -0.0001, 0.2446}, {0.0000, 0.0402, 0.4209}, 0.0796}, "link_3"},
      {4, {{0.0001, -0.0018, 0.0412}, {0.0002, 0.1451, 0.0007}, 0.0807}, "link_4"},
      {5, {{0.0000, 0.0001, 0.2094}, {-0.0008, -0.0312, 0.2533}, 0.0734}, "link_5"},
      {5, {{0.0002, -0.0662, 0.3317}, {0.0001, -0.0646, 0.4006}, 0.0530}, "link_5"},
      {6, {{0.0002, 0.0181, -0.0011}, {0.0003, -0.0231, -0.0008}, 0.0794}, "link_6"},
      {7, {{0.0000, -0.0004, 0.0875}, {0.0000, 0.0006, 0.0875}, 0.0533}, "link_7"},
  };
}

/// Kinova Gen3 with a spherical wrist and the vision module.
///
/// Meshes: robosuite 1.5.2, from Kinova's kortex_description, BSD-3-Clause.
[[nodiscard]] inline std::vector<LinkCapsule<>> gen3() {
  return {
      {0, {{-0.0045, 0.0000, 0.0149}, {0.0001, 0.0000, 0.1445}, 0.0528}, "base_link"},
      {1, {{0.0000, -0.0078, 0.0000}, {0.0000, 0.0000, 0.0958}, 0.0534}, "shoulder_link"},
      {2, {{0.0000, -0.0038, -0.0128}, {0.0000, 0.2129, 0.0001}, 0.0475}, "half_arm_1_link"},
      {3, {{0.0000, -0.0043, -0.0051}, {0.0000, 0.0000, 0.1806}, 0.0519}, "half_arm_2_link"},
      {4, {{0.0000, 0.1885, 0.0000}, {0.0000, -0.0033, -0.0138}, 0.0474}, "forearm_link"},
      {5, {{0.0000, -0.0129, 0.0000}, {0.0000, 0.0000, 0.0761}, 0.0431}, "spherical_wrist_1_link"},
      {6, {{0.0000, 0.1005, 0.0000}, {0.0000, 0.0010, -0.0195}, 0.0391}, "spherical_wrist_2_link"},
      {7, {{0.0305, -0.0524, 0.0053}, {-0.0305, -0.0525, 0.0052}, 0.0231}, "bracelet_link"},
      {7, {{0.0000, 0.0000, 0.0194}, {0.0000, 0.0000, 0.0307}, 0.0437}, "bracelet_link"},
  };
}

/// Universal Robots UR5e.
///
/// Meshes: airo-models 0.0.12, from Universal Robots' ur_description, BSD-3-Clause.
[[nodiscard]] inline std::vector<LinkCapsule<>> ur5e() {
  return {
      {0, {{0.0000, 0.0000, 0.0271}, {0.0000, 0.0000, 0.0436}, 0.0804}, "base_link_inertia"},
      {1, {{0.0000, -0.0146, 0.1620}, {0.0000, -0.0023, 0.1562}, 0.0834}, "shoulder_link"},
      {2, {{-0.0125, -0.0004, 0.1292}, {-0.4245, 0.0000, 0.1288}, 0.0898}, "upper_arm_link"},
      {3, {{-0.3868, 0.0001, 0.0093}, {0.0008, 0.0000, 0.0279}, 0.0664}, "forearm_link"},
      {4, {{0.0000, 0.0003, 0.1117}, {0.0000, -0.0014, 0.1326}, 0.0642}, "wrist_1_link"},
      {5, {{0.0001, -0.0075, 0.0961}, {-0.0002, 0.0098, 0.0987}, 0.0575}, "wrist_2_link"},
      {6, {{0.0000, 0.0008, 0.0722}, {-0.0004, -0.0020, 0.0716}, 0.0421}, "wrist_3_link"},
  };
}

/// Universal Robots UR10e.
///
/// Meshes: ur_description 2.4.5, from Universal Robots' ur_description, BSD-3-Clause.
[[nodiscard]] inline std::vector<LinkCapsule<>> ur10e() {
  return {
      {0, {{0.0000, 0.0000, 0.0324}, {0.0000, 0.0000, 0.0324}, 0.1006}, "base_link_inertia"},
      {1, {{0.0000, -0.0064, 0.1742}, {0.0000, -0.0130, 0.1804}, 0.1109}, "shoulder_link"},
      {2, {{-0.5785, -0.0002, 0.1601}, {0.0003, 0.0000, 0.1756}, 0.1103}, "upper_arm_link"},
      {3, {{-0.0002, 0.0000, 0.0552}, {-0.5709, 0.0000, 0.0478}, 0.0734}, "forearm_link"},
      {4, {{0.0000, 0.0004, 0.1602}, {0.0000, -0.0117, 0.1743}, 0.0708}, "wrist_1_link"},
      {5, {{0.0000, -0.0021, 0.1123}, {0.0000, 0.0204, 0.1193}, 0.0649}, "wrist_2_link"},
      {6, {{-0.0001, -0.0028, 0.0870}, {0.0000, 0.0008, 0.0876}, 0.0497}, "wrist_3_link"},
  };
}

}  // namespace fpbm::presets::capsules

/// Links of the presets whose capsules may overlap although the links never collide within the joint bounds, for the
/// last argument of Clearance. The two links of a pair are always at least 5 mm apart.
namespace fpbm::presets::never_collide {

using LinkNames = std::pair<std::string, std::string>;

[[nodiscard]] inline std::vector<LinkNames> panda() {
  return {{"panda_link5", "panda_link7"}};
}
[[nodiscard]] inline std::vector<LinkNames> fr3() {
  return {{"fr3_link5", "fr3_link7"}};
}
[[nodiscard]] inline std::vector<LinkNames> iiwa14() {
  return {{"link_5", "link_7"}};
}
[[nodiscard]] inline std::vector<LinkNames> gen3() {
  return {};
}
[[nodiscard]] inline std::vector<LinkNames> ur5e() {
  return {{"forearm_link", "wrist_2_link"}};
}
[[nodiscard]] inline std::vector<LinkNames> ur10e() {
  return {};
}

}  // namespace fpbm::presets::never_collide

namespace fpbm::presets {

/// Capsules of a preset by name, for programs that read the name at run time.
struct PresetCapsules {
  const char* name;
  std::vector<LinkCapsule<>> (*capsules)();
  std::vector<never_collide::LinkNames> (*never_collide)();
};
inline constexpr PresetCapsules kAllCapsules[] = {
    {"panda", capsules::panda, never_collide::panda},    {"fr3", capsules::fr3, never_collide::fr3},
    {"iiwa14", capsules::iiwa14, never_collide::iiwa14}, {"gen3", capsules::gen3, never_collide::gen3},
    {"ur5e", capsules::ur5e, never_collide::ur5e},       {"ur10e", capsules::ur10e, never_collide::ur10e}};

}  // namespace fpbm::presets
