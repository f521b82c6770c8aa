#include "fpbm/model/dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "fpbm/model/presets.hpp"
#include "support/expect_refused.hpp"
#include "support/random_tree.hpp"

/// Dynamics of random chains and trees: energies and M from the Jacobians of the centres of mass, torques from
/// differences of energies.
namespace fpbm::test::dynamics_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
using Open = Vector<kOpen>;
using OpenMatrix = Matrix<kOpen, kOpen>;

/// Gravity that is along no axis [m/s²].
[[nodiscard]] Vector<3> tilted_gravity() {
  return {1.5, -2.5, -9.0};
}

/// Energies and M of a tree, link by link.
class Textbook {
 public:
  Textbook(Tree<> tree, const Vector<3>& gravity) : tree_(std::move(tree)), gravity_(gravity) {
    const auto joints = static_cast<Eigen::Index>(tree_.joints.size());
    Eigen::Index drives = 0;
    std::vector<Eigen::Index> drive;
    for (const auto& [joint, parent] : tree_.joints) drive.push_back(joint.mimic.joint < 0 ? drives++ : -1);
    by_drive_.setZero(joints, drives);
    offset_.setZero(joints);
    for (Eigen::Index i = 0; i < joints; ++i) {
      const auto& [leader, ratio, offset] = joint(i).mimic;
      by_drive_(i, drive[static_cast<std::size_t>(leader < 0 ? i : leader)]) = leader < 0 ? 1.0 : ratio;
      if (leader >= 0) offset_(i) = offset;
    }
  }

  [[nodiscard]] Eigen::Index dof() const { return by_drive_.cols(); }

