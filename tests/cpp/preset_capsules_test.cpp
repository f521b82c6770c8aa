#include "fpbm/bound/preset_capsules.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "fpbm/model/detail/robot_presets.hpp"
#include "fpbm/model/presets.hpp"

/// Capsules of the arms of presets.hpp: on every link, apart in the home postures, and not too large.
/// tests/python/test_preset_capsules.py checks that they contain the links.
namespace fpbm::test::preset_capsules_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct Case {
  std::string name;
  Chain<> chain;
  std::vector<LinkCapsule<>> capsules;
  std::vector<presets::never_collide::LinkNames> never_collide;
};

std::vector<Case> every_preset() {
  std::vector<Case> cases;
  for (const presets::Preset& arm : presets::kAll) {
    for (const presets::PresetCapsules& its : presets::kAllCapsules) {
      if (std::string(arm.name) == its.name)
        cases.push_back({arm.name, arm.chain(), its.capsules(), its.never_collide()});
    }
  }
  return cases;
}

/// Start postures of manufacturers and planners in degrees: Franka's ready posture, the home postures of KUKA, Kinova
/// and UR, and the posture in the manuals of UR.
std::vector<Vector<kOpen>> homes(const std::string& name) {
  const auto all = [](const std::vector<Vector<7>>& postures) {
    return std::vector<Vector<kOpen>>(postures.begin(), postures.end());
  };
  if (name == "panda" || name == "fr3") return all({{0.0, -45.0, 0.0, -135.0, 0.0, 90.0, 45.0}});
  if (name == "iiwa14") return all({Vector<7>::Zero(), {0.0, 45.0, 0.0, -90.0, 0.0, 45.0, 0.0}});
  if (name == "gen3")
    return all({{0.0, 15.0, 180.0, -130.0, 0.0, 55.0, 90.0}, {0.0, -20.0, 180.0, -145.0, 0.0, -60.0, 90.0}});
  return {Vector<6>(0.0, -90.0, 0.0, -90.0, 0.0, 0.0), Vector<6>(0.0, -90.0, 90.0, -90.0, -90.0, 0.0)};
}

std::size_t links_named(const std::vector<LinkCapsule<>>& capsules, const std::string& name) {
  return static_cast<std::size_t>(
      std::count_if(capsules.begin(), capsules.end(), [&](const LinkCapsule<>& each) { return each.name == name; }));
}

TEST(PresetCapsules, are_on_every_link) {
  const std::vector<Case> cases = every_preset();
  EXPECT_EQ(cases.size(), std::size(presets::kAllCapsules));
  for (const auto& [name, chain, capsules, never_collide] : cases) {
    std::multiset<int> links;
    for (const LinkCapsule<>& each : capsules) {
      links.insert(each.link);
      EXPECT_FALSE(each.name.empty());
      EXPECT_GT(each.capsule.radius, 0.02) << name << ' ' << each.name;
      EXPECT_LT(each.capsule.radius, 0.14) << name << ' ' << each.name;
    }
    for (const auto& [first, second] : never_collide) {
      EXPECT_EQ(Clearance<kOpen>(chain, capsules, {}, 0.0).pairs().size(),
                Clearance<kOpen>(chain, capsules, {}, 0.0, {{first, second}}).pairs().size() +
                    links_named(capsules, first) * links_named(capsules, second));
    }
    for (int link = 0; link <= static_cast<int>(chain.joints.size()); ++link) {
      EXPECT_TRUE(links.count(link) == 1 || links.count(link) == 2) << name << ' ' << link;
    }
    EXPECT_EQ(std::set<int>(links.begin(), links.end()).size(), chain.joints.size() + 1) << name;
  }
}

TEST(PresetCapsules, no_pair_overlaps_in_all_postures_and_none_at_home) {
  for (const auto& [name, chain, capsules, never_collide] : every_preset()) {
    Clearance<kOpen> clearance(chain, capsules, {}, 0.0, never_collide);
    for (const ShapePair& pair : clearance.excluded_pairs()) {
      const auto [first, second] = clearance.names(pair);
      ADD_FAILURE() << name << ": " << first << " and " << second << " overlap in all postures";
    }
    for (const Vector<kOpen>& home : homes(name)) {
      const auto [pair, distance] = clearance.nearest_pair(kDegree * home);
      const auto [first, second] = clearance.names(clearance.pairs()[pair]);
      EXPECT_GT(distance, 1e-3) << name << " at " << home.transpose() << ": " << first << " and " << second;
    }
  }
}

/// Capsules of adjacent links touch. With a gap at the joint, an obstacle could pass between the links.
TEST(PresetCapsules, neighbours_touch) {
  for (const Case& arm : every_preset()) {
    const Robot<kOpen> robot(arm.chain);
    RobotState<kOpen> state;
    robot.update(Vector<kOpen>::Zero(robot.dof()), state);
    const auto at_zero = [&](const LinkCapsule<>& each) {
      return placed(each.capsule, robot.frame(state, each.link, robot.in_joint(each.link, {})));
    };
    std::vector<double> least(arm.chain.joints.size(), 1.0);
    for (const LinkCapsule<>& one : arm.capsules) {
      for (const LinkCapsule<>& two : arm.capsules) {
        if (two.link != one.link + 1) continue;
        double& gap = least[static_cast<std::size_t>(one.link)];
        gap = std::min(gap, nearest(at_zero(one), at_zero(two)).distance);
      }
    }
    EXPECT_LT(*std::max_element(least.begin(), least.end()), 0.0) << arm.name;
  }
}

TEST(PresetCapsules, two_pandas_have_those_of_each_arm) {
  Clearance<14> both(presets::two_pandas(), presets::capsules::two_pandas(), {}, 0.0,
                     presets::never_collide::two_pandas());
  Clearance<7> one(presets::panda(), presets::capsules::panda(), {}, 0.0, presets::never_collide::panda());
  EXPECT_TRUE(both.excluded_pairs().empty());
  const std::size_t count = one.bodies().size();
  ASSERT_EQ(both.bodies().size(), 2 * count);
  auto placed = both.placement();
  auto placed_alone = one.placement();
  for (int k = 0; k < 20; ++k) {
    const Vector<14> q = spread_posture(both.robot().limits(), k);
    both.place(q, placed);
    for (const std::size_t arm : {0U, 1U}) {
      one.place(arm == 0 ? Vector<7>(q.head<7>()) : Vector<7>(q.tail<7>()), placed_alone);
      const Vector<3> place(0.0, arm == 0 ? -0.4 : 0.4, 0.0);
      for (std::size_t i = 0; i < count; ++i) {
        const auto& [moved, alone] = std::tie(placed.bodies[count * arm + i], placed_alone.bodies[i]);
        EXPECT_LT((moved.a - alone.a - place).norm() + (moved.b - alone.b - place).norm(), 1e-12);
        EXPECT_EQ(both.bodies()[count * arm + i].name, (arm == 0 ? "right_" : "left_") + one.bodies()[i].name);
      }
    }
  }
  for (const ShapePair& pair : one.pairs()) {
    for (const std::string arm : {"right_", "left_"}) {
      const auto [first, second] = one.names(pair);
      const auto is = [&, first = first, second = second](const ShapePair& its) {
        return both.names(its) == Clearance<14>::Names(arm + first, arm + second);
      };
      EXPECT_TRUE(std::any_of(both.pairs().begin(), both.pairs().end(), is)) << arm << first << " and " << second;
    }
  }
}

}  // namespace
}  // namespace fpbm::test::preset_capsules_laws
