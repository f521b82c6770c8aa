#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "fpbm/fpbm.hpp"
#include "fpbm/model/dynamics.hpp"
#include "fpbm/realtime/stack_tracker.hpp"
#include "support/arms.hpp"
#include "support/random.hpp"

/// MinimumTorque, BalancedTorque and MinimumEnergy: the least torque and the least kinetic energy, by dense solutions
/// of the conditions of Karush, Kuhn and Tucker in extended precision.
namespace fpbm::test::minimum_torque_laws {
namespace {

using Real = long double;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// A planar arm of uniform rods of 1 m and 1 kg, the arm of the paper, with gravity in its plane if the base is turned.
template <int N = 4>
[[nodiscard]] Chain<> rods() {
  Chain<> chain;
  for (int i = 0; i < N; ++i) {
    Joint<> joint;
    joint.placement = chain.tip;
    joint.moved.mass = 1.0;
    joint.moved.centre = {0.5, 0.0, 0.0};
    joint.moved.inertia.diagonal() << 0.0, 1.0 / 12.0, 1.0 / 12.0;
    chain.joints.push_back(joint);
    chain.tip.p = {1.0, 0.0, 0.0};
  }
  return chain;
}
[[nodiscard]] Vector<3> in_plane() {
  return {0.0, -9.81, 0.0};
}

/// A Panda with random links, a joint with a rotor and friction.
[[nodiscard]] Chain<> panda(std::uint32_t seed) {
  Random random(seed);
  Chain<> chain = presets::panda();
  for (auto& joint : chain.joints) {
    const Matrix<3, 3> A = random.uniform(3, 3, -0.1, 0.1);
    const Matrix<3, 3> moments = A * A.transpose() + 5e-3 * Matrix<3, 3>::Identity();  // Second moments of the mass.
    joint.moved.mass = random.uniform(0.5, 4.0);
    joint.moved.centre = random.uniform(3, -0.1, 0.1);
    joint.moved.inertia = moments.trace() * Matrix<3, 3>::Identity() - moments;
  }
  chain.joints[5].drive = {0.1, 1.0, 0.0};
  return chain;
}

/// Mass matrix, bias and kinematics in a random state, with a reference near the tip.
template <typename Space, typename Model>
struct Scene {
  static constexpr int N = Model::kDof;
  using Scalar = typename Model::Scalar;
  static constexpr Scalar kK1 = Scalar(10);
  static constexpr Scalar kK2 = Scalar(25);
  static constexpr Scalar kK = Scalar(5);

  template <typename Arm>
  Scene(const Arm& arm, const Model& model, Random& random) {
    const int dof = arm.dof();
    state.q = random.uniform(dof, -1.5, 1.5).template cast<Scalar>();
    state.qd = random.uniform(dof, -1.0, 1.0).template cast<Scalar>();
    arm.kinematics(state.q, state.qd, kinematics);
    const Vector<Space::kRows, Scalar> error = random.uniform(Space::kRows, -0.1, 0.1).template cast<Scalar>();
    reference = {Space::template displace<Scalar>(kinematics.tip, error),
                 random.uniform(Space::kRows, -0.5, 0.5).template cast<Scalar>(),
                 random.uniform(Space::kRows, -0.5, 0.5).template cast<Scalar>()};
    typename Model::State joints;
    model.robot().update(state.q, state.qd, joints);
    M = model.mass_matrix(joints).template cast<Real>();
    h = model.bias(joints).template cast<Real>();
    J = kinematics.J.template cast<Real>();
    const RealVector e = Space::template difference<Scalar>(reference.x, kinematics.tip).template cast<Real>();
    const RealVector qd = state.qd.template cast<Real>();
    const RealVector xd = reference.xd.template cast<Real>();
    v = xd + Real(kK) * e;
    b = reference.xdd.template cast<Real>() - kinematics.Jd.template cast<Real>() * qd + Real(kK1) * (xd - J * qd) +
        Real(kK2) * e;
  }