  [[nodiscard]] Eigen::MatrixXd mass_matrix(const Eigen::VectorXd& q) const {
    const Eigen::Index joints = by_drive_.rows();
    const auto frames = frames_at(q);
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(joints, joints);
    for (Eigen::Index link = 1; link <= joints; ++link) {
      const auto& [mass, centre, inertia] = joint(link - 1).moved;
      const Transform<>& at = frames[static_cast<std::size_t>(link)];
      const Eigen::Vector3d c = at.p + at.R * centre;
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, joints);
      for (Eigen::Index i = link; i > 0; i = tree_.joints[static_cast<std::size_t>(i - 1)].parent) {
        const Transform<>& moving = frames[static_cast<std::size_t>(i)];
        const Eigen::Vector3d axis = moving.R * joint(i - 1).axis.normalized();
        const bool slides = joint(i - 1).type == JointType::kPrismatic;
        J.col(i - 1) << (slides ? axis : Eigen::Vector3d(axis.cross(c - moving.p))),
            (slides ? Eigen::Vector3d::Zero() : axis);
      }
      const Eigen::Matrix3d rotated = at.R * inertia * at.R.transpose();
      M += mass * J.topRows(3).transpose() * J.topRows(3) + J.bottomRows(3).transpose() * rotated * J.bottomRows(3);
      M(link - 1, link - 1) += joint(link - 1).drive.rotor_inertia;
    }
    return by_drive_.transpose() * M * by_drive_;
  }

  [[nodiscard]] double potential_energy(const Eigen::VectorXd& q) const {
    const auto frames = frames_at(q);
    double energy = 0.0;
    for (std::size_t link = 1; link < frames.size(); ++link) {
      const auto& [mass, centre, inertia] = tree_.joints[link - 1].joint.moved;
      energy -= mass * gravity_.dot(Vector<3>(frames[link].p + frames[link].R * centre));
    }
    return energy;
  }

  /// C(q, q̇) q̇ = Ṁ q̇ − ∂T/∂q.
  [[nodiscard]] Eigen::VectorXd coriolis(const Eigen::VectorXd& q, const Eigen::VectorXd& qd) const {
    Eigen::VectorXd result = slope([&](double t) -> Eigen::VectorXd { return mass_matrix(q + t * qd) * qd; });
    for (Eigen::Index i = 0; i < dof(); ++i) {
      result(i) -= slope([&](double t) -> Eigen::VectorXd {
        const Eigen::VectorXd moved = q + t * Eigen::VectorXd::Unit(dof(), i);
        return Eigen::VectorXd::Constant(1, 0.5 * qd.dot(mass_matrix(moved) * qd));
      })(0);
    }
    return result;
  }
  /// ∂U/∂q.
  [[nodiscard]] Eigen::VectorXd gravity_torque(const Eigen::VectorXd& q) const {
    Eigen::VectorXd result(dof());
    for (Eigen::Index i = 0; i < dof(); ++i) {
      result(i) = slope([&](double t) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(1, potential_energy(q + t * Eigen::VectorXd::Unit(dof(), i)));
      })(0);
    }
    return result;
  }
  [[nodiscard]] Eigen::VectorXd viscous_torque(const Eigen::VectorXd& qd) const {
    Eigen::VectorXd torque = by_drive_ * qd;
    for (Eigen::Index i = 0; i < torque.size(); ++i) torque(i) *= joint(i).drive.viscous;
    return by_drive_.transpose() * torque;
  }

  /// Derivative at 0 by the five-point formula: the error is some 1e-10 of the function.
  template <typename F>
  [[nodiscard]] static Eigen::VectorXd slope(const F& f) {
    constexpr double kStep = 1e-3;
    return (f(-2 * kStep) - 8.0 * f(-kStep) + 8.0 * f(kStep) - f(2 * kStep)) / (12.0 * kStep);
  }

 private:
  [[nodiscard]] const Joint<>& joint(Eigen::Index i) const { return tree_.joints[static_cast<std::size_t>(i)].joint; }

  [[nodiscard]] std::vector<Transform<>> frames_at(const Eigen::VectorXd& drives) const {
    const Eigen::VectorXd q = by_drive_ * drives + offset_;
    std::vector<Transform<>> frames(1);
    for (std::size_t i = 0; i < tree_.joints.size(); ++i) {
      const auto& [each, parent] = tree_.joints[i];
      const Eigen::Vector3d axis = each.axis.normalized();
      Transform<> moving;
      const double by = q(static_cast<Eigen::Index>(i));
      if (each.type == JointType::kPrismatic) {
        moving.p = by * axis;
      } else {
        moving.R = Eigen::AngleAxisd(by, axis).toRotationMatrix();
      }
      frames.push_back(frames[static_cast<std::size_t>(parent)] * each.placement * moving);
    }
    return frames;
  }

  Tree<> tree_;
  Vector<3> gravity_;
  Eigen::MatrixXd by_drive_;
  Eigen::VectorXd offset_;
};

template <typename A, typename B>
[[nodiscard]] double relative(const A& a, const B& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1e-3, b.cwiseAbs().maxCoeff());
}

/// All laws for one robot in random states.
template <int N, int Joints>
void expect_laws(const Tree<>& tree, Random& random) {
  const Dynamics<N, double, Joints> dynamics(tree, tilted_gravity());
  const Textbook textbook(tree, tilted_gravity());
  ASSERT_EQ(dynamics.dof(), textbook.dof());
  typename Dynamics<N, double, Joints>::State state;
  const Vector<N> q = random.uniform(dynamics.dof(), -2.5, 2.5);
  const Vector<N> qd = random.uniform(dynamics.dof(), -2.0, 2.0);
  const Vector<N> qdd = random.uniform(dynamics.dof(), -5.0, 5.0);
  dynamics.robot().update(q, qd, state);
  const Eigen::MatrixXd M = dynamics.mass_matrix(state);
  const Eigen::VectorXd h = dynamics.bias(state);
  const Eigen::VectorXd g = dynamics.gravity_torque(state);
  const Eigen::VectorXd torque = dynamics.inverse_dynamics(state, qdd);

  EXPECT_LT(relative(M, textbook.mass_matrix(q)), 1e-13);
  EXPECT_EQ(M, M.transpose());
  EXPECT_GT(M.llt().matrixL().determinant(), 0.0);
  EXPECT_LT(relative(Eigen::VectorXd(M * qdd + h), torque), 1e-12);
  EXPECT_LT(relative(g, textbook.gravity_torque(q)), 1e-8);
  EXPECT_LT(relative(Eigen::VectorXd(textbook.coriolis(q, qd) + g + textbook.viscous_torque(qd)), h), 1e-8);

  const double kinetic = 0.5 * qd.dot(textbook.mass_matrix(q) * qd);
  EXPECT_NEAR(dynamics.kinetic_energy(state), kinetic, 1e-12 * kinetic);
  EXPECT_NEAR(dynamics.potential_energy(state), textbook.potential_energy(q), 1e-12 * (1.0 + M.trace()));

  // Power: d/dt (T + U) = q̇ᵀτ − friction. Equivalent to the skew symmetry of Ṁ − 2C.
  const double power = Textbook::slope([&](double t) {
    typename Dynamics<N, double, Joints>::State moved;
    dynamics.robot().update(q + t * qd + t * t / 2.0 * qdd, qd + t * qdd, moved);
    return Eigen::VectorXd::Constant(1, dynamics.kinetic_energy(moved) + dynamics.potential_energy(moved));
  })(0);
  EXPECT_NEAR(power, qd.dot(torque - textbook.viscous_torque(qd)), 1e-7 * (1.0 + qd.norm() * torque.norm()));

  // A robot at rest: h is g. The state may come from q alone.
  dynamics.robot().update(q, state);
  EXPECT_LT(relative(Eigen::VectorXd(dynamics.bias(state)), g), 1e-12);
}

