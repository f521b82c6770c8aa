#pragma once

#include "cases.hpp"

namespace bench {

/// A step of this library.
template <typename Case_, Law law>
class Ours {
 public:
  using Case = Case_;
  static constexpr int N = Case::kDof;
  static constexpr Law kLaw = law;
  static constexpr const char* kLibrary = "fpbm_cpp";

  void move(const Input<typename Case::Space, N>& input) noexcept {
    if constexpr (is_acceleration(law)) {
      arm_.kinematics(input.state.q, input.state.qd, kinematics_);
    } else {
      arm_.kinematics(input.state.q, kinematics_);
    }
  }
  fpbm::Status resolve(const Input<typename Case::Space, N>& input, fpbm::Vector<N>& out) const noexcept {
    return scheme_.resolve(kinematics_, input.reference, input.state, out);
  }

 private:
  typename Case::Robot::Arm arm_ = Case::Robot::arm();
  decltype(scheme<law, N>()) scheme_ = scheme<law, N>(arm_.dof());
  fpbm::Kinematics<typename Case::Space, N> kinematics_;
};

}  // namespace bench
