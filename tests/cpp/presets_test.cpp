#include "fpbm/model/presets.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm/model/detail/robot_presets.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "support/arms.hpp"
#include "support/compiled_tracker.hpp"

/// The arms of presets.hpp, compared with models from other sources and run in a control loop with default settings,
/// and Denavit-Hartenberg tables, compared with products of their factors.
namespace fpbm::test::presets_laws {
namespace {

constexpr int kOpen = Eigen::Dynamic;
constexpr double kHalfTurn = 3.14159265358979323846;
constexpr double kDegree = kHalfTurn / 180.0;

using Matrix34 = Matrix<3, 4>;

template <int N>
Matrix34 tip_of(const Chain<>& chain, const Vector<N>& q) {
  Kinematics<Pose, N> kinematics;
  SerialArm<N>(chain).kinematics(q, kinematics);
  Matrix34 tip;
  tip << kinematics.tip.R, kinematics.tip.p;
  return tip;
}

template <int N>
void expect_tip(const Chain<>& chain, const Vector<N>& q, const std::vector<double>& rows, double tolerance = 1e-12) {
  const Matrix34 expected = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(rows.data());
  EXPECT_LE((tip_of<N>(chain, q) - expected).cwiseAbs().maxCoeff(), tolerance) << q.transpose();
}

template <int N>
void expect_both_ways(const Vector<N>& lower, const Vector<N>& upper, const Vector<N>& expected, double tolerance) {
  for (int i = 0; i < N; ++i) {
    EXPECT_NEAR(upper(i), expected(i), tolerance) << i;
    EXPECT_EQ(lower(i), -upper(i)) << i;
  }
}

std::vector<std::string> names_of(const Chain<>& chain) {
  std::vector<std::string> names;
  for (const Joint<>& joint : chain.joints) names.push_back(joint.name);
  return names;
}

Chain<> preset(const std::string& name) {
  for (const presets::Preset& known : presets::kAll) {
    if (name == known.name) return known.chain();
  }
  throw std::out_of_range("no preset is named " + name);
}

/// Poses: panda.urdf of example-robot-data 6.0.0, panda_link8, by Pinocchio 4.1.0. Bounds: franka_ros,
/// franka_description/robots/panda/joint_limits.yaml; of acceleration: franka_rust 0.1.15.
TEST(Presets, panda_agrees_with_other_models) {
  const Chain<> panda = presets::panda();
  // clang-format off
  expect_tip<7>(panda, Vector<7>::Zero(), {
      1.0, 0.0, 0.0, 0.088,
      0.0, -1.0, 0.0, 0.0,
      0.0, 0.0, -1.0, 0.926});
  const Vector<7> ready{0.0, -kHalfTurn / 4, 0.0, -0.75 * kHalfTurn, 0.0, kHalfTurn / 2, kHalfTurn / 4};
  expect_tip<7>(panda, ready, {
      std::sqrt(0.5), -std::sqrt(0.5), 0.0, 0.306890566592941,
      -std::sqrt(0.5), -std::sqrt(0.5), 0.0, 0.0,
      0.0, 0.0, -1.0, 0.590282052302839});
  expect_tip<7>(panda, {0.5, -1.0, 1.5, -2.0, -0.5, 2.5, -1.5}, {
      -0.0945820042185657, -0.850408580677225, 0.517551437432596, -0.397827255325499,
      -0.137846378738888, 0.526061549688126, 0.839200584966611, 0.458305614445778,
      -0.985927289584062, 0.0080306818063453, -0.166981699006661, 0.462365503028319});
  // clang-format on
  const JointLimits<7> limits = SerialArm<7>(panda).limits();
  EXPECT_EQ(limits.lower, Vector<7>(-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973));
  EXPECT_EQ(limits.upper, Vector<7>(2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973));
  EXPECT_EQ(limits.velocity, Vector<7>(2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61));
  EXPECT_EQ(limits.acceleration, Vector<7>(15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0));
  EXPECT_TRUE((ready.array() > limits.lower.array()).all() && (ready.array() < limits.upper.array()).all());
  EXPECT_EQ(names_of(panda), (std::vector<std::string>{"panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4",
                                                       "panda_joint5", "panda_joint6", "panda_joint7"}));
}

/// Franka: "The arm can reach its maximum extension when joint 4 has angle −0.467002423653011 rad".
TEST(Presets, panda_has_the_workspace_radius_of_its_data_sheet) {
  Chain<> to_wrist = presets::panda();
  to_wrist.tip = to_wrist.joints[5].placement;
  to_wrist.joints.resize(5);
  const SerialArm<5> arm(to_wrist);
  const Vector<3> shoulder{0.0, 0.0, 0.333};
  Kinematics<Position<3>, 5> kinematics;
  const auto reach = [&](double elbow) {
    arm.kinematics(Vector<5>(0.3, 0.7, -0.4, elbow, 0.1), kinematics);
    return (kinematics.tip - shoulder).norm();
  };
  constexpr double kElbowFlip = -0.467002423653011;
  const double farthest = reach(kElbowFlip);
  EXPECT_NEAR((kinematics.tip - shoulder).dot(kinematics.J.col(3)), 0.0, 1e-14);
  EXPECT_GT(farthest, reach(kElbowFlip - 0.01));
  EXPECT_GT(farthest, reach(kElbowFlip + 0.01));
}

/// Poses: the joint frames of mujoco_menagerie's iiwa14.xml, by Pinocchio 4.1.0. Bounds: Drake, iiwa_constants.cc and
/// pull request 20921, and lbr_fri_ros2_stack, joint_limits.yaml.
TEST(Presets, iiwa14_agrees_with_other_models) {
  const Chain<> iiwa14 = presets::iiwa14();
  // clang-format off
  expect_tip<7>(iiwa14, Vector<7>::Zero(), {
      1.0, 0.0, 0.0, 0.0,
      0.0, 1.0, 0.0, 0.0,
      0.0, 0.0, 1.0, 1.306});
  const Vector<7> bent{0.0, kHalfTurn / 4, 0.0, -kHalfTurn / 2, 0.0, kHalfTurn / 4, 0.0};
  expect_tip<7>(iiwa14, bent, {
      -1.0, 0.0, 0.0, 0.579827560572968,
      0.0, 1.0, 0.0, 0.0,
      0.0, 0.0, -1.0, 0.248142135623731});
  expect_tip<7>(iiwa14, {0.5, -1.0, 1.5, -2.0, -0.5, 2.0, -1.5}, {
      0.0110649205805657, -0.327300888465268, 0.944855383612957, -0.22991831530967,
      0.108567593576908, -0.938933994800224, -0.326521103503905, 0.181632451593342,
      0.994027487123702, 0.106193605355194, 0.0251450397533994, 0.521806959737738});
  // clang-format on
  const JointLimits<7> limits = SerialArm<7>(iiwa14).limits();
  expect_both_ways<7>(limits.lower, limits.upper, kDegree * Vector<7>(170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0),
                      1e-15);
  const Vector<7> drake{1.483529, 1.483529, 1.745329, 1.308996, 2.268928, 2.356194, 2.356194};
  EXPECT_LE((limits.velocity - drake).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(limits.acceleration, Vector<7>(8.57, 8.57, 8.74, 11.36, 12.23, 15.72, 15.72));
  EXPECT_EQ(names_of(iiwa14).front(), "joint_a1");
  EXPECT_EQ(names_of(iiwa14).back(), "joint_a7");
}

/// Poses: the joint frames of mujoco_menagerie's gen3.xml, by Pinocchio 4.1.0, and table 94 of the User Guide, R07, as
/// printed, rounded to 0.1 mm. Bounds on position: menagerie; on acceleration: ros_kortex, hard_joint_limits.yaml.
TEST(Presets, gen3_agrees_with_other_models) {
  const Chain<> gen3 = presets::gen3();
  const Vector<7> home = kDegree * Vector<7>(0.0, 15.0, 180.0, -130.0, 0.0, 55.0, 90.0);
  const Vector<7> generic{0.5, -1.0, 1.5, -2.0, -0.5, 2.0, -1.5};
  // clang-format off
  expect_tip<7>(gen3, Vector<7>::Zero(), {
      1.0, 0.0, 0.0, 0.0,
      0.0, 1.0, 0.0, -0.0248501,
      0.0, 0.0, 1.0, 1.187385});
  expect_tip<7>(gen3, home, {
      0.0, 0.0, 1.0, 0.456665189948651,
      1.0, 0.0, 0.0, 0.0013501,
      0.0, 1.0, 0.0, 0.433724314026701});
  expect_tip<7>(gen3, generic, {
      0.635978200885924, 0.617126787562068, -0.463342482480532, -0.176920240590453,
      -0.582916680056964, 0.777621605124216, 0.235611509386536, 0.404261775297256,
      0.505707298849114, 0.120246277769238, 0.854283887576825, 0.556623398531648});
  // clang-format on
  constexpr double kQuarter = kHalfTurn / 2;
  Chain<> guide = modified_dh<double>({{0.0, kHalfTurn, -0.2848, 0.0},
                                       {0.0, kQuarter, -0.0118, kHalfTurn},
                                       {0.0, kQuarter, -0.4208, kHalfTurn},
                                       {0.0, kQuarter, -0.0128, kHalfTurn},
                                       {0.0, kQuarter, -0.3143, kHalfTurn},
                                       {0.0, kQuarter, 0.0, kHalfTurn},
                                       {0.0, kQuarter, -0.1674, kHalfTurn}});
  guide.tip.R = Vector<3>(1.0, -1.0, -1.0).asDiagonal();
  for (const Vector<7>& q : {Vector<7>(Vector<7>::Zero()), home, generic}) {
    EXPECT_LE((tip_of<7>(gen3, q) - tip_of<7>(guide, q)).cwiseAbs().maxCoeff(), 6e-4);
  }

  constexpr double kAny = JointBounds<>::kNone;
  const JointLimits<7> limits = SerialArm<7>(gen3).limits();
  const Vector<7> upper{kAny, 2.2497294058206907, kAny, 2.5795966344476193, kAny, 2.0996310901491784, kAny};
  for (int i = 0; i < 7; ++i) {
    const JointType type = gen3.joints[static_cast<std::size_t>(i)].type;
    EXPECT_EQ(type, i % 2 == 0 ? JointType::kContinuous : JointType::kRevolute) << i;
    EXPECT_DOUBLE_EQ(limits.upper(i), upper(i)) << i;
    EXPECT_EQ(limits.lower(i), -limits.upper(i)) << i;
    EXPECT_DOUBLE_EQ(limits.velocity(i), (i < 4 ? 79.64 : 69.91) * kDegree) << i;
  }
  EXPECT_EQ(limits.acceleration, Vector<7>(4.94, 4.94, 4.94, 4.94, 9.5, 9.5, 9.5));
  EXPECT_EQ(names_of(gen3).front(), "joint_1");
  EXPECT_EQ(names_of(gen3).back(), "joint_7");
}

/// Poses: the joint frames of ur_description, default_kinematics.yaml, from base_link_inertia to tool0, as products of
/// NumPy matrices. Bounds: ur_description, joint_limits.yaml, except for the elbow, whose range is halved there for
/// planners.
void expect_universal_robot(const Chain<>& arm, const Vector<6>& speeds) {
  const JointLimits<6> limits = SerialArm<6>(arm).limits();
  expect_both_ways<6>(limits.lower, limits.upper, Vector<6>::Constant(2.0 * kHalfTurn), 1e-15);
  EXPECT_LE((limits.velocity - kDegree * speeds).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(limits.acceleration, Vector<6>::Constant(5.0));
  EXPECT_EQ(names_of(arm), (std::vector<std::string>{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                                     "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"}));
}
TEST(Presets, ur5e_agrees_with_other_models) {
  const Chain<> ur5e = preset("ur5e");
  // clang-format off
  expect_tip<6>(ur5e, Vector<6>::Zero(), {
      1.0, 0.0, 0.0, -0.8172,
      0.0, 0.0, -1.0, -0.2329,
      0.0, 1.0, 0.0, 0.0628});
  expect_tip<6>(ur5e, kHalfTurn / 2.0 * Vector<6>(0.0, -1.0, 1.0, -1.0, -1.0, 0.0), {
      0.0, 1.0, 0.0, -0.4919,
      1.0, 0.0, 0.0, -0.1333,
      0.0, 0.0, -1.0, 0.4879});
  expect_tip<6>(ur5e, {0.5, -1.0, 1.5, -2.0, -0.5, 2.5}, {
      0.6643900267281933, -0.5963541027201674, 0.4504971437788868, -0.4820700974404498,
      -0.07470882606675189, -0.6527365535707303, -0.7538922886860783, -0.5148506350233188,
      0.7436427123907278, 0.4672224050721766, -0.4782245712076411, 0.2774108060042365});
  // clang-format on
  expect_universal_robot(ur5e, Vector<6>::Constant(180.0));
}
TEST(Presets, ur10e_agrees_with_other_models) {
  const Chain<> ur10e = preset("ur10e");
  // clang-format off
  expect_tip<6>(ur10e, Vector<6>::Zero(), {
      1.0, 0.0, 0.0, -1.18425,
      0.0, 0.0, -1.0, -0.2907,
      0.0, 1.0, 0.0, 0.06085});
  expect_tip<6>(ur10e, kHalfTurn / 2.0 * Vector<6>(0.0, -1.0, 1.0, -1.0, -1.0, 0.0), {
      0.0, 1.0, 0.0, -0.6914,
      1.0, 0.0, 0.0, -0.17415,
      0.0, 0.0, -1.0, 0.67685});
  expect_tip<6>(ur10e, {0.5, -1.0, 1.5, -2.0, -0.5, 2.5}, {
      0.6643900267281933, -0.5963541027201674, 0.4504971437788868, -0.6996150484372753,
      -0.07470882606675189, -0.6527365535707303, -0.7538922886860783, -0.6971943103370378,
      0.7436427123907278, 0.4672224050721766, -0.4782245712076411, 0.3580386784084411});
  // clang-format on
  expect_universal_robot(ur10e, {120.0, 120.0, 180.0, 180.0, 180.0, 180.0});
}

/// Poses: xarm7.urdf.xacro of xarm_ros2, with exact right angles, link7, by Pinocchio 4.1.0. At zero: UFACTORY's user
/// manual. Bounds on position: JOINT_LIMITS of xArm-Python-SDK.
TEST(Presets, xarm7_agrees_with_other_models) {
  const Chain<> xarm7 = preset("xarm7");
  // clang-format off
  expect_tip<7>(xarm7, Vector<7>::Zero(), {
      1.0, 0.0, 0.0, 0.206,
      0.0, -1.0, 0.0, 0.0,
      0.0, 0.0, -1.0, 0.1205});
  expect_tip<7>(xarm7, {0.5, -1.0, 1.5, 2.0, -0.5, 0.7, -1.5}, {
      -0.279771862438435, -0.953422976201479, -0.112748984203158, -0.605874921108088,
      0.170655596881777, -0.164954926197348, 0.971425004607227, 0.174935895682167,
      -0.944777419417216, 0.252536137561225, 0.20885671400509, 0.594460909120216});
  // clang-format on
  const JointLimits<7> limits = SerialArm<7>(xarm7).limits();
  const double turn = 2.0 * kHalfTurn;
  const Vector<7> lower{-turn, -2.059488, -turn, -0.191986, -turn, -1.692969, -turn};
  const Vector<7> upper{turn, 2.094395, turn, 3.92699, turn, kHalfTurn, turn};
  EXPECT_LE((limits.lower - lower).cwiseAbs().maxCoeff(), 5e-4);
  EXPECT_LE((limits.upper - upper).cwiseAbs().maxCoeff(), 5e-4);
  EXPECT_LE((limits.velocity - kDegree * Vector<7>::Constant(180.0)).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_EQ(limits.acceleration, Vector<7>::Constant(20.0));
}

/// Poses: so101_new_calib.urdf, with exact right angles and without lengths below 1 µm, gripper_frame_link, by
/// Pinocchio 4.1.0. Ranges: so101_new_calib.xml, for MuJoCo.
TEST(Presets, so101_agrees_with_other_models) {
  const Chain<> so101 = preset("so101");
  // clang-format off
  expect_tip<5>(so101, Vector<5>::Zero(), {
      0.0, 0.0, 1.0, 0.3913619,
      0.0486602763602726, 0.998815387098408, 0.0, -1.12464278031993e-05,
      -0.998815387098408, 0.0486602763602726, 0.0, 0.226468744613783});
  expect_tip<5>(so101, {0.5, -1.0, 1.5, -1.2, -0.5}, {
      0.732417788726779, 0.114185860581666, 0.671212166158958, 0.214293648237131,
      0.194193947639099, 0.909852137025584, -0.366684877586083, -0.091572905463523,
      -0.652574052086748, 0.398911867450947, 0.644217687237691, 0.238206703616266});
  // clang-format on
  const JointLimits<5> limits = SerialArm<5>(so101).limits();
  EXPECT_LE((limits.lower - Vector<5>(-1.91986, -1.74533, -1.69, -1.65806, -2.74385)).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LE((limits.upper - Vector<5>(1.91986, 1.74533, 1.69, 1.65806, 2.84121)).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LE((limits.velocity.array() - 45.0 * 6.0 * kDegree).abs().maxCoeff(), 3e-3);
  EXPECT_EQ(names_of(so101),
            (std::vector<std::string>{"shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll"}));
}

/// Poses: v10.urdf.xacro of openarm_description 1.0.0, openarm_link8, by Pinocchio 4.1.0.
TEST(Presets, openarm_agrees_with_its_urdf) {
  const Chain<> openarm = preset("openarm");
  // clang-format off
  expect_tip<7>(openarm, Vector<7>::Zero(), {
      1.0, 0.0, 0.0, 0.000001,
      0.0, 1.0, 0.0, 0.0205,
      0.0, 0.0, 1.0, 0.5585});
  expect_tip<7>(openarm, {0.5, -1.0, 1.5, 2.0, -0.5, 0.7, -1.5}, {
      -0.314966872816243, -0.927570963758344, 0.201017353033944, -0.00508180368261074,
      -0.651313423409579, 0.365295584388916, 0.665093948636172, 0.0109616141427462,
      -0.690352586375145, 0.0785572607616719, -0.719195427729328, 0.359267530681704});
  // clang-format on
  const JointLimits<7> limits = SerialArm<7>(openarm).limits();
  EXPECT_EQ(limits.lower, Vector<7>(-1.396263, -1.745329, -1.570796, 0.0, -1.570796, -0.785398, -1.570796));
  EXPECT_EQ(limits.upper, Vector<7>(3.490659, 1.745329, 1.570796, 2.443461, 1.570796, 0.785398, 1.570796));
  EXPECT_EQ(limits.velocity, Vector<7>(16.754666, 16.754666, 5.445426, 5.445426, 20.943946, 20.943946, 20.943946));
  EXPECT_EQ(names_of(openarm).front(), "openarm_joint1");
  EXPECT_EQ(names_of(openarm).back(), "openarm_joint7");
}

/// Poses and ranges: z1.urdf of example-robot-data 6.0.0, gripperStator, by Pinocchio 4.1.0.
TEST(Presets, z1_agrees_with_other_models) {
  const Chain<> z1 = preset("z1");
  // clang-format off
  expect_tip<6>(z1, Vector<6>::Zero(), {
      1.0, 0.0, 0.0, 0.0382,
      0.0, 1.0, 0.0, 0.0,
      0.0, 0.0, 1.0, 0.1605});
  expect_tip<6>(z1, {0.5, 1.0, -1.5, -1.2, -0.5, 2.5}, {
      0.130619111235025, -0.140331893484869, 0.981450766697507, -0.0168719131015651,
      -0.474944944154914, -0.877807278362211, -0.0623031465980116, -0.0639566776181609,
      0.870267744893408, -0.457997097944167, -0.181308329849632, 0.709169182896224});
  // clang-format on
  const JointLimits<6> limits = SerialArm<6>(z1).limits();
  const Vector<6> lower{-2.61799387799149, 0.0, -2.87979326579064, -1.51843644923507, -1.34390352403563,
                        -2.79252680319093};
  const Vector<6> upper{2.61799387799149, 2.96705972839036, 0.0, 1.51843644923507, 1.34390352403563, 2.79252680319093};
  EXPECT_LE((limits.lower - lower).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LE((limits.upper - upper).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(limits.velocity, Vector<6>::Constant(3.1415));
}

/// The posture with the largest distance to singular postures, of a hundred random postures in the middle of the joint
/// ranges.
Vector<kOpen> open_posture(const AnyArm<Position<3>>& arm) {
  const Vector<kOpen> lower = arm.limits().lower.cwiseMax(-3.0);
  const Vector<kOpen> upper = arm.limits().upper.cwiseMin(3.0);
  Random random(5);
  Vector<kOpen> best = lower;
  double most = -1.0;
  for (int i = 0; i < 100; ++i) {
    const Vector<kOpen> share = random.uniform(arm.dof(), 0.2, 0.8);
    const Vector<kOpen> q = lower + share.cwiseProduct(upper - lower);
    Kinematics<Pose, kOpen> kinematics;
    arm.kinematics(q, kinematics);
    const Matrix<3, kOpen> position = kinematics.J.topRows<3>();
    const double open = arm.dof() < Pose::kRows ? manipulability(position) : manipulability(kinematics.J);
    if (open > most) best = q;
    most = std::max(most, open);
  }
  return best;
}

template <typename Space, typename Scheme>
void expect_to_reach_a_near_target(const AnyArm<Position<3>>& arm, const Scheme& scheme) {
  CompiledTracker tracker(arm, Space{}, scheme, open_posture(arm));
  Vector<Space::kRows> displacement = Vector<Space::kRows>::Zero();
  displacement.template head<3>() = Vector<3>(0.02, -0.03, 0.01);
  const auto target = Reference<Space>::hold(Space::template displace<double>(tracker.tip(), displacement));
  const JointLimits<kOpen>& bounds = arm.limits();
  for (int i = 0; i < 1000; ++i) {
    const auto tick = tracker.tick(target);
    ASSERT_FALSE(failed(tick.status)) << message(tick.status);
    ASSERT_TRUE((tick.q.array() >= bounds.lower.array() - 1e-9).all());
    ASSERT_TRUE((tick.q.array() <= bounds.upper.array() + 1e-9).all());
    ASSERT_TRUE((tick.qd.array().abs() <= bounds.velocity.array() + 1e-9).all());
    ASSERT_TRUE((tick.qdd.array().abs() <= bounds.acceleration.array() + 1e-9).all());
  }
  EXPECT_LE(Space::template difference<double>(target.x, tracker.tip()).norm(), 1e-3);
}

/// With the bounds of the preset, at both levels.
TEST(Presets, run_in_a_control_loop_with_default_limits) {
  for (const presets::Preset& known : presets::kAll) {
    SCOPED_TRACE(known.name);
    const AnyArm<Position<3>> arm = any_arm(known.chain());
    EXPECT_TRUE(arm.limits().velocity.allFinite() && arm.limits().acceleration.allFinite());
    const Vector<kOpen> ones = Vector<kOpen>::Ones(arm.dof());
    const auto z = NullSpace<kOpen>{}.with_damping(2.0);
    EXPECT_NO_THROW((expect_to_reach_a_near_target<Position<3>>(arm, FPBM<kOpen>(0.6, ones, 20.0, 100.0, z))));
    EXPECT_NO_THROW((expect_to_reach_a_near_target<Position<3>>(arm, WMVN<kOpen>(ones, 10.0))));
    if (arm.dof() < Pose::kRows) continue;
    EXPECT_NO_THROW((expect_to_reach_a_near_target<Pose>(arm, FPBM<kOpen>(0.6, ones, 20.0, 100.0, z))));
    EXPECT_NO_THROW((expect_to_reach_a_near_target<Pose>(arm, WMVN<kOpen>(ones, 10.0))));
  }
}

/// Principal moments that are positive and satisfy the triangle inequality; bounds on the efforts.
template <typename Joints>
void expect_links(const Joints& joints) {
  for (const Joint<>& joint : joints) {
    const auto& [mass, centre, inertia] = joint.moved;
    const Eigen::Matrix3d symmetric = inertia;
    EXPECT_EQ(symmetric, symmetric.transpose()) << joint.name;
    const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric).eigenvalues();
    EXPECT_GT(mass, 0.0) << joint.name;
    EXPECT_LT(centre.norm(), 0.5) << joint.name;
    EXPECT_GT(moments(0), 0.0) << joint.name;
    EXPECT_LE(moments(2), moments(0) + moments(1)) << joint.name;
    EXPECT_TRUE(std::isfinite(joint.bounds.effort)) << joint.name;
  }
}

TEST(Presets, links_have_inertias_of_bodies_and_drives_have_bounds_on_their_efforts) {
  for (const presets::Preset& known : presets::kAll) {
    SCOPED_TRACE(known.name);
    expect_links(known.chain().joints);
  }
  for (const presets::RobotPreset& known : presets::kRobots) {
    SCOPED_TRACE(known.name);
    std::vector<Joint<>> joints;
    for (const TreeJoint<>& each : known.tree().joints) joints.push_back(each.joint);
    expect_links(joints);
  }
}

/// Universal Robots gives inertias in the frames of the Denavit-Hartenberg table. Frame 1 is rotated by 90° about x,
/// and frame 2 is at the end of the upper arm, at x = −0.425 m.
TEST(Presets, links_of_the_ur5e_are_in_the_frames_of_its_table) {
  const Chain<> chain = preset("ur5e");
  EXPECT_LE((chain.joints[1].moved.centre - Vector<3>(0.2125 - 0.425, 0.0, 0.11336)).norm(), 1e-15);
  const LinkInertia<>& shoulder = chain.joints[0].moved;
  EXPECT_LE((shoulder.centre - Vector<3>(0.0, -0.00193, 0.1625 - 0.02561)).norm(), 1e-15);
  EXPECT_NEAR(shoulder.inertia(1, 1), 0.00657286, 1e-15);
  EXPECT_NEAR(shoulder.inertia(1, 2), -0.00049994, 1e-15);
}

/// The right arm of the G1 is the mirror image of its left arm.
TEST(Presets, arms_of_the_g1_are_mirror_images) {
  const Tree<> tree = presets::g1_upper_body();
  const Matrix<3, 3> mirror = Vector<3>(1.0, -1.0, 1.0).asDiagonal();
  for (std::size_t i = 3; i < 10; ++i) {
    const LinkInertia<>& left = tree.joints[i].joint.moved;
    const LinkInertia<>& right = tree.joints[i + 7].joint.moved;
    EXPECT_EQ(right.centre, Vector<3>(mirror * left.centre)) << i;
    EXPECT_EQ(right.inertia, (Matrix<3, 3>(mirror * left.inertia * mirror))) << i;
  }
}

Eigen::Matrix4d along(int axis, double distance) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T(axis, 3) = distance;
  return T;
}

Eigen::Matrix4d about(int axis, double angle) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  const int j = (axis + 1) % 3;
  const int k = (axis + 2) % 3;
  T(j, j) = T(k, k) = std::cos(angle);
  T(k, j) = std::sin(angle);
  T(j, k) = -T(k, j);
  return T;
}

/// Rz Tz Tx Rx for classic tables and Rx Tx Rz Tz for modified tables, factor by factor.
TEST(DenavitHartenberg, tip_is_the_product_of_its_rows) {
  constexpr int kX = 0;
  constexpr int kZ = 2;
  constexpr int N = 7;
  Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<DHRow<>> table;
    for (int i = 0; i < N; ++i) {
      const JointType type = random.uniform(0.0, 1.0) < 0.3 ? JointType::kPrismatic : JointType::kRevolute;
      table.push_back({random.uniform(-0.5, 0.5), random.uniform(-3.0, 3.0), random.uniform(-0.5, 0.5),
                       random.uniform(-3.0, 3.0), type});
    }
    const Vector<N> q = random.uniform(N, -3.0, 3.0);
    Eigen::Matrix4d classic = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d modified = Eigen::Matrix4d::Identity();
    for (int i = 0; i < N; ++i) {
      const DHRow<>& row = table[static_cast<std::size_t>(i)];
      const bool slides = row.type == JointType::kPrismatic;
      const double theta = row.theta + (slides ? 0.0 : q(i));
      const double d = row.d + (slides ? q(i) : 0.0);
      classic = classic * about(kZ, theta) * along(kZ, d) * along(kX, row.a) * about(kX, row.alpha);
      modified = modified * about(kX, row.alpha) * along(kX, row.a) * about(kZ, theta) * along(kZ, d);
    }
    EXPECT_LE((tip_of<N>(classic_dh(table), q) - classic.topRows<3>()).cwiseAbs().maxCoeff(), 1e-13) << trial;
    EXPECT_LE((tip_of<N>(modified_dh(table), q) - modified.topRows<3>()).cwiseAbs().maxCoeff(), 1e-13) << trial;
  }
}

}  // namespace
}  // namespace fpbm::test::presets_laws