TEST(Dynamics, follows_from_the_energies_of_random_chains_and_trees) {
  const Kind kinds[] = {{}, {0.3, 0.0, 0.0}, {0.0, 0.4, 0.0}, {0.3, 0.3, 0.0}, {0.3, 0.3, 0.3}, {0.0, 0.0, 0.3}};
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(120)); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int joints = 1 + static_cast<int>(seed % 12);
    expect_laws<kOpen, kOpen>(random_tree(random, joints, kinds[seed % 6]), random);
  }
}

TEST(Dynamics, follows_from_the_energies_with_sizes_at_compile_time) {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(trials(10)); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    expect_laws<7, 7>(random_tree(random, 7, {}), random);
    expect_laws<9, 9>(random_tree(random, 9, {0.4, 0.2, 0.0}), random);
    Tree<> geared = random_tree(random, 7, {0.3, 0.2, 0.0});
    geared.joints[3].joint.mimic = {1, 0.5, 0.1};
    geared.joints[6].joint.mimic = {0, -1.5, 0.0};
    expect_laws<5, 7>(geared, random);
  }
}

TEST(Dynamics, is_the_same_for_64_joints) {
  Random random(1);
  expect_laws<kOpen, kOpen>(random_tree(random, kMaxDof, {0.3, 0.1, 0.0}), random);
}

/// Gravity that is rotated back has the effect of a rotated base.
TEST(Dynamics, has_gravity_in_any_direction) {
  Random random(2);
  Tree<> tree = random_tree(random, 6, {0.3, 0.2, 0.0});
  const Matrix<3, 3> R = rotation(Vector<3>(random.uniform(3, -1.5, 1.5)));
  const Vector<3> down(0.0, 0.0, -Dynamics<6>::kGravity);
  const Dynamics<6> tilted(tree, R.transpose() * down);
  for (auto& [joint, parent] : tree.joints) {
    if (parent == 0) joint.placement = Transform<>{Vector<3>::Zero(), R} * joint.placement;
  }
  const Dynamics<6> upright(tree);
  const Vector<6> q = random.uniform(6, -2.0, 2.0);
  const Vector<6> qd = random.uniform(6, -2.0, 2.0);
  Dynamics<6>::State a;
  Dynamics<6>::State b;
  tilted.robot().update(q, qd, a);
  upright.robot().update(q, qd, b);
  EXPECT_LT(relative(tilted.bias(a), upright.bias(b)), 1e-13);
  EXPECT_NEAR(tilted.potential_energy(a), upright.potential_energy(b), 1e-12);
}

