#pragma once

#include <string>

#include "arrays.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

/// The motion that a scheme asks an arm for in a state, or one in each of many, along a leading axis. It is written to
/// out, if that is given, and returned. After an error, out has the motions of the states before.
Array resolve_for_arm(const Scheme& scheme, const Arm& arm, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                      const ArrayLike& xd, const OptionalArray& xdd, const std::string& task, const OptionalOut& out);

/// The same for one state of an arm whose tip, J and Jd are from elsewhere.
Array resolve_for_kinematics(const Scheme& scheme, const AnyKinematics& kinematics, const ArrayLike& q,
                             const ArrayLike& qd, const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd,
                             const OptionalOut& out);

}  // namespace fpbm::bindings
