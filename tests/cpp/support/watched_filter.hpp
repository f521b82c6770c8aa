#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>

#include "fpbm/target/stream.hpp"
#include "fpbm/target/target_filter.hpp"
#include "support/random.hpp"

namespace fpbm::test {

template <typename Space, typename Scalar>
struct FilterKind {
  using S = Space;
  using T = Scalar;
};

/// Spaces and scalars of the tests of a TargetFilter.
using FilterKinds = ::testing::Types<FilterKind<Position<2>, double>, FilterKind<Position<3>, float>,
                                     FilterKind<PlanarPose, double>, FilterKind<Pose, double>, FilterKind<Pose, float>>;

/// A random point of a space, within several metres and usually within several radians.
template <typename Space, typename Scalar>
typename Space::template Point<Scalar> random_point(Random& random, double size) {
  if constexpr (std::is_same_v<Space, Pose>) {
    const Vector<3, Scalar> turn = random.uniform(3, -2.0, 2.0).cast<Scalar>();
    return {random.uniform(3, -size, size).cast<Scalar>(), rotation(turn)};
  } else {
    return random.uniform(Space::kRows, -size, size).template cast<Scalar>();
  }
}

template <typename Space, typename Scalar>
TargetBounds<Scalar> random_bounds(Random& random) {
  const auto power = [&](double low, double high) {
    return static_cast<Scalar>(std::pow(10.0, random.uniform(low, high)));
  };
  TargetBounds<Scalar> bounds;
  for (auto [v, a, j] : {std::tie(bounds.velocity, bounds.acceleration, bounds.jerk),
                         std::tie(bounds.angular_velocity, bounds.angular_acceleration, bounds.angular_jerk)}) {
    v = power(-1.0, 0.5);
    a = power(0.0, 1.5);
    j = a * power(0.5, 2.7);
  }
  return bounds;
}

/// Advances tick by tick, and checks the bounds on velocity, acceleration and jerk, by the values of the reference and
/// by the displacement of each tick.
template <typename Space, typename Scalar, typename Filter_ = TargetFilter<Space, Scalar>>
class WatchedFilter {
 public:
  using Filter = Filter_;
  using Axes = AxesOf<Space, Scalar>;

  template <typename... Options>
  WatchedFilter(const typename Filter::Point& x0, const typename Axes::Bounds& bounds, const Options&... options)
      : filter(x0, bounds, options...), axes_(bounds, filter.dt()), dt_(filter.dt()) {}

  void advance() {
    const Reference<Space, Scalar> before = filter.reference();
    filter.advance();
    const Reference<Space, Scalar>& now = filter.reference();
    const auto displacement = Space::template difference<Scalar>(now.x, before.x);
    // A rotation that joins a stream curves within a tick.
    constexpr bool kStreams = std::is_same_v<Space, Pose> && !std::is_same_v<Filter, TargetFilter<Space, Scalar>>;
    constexpr Scalar kCurved = kStreams ? Scalar(3) : Scalar(1.001);
    constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();
    for (int i = 0; i < Space::kRows; ++i) {
      const auto [V, stop] = axes_(i);
      const auto [A, J] = stop;
      ASSERT_LE(std::abs(now.xd(i)), V * (1 + 256 * kEpsilon)) << i;
      ASSERT_LE(std::abs(now.xdd(i)), A * (1 + 64 * kEpsilon)) << i;
      ASSERT_LE(std::abs(now.xdd(i) - before.xdd(i)), J * dt_ * (1 + 64 * kEpsilon) + 64 * kEpsilon * A) << i;
      ASSERT_NEAR(now.xd(i) - before.xd(i), dt_ * (now.xdd(i) + before.xdd(i)) / 2,
                  J * dt_ * dt_ / 4 * kCurved + 64 * kEpsilon * V)
          << i;
      const Scalar size = extent(now.x) + extent(before.x);
      ASSERT_NEAR(displacement(i), dt_ * (now.xd(i) + before.xd(i)) / 2,
                  J * dt_ * dt_ * dt_ / 12 * kCurved + 64 * kEpsilon * (size + V))
          << i;
    }
  }

  /// Advances until the reference rests at a point, bitwise (an angle in the plane: up to round-off). Returns the
  /// number of ticks.
  int reach(const typename Filter::Point& x, int most) {
    for (int k = 0; k < most; ++k) {
      advance();
      if (::testing::Test::HasFatalFailure()) return most;
      if (filter.reference().xd.isZero(0) && filter.reference().xdd.isZero(0) && at(x)) return k + 1;
    }
    return most;
  }

  [[nodiscard]] bool at(const typename Filter::Point& x) const {
    if constexpr (std::is_same_v<Space, Pose>) {
      return filter.reference().x.p == x.p && filter.reference().x.R == x.R;
    } else {
      return Space::template difference<Scalar>(filter.reference().x, x).cwiseAbs().maxCoeff() <=
             Scalar(4) * std::numeric_limits<Scalar>::epsilon() * extent(x);
    }
  }

  Filter filter;

 private:
  Axes axes_;
  Scalar dt_;
};

}  // namespace fpbm::test