  /// The u with J u = right that minimises ½ uᵀA u + gᵀu.
  [[nodiscard]] RealVector least(const RealMatrix& A, const RealVector& g, const RealVector& right) const {
    const Eigen::Index n = A.rows();
    const Eigen::Index m = J.rows();
    RealMatrix system = RealMatrix::Zero(n + m, n + m);
    system << A, J.transpose(), J, RealMatrix::Zero(m, m);
    RealVector sides(n + m);
    sides << -g, right;
    return system.fullPivLu().solve(sides).head(n);
  }
  [[nodiscard]] RealVector torque(const RealVector& qdd) const { return M * qdd + h; }
  /// A motion in the null space of J.
  [[nodiscard]] RealVector null_motion(Random& random) const {
    const RealVector any = random.uniform(M.rows(), -1.0, 1.0).template cast<Real>();
    return least(RealMatrix::Identity(M.rows(), M.rows()), -any, RealVector::Zero(J.rows()));
  }
  template <typename Scheme>
  [[nodiscard]] RealVector resolved(const Scheme& scheme) const {
    Vector<N, Scalar> u = Vector<N, Scalar>::Zero(state.q.size());
    EXPECT_EQ(scheme.resolve(kinematics, reference, state, u), Status::kOk);
    return u.template cast<Real>();
  }

  State<N, Scalar> state;
  Kinematics<Space, N, Scalar> kinematics;
  Reference<Space, Scalar> reference;
  RealMatrix M;
  RealMatrix J;
  RealVector h;
  RealVector v;
  RealVector b;
};

/// Calls check(scene, model, random) for random states of an arm with a model.
template <typename Space, typename Arm, typename Model, typename Check>
void in_states(const std::string& name, const Arm& arm, const Model& model, Check&& check) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(name + ", seed " + std::to_string(seed));
    Random random(seed);
    const Scene<Space, Model> scene(arm, model, random);
    check(scene, model, random);
  }
}
template <typename Check>
void everywhere(Check&& check) {
  const PlanarArm<4> planar(Vector<4>::Ones());
  in_states<Position<2>>("rods", planar, Dynamics<4>(rods(), in_plane()), check);
  const Chain<> chain = panda(1);
  in_states<Pose>("pose", SerialArm<7>(chain), Dynamics<7>(chain), check);
  in_states<Position<3>>("position, size at run time", SerialArm<Eigen::Dynamic>(chain),
                         Dynamics<Eigen::Dynamic>(chain), check);
}

/// Largest difference relative to the size of b.
[[nodiscard]] double distance(const RealVector& a, const RealVector& b) {
  return static_cast<double>((a - b).norm() / (1 + b.norm()));
}

TEST(MinimumTorque, has_the_least_torque) {
  everywhere([](const auto& scene, const auto& model, Random& random) {
    const RealVector qdd = scene.resolved(MinimumTorque(model, 10.0, 25.0));
    EXPECT_LE(distance(scene.J * qdd, scene.b), 1e-11);
    EXPECT_LE(distance(qdd, scene.least(scene.M * scene.M, scene.M * scene.h, scene.b)), 1e-9);
    const Real least = scene.torque(qdd).squaredNorm();
    for (int i = 0; i < 20; ++i) {
      EXPECT_GE(scene.torque(qdd + 0.1L * scene.null_motion(random)).squaredNorm(), least);
    }
  });
}

TEST(MinimumEnergy, has_the_least_kinetic_energy) {
  everywhere([](const auto& scene, const auto& model, Random& random) {
    const RealVector qd = scene.resolved(MinimumEnergy(model, 5.0));
    EXPECT_LE(distance(scene.J * qd, scene.v), 1e-12);
    EXPECT_LE(distance(qd, scene.least(scene.M, RealVector::Zero(qd.size()), scene.v)), 1e-10);
    for (int i = 0; i < 20; ++i) {
      const RealVector moved = qd + 0.1L * scene.null_motion(random);
      EXPECT_GE(moved.dot(scene.M * moved), qd.dot(scene.M * qd));
    }
  });
}

