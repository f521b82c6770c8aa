#pragma once

#include "cases.hpp"

namespace bench {

/// A step of this library, with or without damping near singular postures.
template <typename Case_, Law law, bool kDamping = false>
class Ours {
 public:
  using Case = Case_;
  using Space = typename Case::Space;
  using Scalar = typename Case::Scalar;
  static constexpr int N = Case::kDof;
  using Moved = fpbm::Kinematics<Space, N, Scalar>;
  static constexpr Law kLaw = law;
  static constexpr const char* kLibrary = kDamping ? "fpbm_cpp_damped" : "fpbm_cpp";

  Ours() {
    if constexpr (kDamping) scheme_.singular = fpbm::SingularDamping<Scalar>();
  }

  void move(const Input<Space, N, Scalar>& input) noexcept {
    if constexpr (is_acceleration(law)) {
      arm_.kinematics(input.state.q, input.state.qd, kinematics_);
    } else {
      arm_.kinematics(input.state.q, kinematics_);
    }
  }
  fpbm::Status resolve(const Input<Space, N, Scalar>& input, fpbm::Vector<N, Scalar>& out) const noexcept {
    return resolve(kinematics_, input, out);
  }
  /// For the kinematics of a state.
  fpbm::Status resolve(const Moved& kinematics, const Input<Space, N, Scalar>& input,
                       fpbm::Vector<N, Scalar>& out) const noexcept {
    return scheme_.resolve(kinematics, input.reference, input.state, out);
  }
  [[nodiscard]] const Moved& kinematics() const noexcept { return kinematics_; }

 private:
  decltype(Case::Robot::arm().template cast<Scalar>()) arm_ = Case::Robot::arm().template cast<Scalar>();
  decltype(scheme<law, N, Scalar>()) scheme_ = scheme<law, N, Scalar>(arm_.dof());
  Moved kinematics_;
};

}  // namespace bench
