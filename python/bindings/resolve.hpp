#pragma once

#include <string>

#include "arrays.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

/// Joint motion of a scheme for an arm in a state, or in each of several states along a leading axis. The result is
/// returned and, if out is given, written to out. After an error, out has the motions of the preceding states.
Array resolve_for_arm(const Scheme& scheme, const Arm& arm, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& x,
                      const ArrayLike& xd, const OptionalArray& xdd, const std::string& task, const OptionalOut& out);

/// Joint motion of a scheme in one state, for tip, J and Jd from another library.
Array resolve_for_kinematics(const Scheme& scheme, const AnyKinematics& kinematics, const ArrayLike& q,
                             const ArrayLike& qd, const ArrayLike& x, const ArrayLike& xd, const OptionalArray& xdd,
                             const OptionalOut& out);

}  // namespace fpbm::bindings