/// The result is (1−α) MTN + α WMVN with feedback, and z acts in the null space of each part.
TEST(BalancedTorque, is_a_balance_with_the_velocity_scheme) {
  everywhere([](const auto& scene, const auto& model, Random& random) {
    constexpr int N = std::decay_t<decltype(model)>::kDof;
    const Vector<N> W = random.uniform(model.dof(), 1.0, 4.0);
    const auto z = NullSpace<N>{}.with_damping(2.0).with_rest_posture(random.uniform(model.dof(), -1.0, 1.0), 3.0);
    const auto balanced = [&](double alpha) { return scene.resolved(BalancedTorque(model, alpha, W, 10.0, 25.0, z)); };
    const RealVector torque = scene.resolved(MinimumTorque(model, 10.0, 25.0, z));
    const RealVector velocity = scene.resolved(FPBM<N>(1.0, W, 10.0, 25.0, z));
    EXPECT_EQ(balanced(0.0), torque);
    EXPECT_LE(distance(balanced(1.0), velocity), 1e-13);
    for (const double alpha : {0.25, 0.6}) {
      const RealVector qdd = balanced(alpha);
      EXPECT_LE(distance(qdd, (1 - Real(alpha)) * torque + Real(alpha) * velocity), 1e-12);
      EXPECT_LE(distance(scene.J * qdd, scene.b), 1e-11);
    }
    const RealVector secondary = z.template at<Level::kAcceleration>(scene.state).template cast<Real>();
    const RealMatrix squared = scene.M * scene.M;
    EXPECT_LE(distance(torque, scene.least(squared, scene.M * scene.h - squared * secondary, scene.b)), 1e-9);
  });
}

/// Without a command and without damping, the motion at rest is the fall of the arm in the null space.
TEST(MinimumTorque, falls_in_the_null_space_at_rest) {
  const Dynamics<4> model(rods(), in_plane());
  Random random(3);
  Scene<Position<2>, Dynamics<4>> scene(PlanarArm<4>(Vector<4>::Ones()), model, random);
  scene.state.qd.setZero();
  scene.kinematics.Jd.setZero();
  scene.reference = Reference<Position<2>>::hold(scene.kinematics.tip);
  EXPECT_TRUE(moves_at_rest(MinimumTorque(model, 10.0, 25.0)));
  EXPECT_FALSE(moves_at_rest(MinimumEnergy(model)));
  EXPECT_GT(scene.resolved(MinimumTorque(model, 10.0, 25.0)).norm(), 0.1L);
  EXPECT_EQ(scene.resolved(MinimumTorque(Dynamics<4>(rods()), 10.0, 25.0)).norm(), 0.0L);  // Gravity along the axes.
}

/// The arm from 1 rad to 1e-9 rad before its outstretched posture.
template <typename Check>
void toward_singular(Check&& check) {
  const Dynamics<4> model(rods(), in_plane());
  const PlanarArm<4> arm(Vector<4>::Ones());
  for (double bend = 1.0; bend > 1e-9; bend /= 3.0) {
    SCOPED_TRACE(bend);
    Random random(7);
    const State<4> state{{0.4, bend, -0.7 * bend, 0.3 * bend}, random.uniform(4, -0.5, 0.5)};
    Kinematics<Position<2>, 4> kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    Reference<Position<2>> reference{{kinematics.tip}, Vector<2>(0.3, 0.4), Vector<2>(1.0, -0.5)};
    check(model, state, kinematics, reference);
  }
}

