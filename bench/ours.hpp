#pragma once

#include "cases.hpp"

namespace bench {

/// A step of this library.
template <typename Case_, Law law>
class Ours {
 public:
  using Case = Case_;
  using Space = typename Case::Space;
  using Scalar = typename Case::Scalar;
  static constexpr int N = Case::kDof;
  static constexpr Law kLaw = law;
  static constexpr const char* kLibrary = "fpbm_cpp";

  void move(const Input<Space, N, Scalar>& input) noexcept {
    if constexpr (is_acceleration(law)) {
      arm_.kinematics(input.state.q, input.state.qd, kinematics_);
    } else {
      arm_.kinematics(input.state.q, kinematics_);
    }
  }
  fpbm::Status resolve(const Input<Space, N, Scalar>& input, fpbm::Vector<N, Scalar>& out) const noexcept {
    return scheme_.resolve(kinematics_, input.reference, input.state, out);
  }

 private:
  decltype(Case::Robot::arm().template cast<Scalar>()) arm_ = Case::Robot::arm().template cast<Scalar>();
  decltype(scheme<law, N, Scalar>()) scheme_ = scheme<law, N, Scalar>(arm_.dof());
  fpbm::Kinematics<Space, N, Scalar> kinematics_;
};

}  // namespace bench
