#pragma once

#include <Eigen/Core>
#include <memory>

#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/model/joint.hpp"
#include "fpbm/model/kinematics.hpp"

namespace fpbm {

/// Space of the tip positions of a task space: Position<2> for PlanarPose, Position<3> for Pose.
template <typename Space>
struct PositionsUnder {
  using type = Space;
};
template <>
struct PositionsUnder<PlanarPose> {
  using type = Position<2>;
};
template <>
struct PositionsUnder<Pose> {
  using type = Position<3>;
};

template <typename Positions>
class AnyArm;

/// AnyArm type for tasks in Space.
template <typename Space>
using AnyArmFor = AnyArm<typename PositionsUnder<Space>::type>;

/// One type for all arms: in the plane with Positions = Position<2>, in space with Positions = Position<3>.
///
/// For programs that read the arm at run time. AnyArm is an arm whose number of joints is known at run time. Each
/// evaluation is one virtual call of the stored arm, which may have a fixed size. Immutable; copies share the stored
/// arm.
template <typename Positions>
class AnyArm {
 public:
  using Scalar = double;
  using Pose = typename PoseOver<Positions>::type;
  static constexpr int kDof = Eigen::Dynamic;

  /// arm: any arm with tasks in Positions and Pose.
  template <typename Arm>
  explicit AnyArm(const Arm& arm) : held_(std::make_shared<const Held<Arm>>(arm)), limits_(dynamic(arm.limits())) {}

  [[nodiscard]] int dof() const noexcept { return static_cast<int>(limits_.lower.size()); }
  [[nodiscard]] const JointLimits<kDof>& limits() const noexcept { return limits_; }

  /// Tip, J and Jd at (q, qd), for the task spaces Positions and Pose.
  template <typename Space>
  void kinematics(const Vector<kDof>& q, const Vector<kDof>& qd, Kinematics<Space, kDof>& out) const noexcept {
    held_->kinematics(q, &qd, out);
  }

  /// Tip and J at q. Jd does not change.
  template <typename Space>
  void kinematics(const Vector<kDof>& q, Kinematics<Space, kDof>& out) const noexcept {
    held_->kinematics(q, nullptr, out);
  }

 private:
  /// qd: null if Jd is not needed.
  struct Holder {
    Holder() = default;
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    virtual ~Holder() = default;
    virtual void kinematics(const Vector<kDof>& q, const Vector<kDof>* qd,
                            Kinematics<Positions, kDof>& out) const noexcept = 0;
    virtual void kinematics(const Vector<kDof>& q, const Vector<kDof>* qd,
                            Kinematics<Pose, kDof>& out) const noexcept = 0;
  };

  template <typename Arm>
  struct Held final : Holder {
    explicit Held(const Arm& arm) : arm_(arm) {}

    void kinematics(const Vector<kDof>& q, const Vector<kDof>* qd,
                    Kinematics<Positions, kDof>& out) const noexcept override {
      evaluate(q, qd, out);
    }
    void kinematics(const Vector<kDof>& q, const Vector<kDof>* qd,
                    Kinematics<Pose, kDof>& out) const noexcept override {
      evaluate(q, qd, out);
    }

   private:
    template <typename Space>
    void evaluate(const Vector<kDof>& q, const Vector<kDof>* qd, Kinematics<Space, kDof>& out) const noexcept {
      constexpr int N = Arm::kDof;
      if constexpr (N == kDof) {
        if (qd != nullptr) {
          arm_.kinematics(q, *qd, out);
        } else {
          arm_.kinematics(q, out);
        }
      } else {
        Kinematics<Space, N> sized;
        if (qd != nullptr) {
          arm_.kinematics(Vector<N>(q), Vector<N>(*qd), sized);
        } else {
          arm_.kinematics(Vector<N>(q), sized);
        }
        out.tip = sized.tip;
        out.length = sized.length;
        out.J = sized.J;
        if (qd != nullptr) out.Jd = sized.Jd;
      }
    }

    Arm arm_;
  };

  template <int N>
  [[nodiscard]] static JointLimits<kDof> dynamic(const JointLimits<N>& limits) {
    return {limits.lower,           limits.upper,        limits.velocity, limits.acceleration, limits.jerk,
            limits.velocity_offset, limits.deceleration, limits.effort,   limits.continuous};
  }

  std::shared_ptr<const Holder> held_;
  JointLimits<kDof> limits_;
};

}  // namespace fpbm