/// A payload is a heavier link.
TEST(Dynamics, carries_a_payload) {
  Random random(3);
  Chain<> chain = presets::panda();
  for (auto& joint : chain.joints) joint.moved = random_inertia(random);
  const LinkInertia<> load = random_inertia(random);
  const Transform<> offset = random_placement(random);
  Dynamics<7> loaded(chain);
  const Dynamics<7> empty(chain);
  EXPECT_TRUE(loaded.set_payload(3, random_inertia(random)));
  EXPECT_TRUE(loaded.set_payload(Robot<7>::kTip, load, offset));
  auto& last = chain.joints.back().moved;
  last = joined(last, placed(chain.tip * offset, load));
  const Dynamics<7> heavier(chain);

  const Vector<7> q = random.uniform(7, -2.0, 2.0);
  const Vector<7> qd = random.uniform(7, -2.0, 2.0);
  Dynamics<7>::State state;
  heavier.robot().update(q, qd, state);
  EXPECT_LT(relative(loaded.bias(state), heavier.bias(state)), 1e-13);
  EXPECT_LT(relative(loaded.gravity_torque(state), heavier.gravity_torque(state)), 1e-13);
  EXPECT_LT(relative(loaded.mass_matrix(state), heavier.mass_matrix(state)), 1e-13);
  EXPECT_NEAR(loaded.potential_energy(state), heavier.potential_energy(state), 1e-12);
  EXPECT_NEAR(loaded.link(7).mass, empty.link(7).mass + load.mass, 1e-15);

  // Refused, without effect.
  const Vector<7> before = loaded.bias(state);
  LinkInertia<> wrong = load;
  wrong.mass = -1.0;
  EXPECT_FALSE(loaded.set_payload(7, wrong));
  wrong.mass = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(loaded.set_payload(7, wrong));
  wrong = load;
  wrong.inertia(0, 0) += 100.0;
  EXPECT_FALSE(loaded.set_payload(7, wrong));
  for (const int link : {0, 8, -2}) EXPECT_FALSE(loaded.set_payload(link, load));
  EXPECT_EQ(loaded.bias(state), before);

  // Removed without a trace, however often.
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(loaded.set_payload(1 + i % 7, load, offset));
  EXPECT_TRUE(loaded.set_payload(1, {}));
  EXPECT_EQ(loaded.bias(state), empty.bias(state));
  EXPECT_EQ(loaded.mass_matrix(state), empty.mass_matrix(state));
}

TEST(Dynamics, has_no_tip_on_a_tree) {
  Random random(4);
  Dynamics<4> dynamics(random_tree(random, 4, {}));
  EXPECT_FALSE(dynamics.set_payload(Robot<4>::kTip, random_inertia(random)));
}

/// The laws see an error of 5 % in one mass.
TEST(Dynamics, differs_if_a_mass_is_wrong) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    Tree<> tree = random_tree(random, 6, {0.3, 0.2, 0.0});
    const Textbook textbook(tree, tilted_gravity());
    tree.joints[seed % 6].joint.moved.mass *= 1.05;
    const Dynamics<6> dynamics(tree, tilted_gravity());
    const Vector<6> q = random.uniform(6, -2.0, 2.0);
    Dynamics<6>::State state;
    dynamics.robot().update(q, state);
    EXPECT_GT(relative(dynamics.mass_matrix(state), Matrix<6, 6>(textbook.mass_matrix(q))), 1e-5);
    EXPECT_GT(relative(dynamics.gravity_torque(state), Vector<6>(textbook.gravity_torque(q))), 1e-5);
  }
}