/// Near a singular posture, the schemes are damped as WMVN with the dense weights M and M² is damped.
TEST(MinimumTorque, is_damped_as_the_schemes_with_dense_weights) {
  const SingularDamping<> damping;
  int damped = 0;
  toward_singular([&](const auto& model, const auto& state, const auto& kinematics, auto reference) {
    RobotState<4> joints;
    model.robot().update(state.q, state.qd, joints);
    const Matrix<4, 4> M = model.mass_matrix(joints);
    const auto expect_equal = [&](const auto& scheme, const auto& dense) {
      Vector<4> u = Vector<4>::Zero();
      Vector<4> expected = Vector<4>::Zero();
      const Status status = scheme.resolve(kinematics, reference, state, u);
      EXPECT_EQ(status, dense.resolve(kinematics, reference, state, expected));
      EXPECT_LE((u - expected).norm(), 1e-7 * (1.0 + expected.norm()));
      EXPECT_LE(u.norm(), 1e4);
      damped += status == Status::kDamped ? 1 : 0;
    };
    expect_equal(MinimumEnergy(model, 0.0, {}, damping), WMVN<4>(M, 0.0, {}, damping));
    reference.xd = kinematics.J * state.qd;  // With k1 = 0, the drift of WMVN differs by xd only, which is 0 below.
    reference.xd.setZero();
    const Vector<4> fall = -M.llt().solve(model.bias(joints));
    const Matrix<4, 4> squared = M * M;
    expect_equal(MinimumTorque(model, 0.0, 0.0, {}, damping),
                 WMVNAcceleration<4>(squared, NullSpace<4>{}.with_free_choice(fall), damping));
  });
  EXPECT_GT(damped, 10);
}

TEST(MinimumTorque, in_float_equals_double) {
  const Dynamics<7> model(panda(2));
  Chain<float> chain;
  for (const auto& joint : panda(2).joints) {
    Joint<float> single;
    single.placement = joint.placement.cast<float>();
    single.axis = joint.axis.cast<float>();
    single.moved = {static_cast<float>(joint.moved.mass), joint.moved.centre.cast<float>(),
                    joint.moved.inertia.cast<float>()};
    single.drive = {static_cast<float>(joint.drive.rotor_inertia), static_cast<float>(joint.drive.viscous), 0.0F};
    chain.joints.push_back(single);
  }
  chain.tip = panda(2).tip.cast<float>();
  const Dynamics<7, float> single(chain);
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    Random same(seed);
    const Scene<Pose, Dynamics<7>> expected(SerialArm<7>(panda(2)), model, random);
    const Scene<Pose, Dynamics<7, float>> scene(SerialArm<7, float>(chain), single, same);
    const RealVector qdd = expected.resolved(MinimumTorque(model, 10.0, 25.0));
    EXPECT_LE(distance(scene.resolved(MinimumTorque(single, 10.0F, 25.0F)), qdd), 1e-2);
    const RealVector qd = expected.resolved(MinimumEnergy(model, 5.0));
    EXPECT_LE(distance(scene.resolved(MinimumEnergy(single, 5.0F)), qd), 1e-3);
  }
}

/// A rollout and a tracker follow a circle, alone and on the first level of a stack.
template <typename Scheme>
void expect_to_follow(const Scheme& scheme, const Scheme& of_stack) {
  const Chain<> chain = panda(1);
  const SerialArm<7> arm(chain);
  const Vector<7> q0{0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785};
  const InPlane circle(Path(Circle(0.1), 8.0, Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0});
  const WithRotation path(circle);
  const TimeGrid<> grid(8.0, 4e-3);
  double error = 0.0;
  const auto result = rollout(arm, path, scheme, State<7>{q0, Vector<7>::Zero()}, grid,
                              [&](const auto& sample) noexcept { error = std::max(error, sample.error.norm()); });
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_LE(error, 1e-7);

  Tracker<SerialArm<7>, Pose, Scheme> tracker(arm, Pose{}, scheme, q0);
  PathFollower follower(path, tracker.tip());
  for (error = 0.0; !follower.done();) error = std::max(error, tracker.tick(follower).error.norm());
  EXPECT_LE(error, 1e-7);

  const TaskGains<> gains(10.0, 25.0);
  const Stack stack(PositionTask<>{{Robot<7>::kTip}, gains}, PositionTask<1>{{4}, gains, {2}});
  auto levels = stack_tracker(Robot<7>(chain), stack, of_stack, q0);
  PathFollower above(InPlane(Path(Circle(0.03), 4.0, Quintic{}), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}),
                     std::get<0>(levels.tip()));
  auto below = Reference<Position<3>>::hold(std::get<1>(levels.tip()));
  for (error = 0.0; !above.done();) {
    error = std::max(error, levels.tick(above, below).error.norm());
  }
  EXPECT_LE(error, 1e-5);
}

