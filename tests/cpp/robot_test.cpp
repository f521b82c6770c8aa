#include "fpbm/model/robot.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "support/arms.hpp"
#include "support/bodies.hpp"

/// Robots as trees: frames, J, J̇ and masses by Rodrigues' formula and rigid-body velocities, link by link.
namespace fpbm::test::robot_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;

[[nodiscard]] Transform<> random_placement(Random& random) {
  return {random.uniform(3, -0.4, 0.4), rotation(Vector<3>(random.uniform(3, -1.5, 1.5)))};
}

/// A random tree: some joints are prismatic, some follow others, and each joint is carried by any earlier link.
[[nodiscard]] Tree<> random_tree(Random& random, int joints, double branching, double following) {
  Tree<> tree;
  const auto chance = [&](double p) { return random.uniform(0.0, 1.0) < p; };
  const auto below = [&](int end) { return static_cast<int>(random.uniform(0.0, end - 1e-3)); };
  for (int i = 0; i < joints; ++i) {
    TreeJoint<> each;
    each.joint.type = chance(0.2) ? JointType::kPrismatic : chance(0.2) ? JointType::kContinuous : JointType::kRevolute;
    each.joint.placement = random_placement(random);
    each.joint.axis = chance(0.3) ? Vector<3>(Vector<3>::Unit(below(3))) : Vector<3>(random.uniform(3, -1.0, 1.0));
    each.joint.name = "j" + std::to_string(i);
    if (each.joint.type != JointType::kContinuous) {
      each.joint.bounds.lower = -3.0;
      each.joint.bounds.upper = 3.0;
    }
    each.parent = chance(branching) ? below(i + 1) : i;
    each.joint.moved = {random.uniform(0.1, 5.0), random.uniform(3, -0.3, 0.3)};
    tree.joints.push_back(each);
  }
  std::vector<int> drives;
  for (int i = 0; i < joints; ++i) {
    if (i > 0 && chance(following) && !drives.empty()) {
      const int leader = drives[static_cast<std::size_t>(below(static_cast<int>(drives.size())))];
      auto& joint = tree.joints[static_cast<std::size_t>(i)].joint;
      joint.mimic = {leader, random.uniform(-1.0, 1.0), random.uniform(-0.2, 0.2)};
      joint.bounds = {};
    } else {
      drives.push_back(i);
    }
  }
  for (int link = 0; link <= joints; ++link) {
    tree.frames.push_back({"f" + std::to_string(link), link, random_placement(random)});
  }
  return tree;
}

/// Positions of the joints, their frames after their motion, and velocities, link by link.
struct Textbook {
  std::vector<double> q;
  std::vector<double> qd;
  std::vector<Eigen::Index> drive;
  std::vector<Transform<>> frames = {Transform<>()};
  std::vector<Vector<3>> axes;  ///< Joint axes in the base frame.
  std::vector<Vector<3>> w = {Vector<3>::Zero()};
  std::vector<Vector<3>> v = {Vector<3>::Zero()};  ///< Velocities of the origins of the frames.

  Textbook(const Tree<>& tree, const Vector<kOpen>& drives, const Vector<kOpen>& rates) : drive(tree.joints.size()) {
    Eigen::Index k = 0;
    for (std::size_t i = 0; i < drive.size(); ++i) drive[i] = tree.joints[i].joint.mimic.joint < 0 ? k++ : -1;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      const auto& [joint, parent] = tree.joints[i];
      const auto& [leader, ratio, offset] = joint.mimic;
      if (leader >= 0) drive[i] = drive[static_cast<std::size_t>(leader)];
      q.push_back(leader < 0 ? drives(drive[i]) : ratio * drives(drive[i]) + offset);
      qd.push_back(leader < 0 ? rates(drive[i]) : ratio * rates(drive[i]));
      const Vector<3> axis = joint.axis.normalized();
      Transform<> moving;
      const bool slides = joint.type == JointType::kPrismatic;
      if (slides) {
        moving.p = q[i] * axis;
      } else {
        moving.R = Eigen::AngleAxisd(q[i], Eigen::Vector3d(axis)).toRotationMatrix();
      }
      const Transform<> on = frames[static_cast<std::size_t>(parent)];
      frames.push_back(on * joint.placement * moving);
      axes.emplace_back(frames.back().R * axis);
      const Vector<3> turning = w[static_cast<std::size_t>(parent)];
      v.push_back(v[static_cast<std::size_t>(parent)] + cross<double>(turning, frames.back().p - on.p));
      w.push_back(turning);
      (slides ? v : w).back() += qd[i] * axes.back();
    }
  }
};

struct Errors {
  double frame = 0.0;
  double J = 0.0;
  double Jd = 0.0;
};

