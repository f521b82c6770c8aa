#include <gtest/gtest.h>

#include "fpbm/model/dynamics.hpp"
#include "fpbm/model/presets.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/objective/manipulability_ascent.hpp"
#include "fpbm/scheme/detail/require_members.hpp"
#include "fpbm/scheme/schemes.hpp"

/// The members that a scheme of a user must have. A class that uses a scheme without a member does not compile, and the
/// message names the member.
namespace fpbm::test::scheme_members_laws {
namespace {

constexpr int kJoints = 7;
using Motion = Vector<kJoints>;
using Joints = State<kJoints>;

template <typename Scheme, typename Space = Pose>
constexpr bool kResolves = kHas<Scheme, ResolveOf, Kinematics<Space, kJoints>, Reference<Space>, Joints, Motion>;
template <typename Scheme>
constexpr bool kResolvesRows = kHas<Scheme, ResolveRowsOf, TaskEquation<6, kJoints>, Joints, Motion>;

struct Nothing {};
struct Own {
  static constexpr Level kLevel = Level::kAcceleration;
  static constexpr int kDof = kJoints;
  NullSpace<kJoints> null_space;

  void require_dof(Eigen::Index) const {}
  template <typename Space>
  [[nodiscard]] Status resolve(const Kinematics<Space, kJoints>&, const Reference<Space>&, const Joints&,
                               Motion&) const noexcept {
    return Status::kOk;
  }
  template <int M>
  [[nodiscard]] Status resolve_rows(const TaskEquation<M, kJoints>&, const Joints&, Motion&) const noexcept {
    return Status::kOk;
  }
};
struct OnlyPositions : Own {
  [[nodiscard]] static Status resolve(const Kinematics<Position<3>, kJoints>&, const Reference<Position<3>>&,
                                      const Joints&, Motion&) noexcept {
    return Status::kOk;
  }
};

template <typename Scheme>
constexpr void expect_all_members() {
  static_assert(require_members<Scheme, Pose, kJoints, double>());
  static_assert(require_members_for_stack<Scheme, 6, kJoints, double>());
}

TEST(SchemeMembers, of_the_schemes_of_the_library_are_complete) {
  expect_all_members<decltype(MVN<kJoints>())>();
  expect_all_members<decltype(FPBM<kJoints>(0.5, Motion::Ones(), 1, 1))>();
  expect_all_members<MinimumTorqueScheme<Dynamics<kJoints>>>();
  expect_all_members<MinimumEnergyScheme<Dynamics<kJoints>>>();
  using Ascent = ManipulabilityAscent<decltype(MAN<kJoints>()), SerialArm<kJoints>>;
  static_assert(require_members<Ascent, Pose, kJoints, double>());
}

TEST(SchemeMembers, of_an_own_scheme_are_found) {
  expect_all_members<Own>();
}

TEST(SchemeMembers, that_are_missing_are_noticed) {
  EXPECT_FALSE((kHas<Nothing, LevelOf>));
  EXPECT_FALSE((kHas<Nothing, DofOf>));
  EXPECT_FALSE((kHas<Nothing, RequireDofOf>));
  EXPECT_FALSE((kHas<Nothing, NullSpaceOf>));
  EXPECT_FALSE(kResolves<Nothing>);
  EXPECT_FALSE(kResolvesRows<Nothing>);
}

TEST(SchemeMembers, for_another_task_space_are_noticed) {
  EXPECT_TRUE((kResolves<OnlyPositions, Position<3>>));
  EXPECT_FALSE((kResolves<OnlyPositions, Pose>));
}

}  // namespace
}  // namespace fpbm::test::scheme_members_laws