TEST(MinimumTorque, follows_paths) {
  // With gravity, null-space motion at the joint limits causes errors of 3e-5 m, and of lower levels without the
  // balance.
  const Dynamics<7> model(panda(1), Vector<3>::Zero());
  const auto z = NullSpace<7>{}.with_damping(2.0);
  expect_to_follow(MinimumTorque(model, 10.0, 25.0, z), BalancedTorque(model, 0.6, UnitWeights{}, 0.0, 0.0, z));
  expect_to_follow(MinimumEnergy(model, 10.0), MinimumEnergy(model));
}

TEST(MinimumTorque, rejects_invalid_arguments) {
  const Dynamics<4> model(rods());
  EXPECT_NE(complaint([&] { (void)BalancedTorque(model, 1.5, UnitWeights{}, 1.0, 1.0); }).find("alpha = 1.5"),
            std::string::npos);
  EXPECT_NE(complaint([&] { (void)MinimumTorque(model, -1.0, 1.0); }).find("k1 = -1"), std::string::npos);
  EXPECT_NE(complaint([&] { (void)MinimumEnergy(model, -1.0); }).find("k = -1"), std::string::npos);
  EXPECT_NE(complaint([&] { MinimumTorque(model, 1.0, 1.0).require_dof(5); }).find("has 4 entries"), std::string::npos);
  Chain<> chain = rods();
  chain.joints[3].moved = {};
  for (const auto& message : {complaint([&] { (void)MinimumTorque(Dynamics<4>(chain), 1.0, 1.0); }),
                              complaint([&] { (void)MinimumEnergy(Dynamics<4>(chain)); })}) {
    EXPECT_NE(message.find("joints[3] moves no mass"), std::string::npos) << message;
  }
  chain.joints[3].drive.rotor_inertia = 0.1;
  EXPECT_EQ(complaint([&] { (void)MinimumTorque(Dynamics<4>(chain), 1.0, 1.0); }), "");
}

/// For a state or a reference that is not finite, the schemes return a status and do not change u.
TEST(MinimumTorque, rejects_numbers_that_are_not_finite) {
  const Dynamics<4> model(rods(), in_plane());
  Random random(5);
  const Scene<Position<2>, Dynamics<4>> good(PlanarArm<4>(Vector<4>::Ones()), model, random);
  const auto expect_refusal = [&](const auto& scene, bool velocity) {
    Vector<4> u = Vector<4>::Constant(42.0);
    EXPECT_EQ(MinimumTorque(model, 1.0, 1.0).resolve(scene.kinematics, scene.reference, scene.state, u),
              Status::kNotFinite);
    EXPECT_EQ(
        BalancedTorque(model, 0.5, UnitWeights{}, 1.0, 1.0).resolve(scene.kinematics, scene.reference, scene.state, u),
        Status::kNotFinite);
    if (velocity) {
      EXPECT_EQ(MinimumEnergy(model, 1.0).resolve(scene.kinematics, scene.reference, scene.state, u),
                Status::kNotFinite);
    }
    EXPECT_EQ(u, Vector<4>::Constant(42.0));
  };
  auto bad = good;
  bad.state.q(1) = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(bad, true);
  bad = good;
  bad.state.qd(1) = std::numeric_limits<double>::infinity();
  expect_refusal(bad, false);
  bad = good;
  bad.reference.x(0) = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(bad, true);
}

}  // namespace
}  // namespace fpbm::test::minimum_torque_laws
