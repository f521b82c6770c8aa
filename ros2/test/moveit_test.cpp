// Tests the plugin for MoveIt on models of presets. Prints the measured values, and fails if a value is not as
// promised.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <fpbm/geometry/rotation.hpp>
#include <fpbm/model/presets.hpp>
#include <fpbm/model/serial_arm.hpp>
#include <moveit/kinematics_base/kinematics_base.hpp>
#include <random>
#include <string>
#include <vector>

namespace {

using geometry_msgs::msg::Pose;
using kinematics::KinematicsBase;
using moveit_msgs::msg::MoveItErrorCodes;
using Numbers = std::vector<double>;

int failures = 0;

void check(bool good, const std::string& what, double value) {
  std::printf("%-4s %-66s %.3g\n", good ? "ok" : "FAIL", what.c_str(), value);
  if (!good) ++failures;
}

/// The model of a chain: root "base_link", link "base" with a displacement, links of the joints, and link "flange".
struct Model {
  explicit Model(const fpbm::Chain<>& chain) {
    robot.links["base_link"].name = "base_link";
    fpbm::Transform<> displaced;
    displaced.p = {0.1, 0.2, 0.3};
    add("base", "base_link", displaced);
    std::string parent = "base";
    for (const auto& joint : chain.joints) {
      add("link_of_" + joint.name, parent, joint.placement).joint = made(joint);
      robot.groups["arm"].names.push_back(joint.name);
      parent = "link_of_" + joint.name;
    }
    add("flange", parent, chain.tip);
  }

  moveit::core::LinkModel& add(const std::string& name, const std::string& parent, const fpbm::Transform<>& origin) {
    moveit::core::LinkModel& link = robot.links[name];
    link.name = name;
    link.parent = &robot.links.at(parent);
    link.joint = &fixed_;
    link.origin.linear() = origin.R;
    link.origin.translation() = origin.p;
    return link;
  }

  moveit::core::RobotModel robot;
  std::deque<moveit::core::RevoluteJointModel> joints;

 private:
  const moveit::core::JointModel* made(const fpbm::Joint<>& joint) {
    auto& model = joints.emplace_back();
    model.name = joint.name;
    model.type = moveit::core::JointModel::REVOLUTE;
    model.axis = joint.axis;
    const bool bounded = joint.type != fpbm::JointType::kContinuous;
    model.bounds = {{bounded ? joint.bounds.lower : -3.14, bounded ? joint.bounds.upper : 3.14, bounded}};
    return &model;
  }

  moveit::core::JointModel fixed_;
};

struct Plugin {
  explicit Plugin(const fpbm::Chain<>& chain) : model(chain) {}

  bool initialize(const std::string& base = "base", const std::vector<std::string>& tips = {"flange"},
                  const std::string& group = "arm") {
    return solver->initialize(nullptr, model.robot, group, base, tips, 0.1);
  }
  [[nodiscard]] Pose tip(const Numbers& q) const {
    std::vector<Pose> poses;
    return solver->getPositionFK({"flange"}, q, poses) ? poses.at(0) : Pose{};
  }

