#pragma once

#include <Eigen/Core>
#include <memory>

#include "fpbm/core/status.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"
#include "fpbm/realtime/detail/require_stable.hpp"
#include "fpbm/scheme/detail/set_damping.hpp"

namespace fpbm {

/// One type for all schemes of one level for tasks in Space.
///
/// For programs that read the scheme or its number of joints at run time. AnyScheme is a scheme whose number of joints
/// is known at run time. Each evaluation is one virtual call of the stored scheme, which may have a fixed size.
/// Copies share the stored scheme, which is constant: set_damping() replaces the stored scheme by a changed copy.
template <Level kLevel_, typename Space>
class AnyScheme {
 public:
  static constexpr Level kLevel = kLevel_;
  static constexpr int kDof = Eigen::Dynamic;

  template <typename Scheme>
  explicit AnyScheme(const Scheme& scheme) : held_(std::make_shared<const Held<Scheme>>(scheme)) {
    static_assert(Scheme::kLevel == kLevel, "the scheme must have the level of the AnyScheme");
  }

  /// Throws std::invalid_argument if a parameter is for another number of joints.
  void require_dof(Eigen::Index dof) const { held_->require_dof(dof); }

  /// Joint velocities [rad/s] or accelerations [rad/s²].
  [[nodiscard]] Status resolve(const Kinematics<Space, kDof>& kinematics, const Reference<Space>& reference,
                               const State<kDof>& state, Vector<kDof>& u) const noexcept {
    return held_->resolve(kinematics, reference, state, u);
  }

  /// Feedback gains at acceleration level, or zero.
  [[nodiscard]] TaskGains<> gains() const noexcept { return held_->gains(); }

  friend void set_damping(AnyScheme& scheme, const DefaultDamping<>& damping) {
    scheme.held_ = scheme.held_->with(damping);
  }
  friend void require_stable(const AnyScheme& scheme, const TickOfGains<>& tick) {
    scheme.held_->require_stable_in(tick);
  }

 private:
  struct Holder {
    Holder() = default;
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    virtual ~Holder() = default;
    virtual void require_dof(Eigen::Index dof) const = 0;
    [[nodiscard]] virtual std::shared_ptr<const Holder> with(const DefaultDamping<>& damping) const = 0;
    [[nodiscard]] virtual TaskGains<> gains() const noexcept = 0;
    virtual void require_stable_in(const TickOfGains<>& tick) const = 0;
    [[nodiscard]] virtual Status resolve(const Kinematics<Space, kDof>& kinematics, const Reference<Space>& reference,
                                         const State<kDof>& state, Vector<kDof>& u) const noexcept = 0;
  };

  template <typename Scheme>
  struct Held final : Holder {
    explicit Held(const Scheme& scheme_) : scheme(scheme_) {}

    void require_dof(Eigen::Index dof) const override { scheme.require_dof(dof); }

    [[nodiscard]] std::shared_ptr<const Holder> with(const DefaultDamping<>& damping) const override {
      Scheme changed = scheme;
      give_damping(changed, damping);
      return std::make_shared<const Held>(changed);
    }

    [[nodiscard]] TaskGains<> gains() const noexcept override { return gains_of<double>(scheme); }

    void require_stable_in(const TickOfGains<>& tick) const override { require_stable(scheme, tick); }

    [[nodiscard]] Status resolve(const Kinematics<Space, kDof>& kinematics, const Reference<Space>& reference,
                                 const State<kDof>& state, Vector<kDof>& u) const noexcept override {
      constexpr int N = Scheme::kDof;
      if constexpr (N == kDof) {
        return scheme.resolve(kinematics, reference, state, u);
      } else {
        Kinematics<Space, N> sized;
        sized.tip = kinematics.tip;
        sized.J = kinematics.J;
        sized.length = kinematics.length;
        State<N> sized_state;
        sized_state.q = state.q;
        if constexpr (kLevel == Level::kAcceleration) {
          sized.Jd = kinematics.Jd;
          sized_state.qd = state.qd;
        }  // Velocity-level schemes read neither Jd nor qd.
        Vector<N> sized_u;
        const Status status = scheme.resolve(sized, reference, sized_state, sized_u);
        if (!failed(status)) u = sized_u;
        return status;
      }
    }

    Scheme scheme;
  };

  std::shared_ptr<const Holder> held_;
};

}  // namespace fpbm