/// Errors of all frames of a robot, and of the Jacobians of their origins.
template <int N, int Joints>
void compare(const Robot<N, double, Joints>& robot, const Tree<>& tree, Random& random, Errors& errors) {
  const Vector<N> q = random.uniform(robot.dof(), -2.5, 2.5);
  const Vector<N> qd = random.uniform(robot.dof(), -1.0, 1.0);
  typename Robot<N, double, Joints>::State state;
  robot.update(q, qd, state);
  const Textbook expected(tree, q, qd);
  for (const auto& [name, link, offset] : tree.frames) {
    const Transform<> at = robot.frame(state, link, robot.in_joint(link, offset));
    const auto number = static_cast<std::size_t>(link);
    const Transform<> frame = expected.frames[number] * offset;
    errors.frame = std::max(errors.frame, (at.p - frame.p).norm() + (at.R - frame.R).norm());
    Matrix<6, N> J;
    Matrix<6, N> Jd;
    robot.jacobian(state, link, at.p, J, Jd);
    Matrix<6, N> columns = Matrix<6, N>::Zero(6, robot.dof());
    Matrix<6, N> rates = columns;
    const Vector<3> v = expected.v[number] + cross<double>(expected.w[number], frame.p - expected.frames[number].p);
    for (int i = link; i > 0; i = tree.joints[static_cast<std::size_t>(i - 1)].parent) {
      const auto k = static_cast<std::size_t>(i - 1);
      const auto& joint = tree.joints[k].joint;
      const double ratio = joint.mimic.joint < 0 ? 1.0 : joint.mimic.ratio;
      const Vector<3>& z = expected.axes[k];
      const Vector<3> turning = cross(expected.w[k + 1], z);
      const Vector<3> arm = frame.p - expected.frames[k + 1].p;
      const Eigen::Index column = expected.drive[k];
      if (joint.type == JointType::kPrismatic) {
        columns.template block<3, 1>(0, column) += ratio * z;
        rates.template block<3, 1>(0, column) += ratio * turning;
        continue;
      }
      columns.template block<3, 1>(0, column) += ratio * cross(z, arm);
      columns.template block<3, 1>(3, column) += ratio * z;
      rates.template block<3, 1>(0, column) += ratio * (cross(turning, arm) + cross<double>(z, v - expected.v[k + 1]));
      rates.template block<3, 1>(3, column) += ratio * turning;
    }
    errors.J = std::max(errors.J, (J - columns).cwiseAbs().maxCoeff());
    errors.Jd = std::max(errors.Jd, (Jd - rates).cwiseAbs().maxCoeff());
    EXPECT_LT((robot.angular_velocity(state, link) - expected.w[number]).norm(), 1e-12);
  }
}

TEST(Tree, has_the_kinematics_of_its_links) {
  Errors errors;
  for (int seed = 0; seed < trials(1000); ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint32_t>(seed));
    const int joints = 1 + static_cast<int>(random.uniform(0.0, seed % 20 == 0 ? kMaxDof : 16));
    const Tree<> tree = random_tree(random, joints, seed % 3 * 0.3, seed % 2 * 0.3);
    const Robot<kOpen> robot(tree);
    compare(robot, tree, random, errors);
  }
  std::printf("  1,000 random trees: frames %.1e, J %.1e, Jd %.1e\n", errors.frame, errors.J, errors.Jd);
  EXPECT_LT(errors.frame, 1e-12);
  EXPECT_LT(errors.J, 1e-12);
  EXPECT_LT(errors.Jd, 2e-12 * kMaxDof);
}

/// Two Pandas side by side, with sizes known at compile time.
TEST(Tree, of_fixed_size_is_that_of_run_time_size) {
  const Tree<> tree = two_pandas(false);
  Errors errors;
  Random random(1);
  const Robot<14> robot(tree);
  const Robot<kOpen> open(tree);
  EXPECT_EQ(robot.length(), open.length());
  EXPECT_NEAR(robot.length(), Robot<7>(presets::panda()).length(), 1e-12);
  for (int trial = 0; trial < trials(100); ++trial) {
    compare(robot, tree, random, errors);
    compare(open, tree, random, errors);
  }
  EXPECT_LT(std::max({errors.frame, errors.J, errors.Jd}), 1e-12);
}

TEST(Tree, names_the_invalid_argument) {
  const auto refusal = [](auto change) {
    Tree<> tree = two_pandas(true);
    change(tree);
    return complaint([&] { Robot<kOpen>{tree}; });
  };
  EXPECT_EQ(refusal([](Tree<>& tree) { tree.joints[3].parent = 4; }),
            "joint 'right_panda_joint2'.parent = 4: must be the number of the parent link, at most 3");
  EXPECT_EQ(refusal([](Tree<>& tree) { tree.joints[3].joint.axis.setZero(); }),
            "joint 'right_panda_joint2'.axis is zero: must be a nonzero vector");
  EXPECT_EQ(refusal([](Tree<>& tree) { tree.joints[3].joint.moved.mass = -1.0; }),
            "joint 'right_panda_joint2'.moved.mass = -1: must be finite and not negative");
  EXPECT_EQ(refusal([](Tree<>& tree) { tree.frames[1].link = 17; }),
            "frames[1].link = 17: must be the number of a link, at most 16");
  EXPECT_EQ(refusal([](Tree<>& tree) { tree.joints[5].joint.mimic.joint = 40; }),
            "joint 'right_panda_joint4'.mimic.joint = 40: must be the index of a joint with its own drive");
  EXPECT_EQ(complaint([] { Robot<7>{two_pandas(true)}; }), "joints has 16 entries: must have 7, one per joint");
}

}  // namespace
}  // namespace fpbm::test::robot_laws
