#pragma once

#include "fpbm/core/detail/has_member.hpp"
#include "fpbm/core/status.hpp"

/// Types of the members of a bound (docs/architecture.md, Add a bound).
namespace fpbm::bound_member {

template <typename Bound>
using RowCount = decltype(int{Bound::kRows});
template <typename Bound>
using StatusOfRows = decltype(Status{Bound::kStatus});
template <typename Bound>
using Empty = decltype(bool{std::declval<const Bound&>().empty()});
template <typename Bound, typename JointVector>
using Require = decltype(std::declval<Bound&>().require(std::declval<const JointVector&>()));
template <typename Bound, typename Next, typename Rows_>
using WriteRows = decltype(std::declval<Bound&>().rows(std::declval<const Next&>(), std::declval<Rows_&>()));
template <typename Bound, typename Limits_, typename From, typename Stop_>
using Accepts = decltype(bool{std::declval<Bound&>().accepts(std::declval<const Limits_&>(),
                                                             std::declval<const From&>(),
                                                             std::declval<const Stop_&>())});
template <typename Bound, typename JointVector, typename F>
using Gaps = decltype(std::declval<Bound&>().gaps(std::declval<const JointVector&>(), typename JointVector::Scalar(),
                                                  std::declval<const F&>()));
/// Members of a bound on torques.
template <typename Bound, typename Limits_>
using RequireLimits = decltype(std::declval<const Bound&>().require_limits(std::declval<const Limits_&>()));
template <typename Bound, typename Scalar>
using SlowerStop = decltype(std::declval<const Bound&>().slower_stop(Scalar()));
template <typename Bound>
using Models = decltype(std::declval<const Bound&>().models());
/// Member of a bound on speeds.
template <typename Bound, typename JointVector>
using SpeedRatio = decltype(std::declval<Bound&>().speed_ratio(std::declval<const JointVector&>(),
                                                               std::declval<const JointVector&>()));
/// Member of a bound that knows shapes, as a Clearance. The bound also has near_distance_sum() and away(q).
template <typename Bound>
using MovesAway = decltype(std::declval<const Bound&>().moves_away());

}  // namespace fpbm::bound_member