TEST(Dynamics, agrees_in_float) {
  Random random(5);
  const Tree<> tree = random_tree(random, 6, {});
  Chain<> chain;
  Chain<float> rounded;
  for (const auto& [joint, parent] : tree.joints) {
    chain.joints.push_back(joint);
    Joint<float> single;
    single.placement = joint.placement.cast<float>();
    single.axis = joint.axis.cast<float>();
    single.moved = {static_cast<float>(joint.moved.mass), joint.moved.centre.cast<float>(),
                    joint.moved.inertia.cast<float>()};
    single.drive = {static_cast<float>(joint.drive.rotor_inertia), static_cast<float>(joint.drive.viscous)};
    rounded.joints.push_back(single);
  }
  const Dynamics<6> dynamics(chain);
  const Dynamics<6, float> in_float(rounded);
  const Vector<6> q = random.uniform(6, -2.0, 2.0);
  const Vector<6> qd = random.uniform(6, -2.0, 2.0);
  const Vector<6> qdd = random.uniform(6, -5.0, 5.0);
  Dynamics<6>::State state;
  Dynamics<6, float>::State state_in_float;
  dynamics.robot().update(q, qd, state);
  in_float.robot().update(q.cast<float>(), qd.cast<float>(), state_in_float);
  const Vector<6> torque = in_float.inverse_dynamics(state_in_float, qdd.cast<float>()).cast<double>();
  EXPECT_LT(relative(torque, dynamics.inverse_dynamics(state, qdd)), 1e-5);
  const Matrix<6, 6> M = in_float.mass_matrix(state_in_float).cast<double>();
  EXPECT_LT(relative(M, dynamics.mass_matrix(state)), 1e-5);
}

TEST(Dynamics, refuses_what_is_not_physical) {
  Random random(6);
  const Tree<> tree = random_tree(random, 3, {});
  const auto with = [&](const Matrix<3, 3>& inertia) {
    return [&tree, inertia] {
      Tree<> wrong = tree;
      wrong.joints[1].joint.moved.inertia = inertia;
      Dynamics<3>{wrong};
    };
  };
  const auto diagonal = [](double x, double y, double z) -> Matrix<3, 3> { return Vector<3>(x, y, z).asDiagonal(); };
  Matrix<3, 3> skewed = diagonal(1.0, 1.0, 1.0);
  skewed(0, 1) = 0.1;
  expect_refused(with(skewed), "joint 'j1'.moved.inertia is not symmetric: must be symmetric");
  expect_refused(with(diagonal(-0.1, 1.0, 1.0)),
                 "joint 'j1'.moved.inertia has the principal moment -0.1: must have no negative principal moment");
  expect_refused(with(diagonal(1.0, 3.0, 1.5)),
                 "joint 'j1'.moved.inertia has the principal moments 1, 1.5 and 3: the largest must be at most the sum "
                 "of the others (triangle inequality)");
  EXPECT_NO_THROW(with(diagonal(0.0, 1.0, 1.0))());         // A rod.
  EXPECT_NO_THROW(with(diagonal(1.234, 1.234, 2.4681))());  // A disc, rounded.
  expect_refused(with(diagonal(1.234, 1.234, 2.47)), "triangle inequality");
  EXPECT_NO_THROW(with(diagonal(0.0, 0.0, 0.0))());
  const double infinite = std::numeric_limits<double>::infinity();
  expect_refused([&] { Dynamics<3>(tree, Vector<3>(0.0, 0.0, infinite)); }, "gravity[2] = inf: must be finite");
}

TEST(RequireInertia, names_the_joint_whose_drive_moves_no_mass) {
  Random random(7);
  Tree<> tree = random_tree(random, 4, {});
  tree.joints[3].parent = 2;  // Carried by the link of j1, like j2.
  EXPECT_NO_THROW(require_inertia(tree));
  for (const std::size_t i : {1U, 2U}) {
    tree.joints[i].joint.moved = {};
    tree.joints[i].joint.drive = {};
  }
  expect_refused([&] { require_inertia(tree); }, "joint 'j2' moves no mass and has no rotor inertia: give the mass");
  EXPECT_NO_THROW(Dynamics<4>{tree});  // Inverse dynamics does not need it.
  tree.joints[2].joint.drive.rotor_inertia = 0.1;
  EXPECT_NO_THROW(require_inertia(tree));
  tree.joints[2].joint.drive.rotor_inertia = 0.0;
  tree.joints[3].joint.mimic = {2, 0.0, 0.0};
  expect_refused([&] { require_inertia(tree); }, "joint 'j2'");
  tree.joints[3].joint.mimic.ratio = 0.5;
  EXPECT_NO_THROW(require_inertia(tree));
}

}  // namespace
}  // namespace fpbm::test::dynamics_laws