  Model model;
  std::unique_ptr<KinematicsBase> solver = stand_in::exported_plugin();
};

double distance(const Pose& a, const Pose& b) {
  const double dot = a.orientation.x * b.orientation.x + a.orientation.y * b.orientation.y +
                     a.orientation.z * b.orientation.z + a.orientation.w * b.orientation.w;
  return std::max({std::abs(a.position.x - b.position.x), std::abs(a.position.y - b.position.y),
                   std::abs(a.position.z - b.position.z), 2.0 * std::sqrt(std::max(2.0 - 2.0 * std::abs(dot), 0.0))});
}

double distance(const Numbers& a, const Numbers& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

Numbers random_posture(const Model& model, std::mt19937& random) {
  Numbers q;
  for (const auto& joint : model.joints) {
    const auto& bounds = joint.bounds[0];
    q.push_back(std::uniform_real_distribution<double>(bounds.min_position_, bounds.max_position_)(random));
  }
  return q;
}

/// Poses of the tip, and postures for random reachable poses.
void postures(const std::string& name, const fpbm::Chain<>& chain) {
  Plugin plugin(chain);
  check(plugin.initialize() && plugin.solver->getJointNames().size() == chain.joints.size(), name + ": initialised", 1);
  const fpbm::SerialArm<Eigen::Dynamic> arm(chain);
  std::mt19937 random(1);
  const int count = 200;
  int solved = 0;
  int from_seed = 0;
  double error = 0.0;
  double forward = 0.0;
  double beyond = 0.0;
  for (int i = 0; i < count; ++i) {
    const Numbers q = random_posture(plugin.model, random);
    const Pose target = plugin.tip(q);
    fpbm::Kinematics<fpbm::Pose, Eigen::Dynamic> kinematics;
    arm.kinematics(Eigen::Map<const Eigen::VectorXd>(q.data(), arm.dof()), kinematics);
    const fpbm::Vector<4> turn = fpbm::quaternion(kinematics.tip.R);
    forward = std::max(forward, distance(target, Pose{{kinematics.tip.p(0), kinematics.tip.p(1), kinematics.tip.p(2)},
                                                      {turn(1), turn(2), turn(3), turn(0)}}));
    Numbers solution;
    MoveItErrorCodes code;
    const Numbers seed = random_posture(plugin.model, random);
    if (plugin.solver->getPositionIK(target, seed, solution, code)) ++from_seed;
    if (!plugin.solver->searchPositionIK(target, seed, 1.0, solution, code)) continue;
    solved += code.val == MoveItErrorCodes::SUCCESS ? 1 : 0;
    error = std::max(error, distance(plugin.tip(solution), target));
    for (std::size_t k = 0; k < solution.size(); ++k) {
      const auto& bounds = plugin.model.joints[k].bounds[0];
      if (!bounds.position_bounded_) continue;
      beyond = std::max({beyond, solution[k] - bounds.max_position_, bounds.min_position_ - solution[k]});
    }
  }
  check(forward < 1e-7, name + ": distance of the tip from the tip of the chain [m, rad]", forward);
  check(solved == count, name + ": share of solved poses", double(solved) / count);
  check(from_seed > 0 && from_seed < count, name + ": share of poses solved from the seed alone",
        double(from_seed) / count);
  check(error < 4e-6, name + ": largest distance from a pose [m, rad]",
        error);  // Four times the tolerance: quaternions.
  check(beyond == 0.0, name + ": position beyond a range [rad]", beyond);
}

/// Calls with a seed, consistency limits and a callback.
void searches() {
  Plugin plugin(fpbm::presets::panda());
  plugin.initialize();
  const KinematicsBase& solver = *plugin.solver;
  std::mt19937 random(2);
  const Numbers seed{0.1, -0.3, 0.2, -2.2, 0.1, 2.0, 0.785};
  Numbers near = seed;
  for (double& q : near) q += 0.05;
  const Pose target = plugin.tip(near);
  Numbers solution;
  MoveItErrorCodes code;
  bool found = solver.getPositionIK(plugin.tip(seed), seed, solution, code);
  check(found && distance(solution, seed) < 1e-5, "getPositionIK: distance from a seed at the pose [rad]",
        distance(solution, seed));

  int kept = 0;
  double farthest = 0.0;
  for (int i = 0; i < 50; ++i) {
    const Numbers q = random_posture(plugin.model, random);
    Numbers other = q;
    for (std::size_t k = 0; k < 7; ++k) {
      const auto& bounds = plugin.model.joints[k].bounds[0];
      other[k] = std::min(std::max(q[k] + (k % 2 == 0 ? 0.3 : -0.3), bounds.min_position_), bounds.max_position_);
    }
    if (!solver.searchPositionIK(plugin.tip(other), q, 1.0, Numbers(7, 0.31), solution, code)) continue;
    ++kept;
    farthest = std::max(farthest, distance(solution, q));
  }
  check(kept == 50 && farthest <= 0.31 + 1e-12, "consistency: distance from the seed [rad]", farthest);
  found = solver.searchPositionIK(target, seed, 1.0, Numbers(7, 0.001), solution, code);
  check(!found && code.val == MoveItErrorCodes::NO_IK_SOLUTION, "consistency: unreachable within narrow limits",
        code.val);

  std::vector<Numbers> seen;
  const auto third = [&](const Pose&, const Numbers& q, MoveItErrorCodes& given) {
    seen.push_back(q);
    given.val = seen.size() < 3 ? MoveItErrorCodes::GOAL_IN_COLLISION : MoveItErrorCodes::SUCCESS;
  };
  found = solver.searchPositionIK(target, seed, 1.0, solution, third, code);
  check(found && seen.size() == 3 && solution == seen[2] && seen[0] != seen[1] &&
            distance(plugin.tip(solution), target) < 4e-6,
        "callback: the third posture is accepted", double(seen.size()));
  int calls = 0;
  const auto never = [&](const Pose&, const Numbers&, MoveItErrorCodes& given) {
    ++calls;
    given.val = MoveItErrorCodes::GOAL_IN_COLLISION;
  };
  found = solver.searchPositionIK(target, seed, 0.1, {}, solution, never, code);
  check(!found && code.val == MoveItErrorCodes::TIMED_OUT && calls > 256, "callback: postures until the timeout",
        calls);
  calls = 0;
  (void)solver.searchPositionIK(target, seed, 0.0, {}, solution, never, code);
  check(calls == 1, "callback: one posture without time", calls);

  Pose far = target;
  far.position.x = 9.0;
  found = solver.searchPositionIK(far, seed, 60.0, solution, code);
  check(!found && code.val == MoveItErrorCodes::NO_IK_SOLUTION, "unreachable: no posture, before the timeout",
        code.val);
  kinematics::KinematicsQueryOptions approximate;
  approximate.return_approximate_solution = true;
  found = solver.searchPositionIK(far, seed, 1.0, solution, code, approximate);
  check(found && plugin.tip(solution).position.x > 0.7, "unreachable: x of the nearest posture [m]",
        plugin.tip(solution).position.x);

  Pose bad = target;
  bad.orientation = {0.0, 0.0, 0.0, 0.0};
  check(!solver.searchPositionIK(bad, seed, 1.0, solution, code, approximate), "rejected: a quaternion of length 0", 0);
  check(!solver.searchPositionIK(target, {0.0}, 1.0, solution, code), "rejected: a seed with one number", 1);
  check(!solver.searchPositionIK(target, Numbers(7, NAN), 1.0, solution, code, approximate), "rejected: a seed of NaN",
        0);
  check(!solver.searchPositionIK(target, seed, 1.0, Numbers(3, 1.0), solution, code), "rejected: three limits", 3);
  std::vector<Pose> poses;
  check(!solver.getPositionFK({"flange", "base"}, seed, poses), "rejected: pose of another link", 0);
}

/// Groups that the plugin accepts or rejects.
void groups() {
  const fpbm::Chain<> chain = fpbm::presets::panda();
  Plugin plugin(chain);
  check(plugin.initialize("base_link") && plugin.initialize("base"), "accepted: other links before the first joint", 1);
  check(!plugin.initialize("base", {"flange", "base"}), "rejected: two tips", 2);
  check(!plugin.initialize("hand"), "rejected: base is not a link", 0);
  check(!plugin.initialize("flange"), "rejected: base is the tip", 0);
  check(!plugin.initialize("base", {"flange"}, "gripper"), "rejected: unknown group", 0);
  check(!plugin.initialize("link_of_" + chain.joints[1].name), "rejected: base after a joint of the group", 0);
  Numbers solution;
  MoveItErrorCodes code;
  check(!plugin.solver->searchPositionIK(Pose{}, Numbers(5, 0.0), 1.0, solution, code), "rejected: not initialised", 0);
  plugin.model.joints[3].mimic = &plugin.model.joints[2];
  check(!plugin.initialize(), "rejected: a mimic joint", 0);
  Plugin floating(chain);
  moveit::core::JointModel free;
  free.name = "world_joint";
  free.type = moveit::core::JointModel::FLOATING;
  floating.model.robot.links.at("base").joint = &free;
  check(!floating.initialize("base_link"), "rejected: a floating joint", 0);
  Plugin world(chain);
  moveit::core::JointModel virtual_joint;
  world.model.robot.links.at("base_link").joint = &virtual_joint;
  check(world.initialize("world"), "accepted: the frame of the model as base", 1);
}

}  // namespace

int main() {
  postures("panda", fpbm::presets::panda());
  postures("ur5e", fpbm::presets::ur5e());
  postures("gen3", fpbm::presets::gen3());
  postures("so101", fpbm::presets::so101());
  searches();
  groups();
  return failures == 0 ? 0 : 1;
}
