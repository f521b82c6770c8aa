#include "fpbm/core/detail/quickest_stop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "support/random.hpp"

/// The closed form of the shortest stop, compared with the motion along the stop, for bounds and states of every size.
namespace fpbm::test::quickest_stop_laws {
namespace {

template <typename Scalar>
class QuickestStops : public ::testing::Test {
 protected:
  static constexpr Scalar kEpsilon = std::numeric_limits<Scalar>::epsilon();

  struct Case {
    QuickestStop<Scalar> stop;
    AxisState<Scalar> state;
    Scalar duration;  ///< Upper bound on the duration of the stop.
    Scalar size;      ///< Size of the positions during the stop, for the round-off error.
  };

  /// Bounds that differ by up to ten orders of magnitude, and velocities from far below A²/J to far above A²/J.
  Case next() {
    const auto power = [this](double most) {
      return static_cast<Scalar>(std::pow(10.0, random_.uniform(-most, most)));
    };
    const Scalar A = power(2.0);
    const Scalar J = A * power(3.0);
    const Scalar a = A * static_cast<Scalar>(random_.uniform(-1.0, 1.0));
    const Scalar v = (random_.uniform(0.0, 1.0) < 0.5 ? Scalar(-1) : Scalar(1)) * A * A / J * power(1.5);
    const Scalar most = std::abs(v) + A * A / J;
    const Scalar duration = Scalar(2) * most / A + Scalar(4) * A / J;
    const Scalar q = most * duration * static_cast<Scalar>(random_.uniform(-1.0, 1.0));
    const bool unbounded = random_.uniform(0.0, 1.0) < 0.1;
    return {{unbounded ? std::numeric_limits<Scalar>::infinity() : A, J}, {q, v, a}, duration, most * duration};
  }

  Random random_{31};
};

using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(QuickestStops, Scalars, );

/// Simpson's rule is exact between two changes of the jerk. There are three changes.
TYPED_TEST(QuickestStops, are_motions_within_their_bounds_to_their_end_position) {
  using Scalar = TypeParam;
  constexpr int kSteps = 400;
  for (int i = 0; i < trials(2000); ++i) {
    const auto [stop, start, duration, size] = this->next();
    const auto where = "case " + std::to_string(i);
    const Scalar h = duration / kSteps;
    const Scalar bend = stop.jerk * h;  // Change of the acceleration in a step.
    Scalar displacement(0);
    AxisState<Scalar> now = stop.ahead(start, Scalar(0));
    ASSERT_NEAR(now.q, start.q, 64 * this->kEpsilon * size) << where;
    ASSERT_NEAR(now.v, start.v, 64 * this->kEpsilon * size / duration) << where;
    ASSERT_NEAR(now.a, start.a, 64 * this->kEpsilon * (std::abs(start.a) + size / duration / duration)) << where;
    for (int k = 1; k <= kSteps; ++k) {
      const auto middle = stop.ahead(start, (static_cast<Scalar>(k) - Scalar(0.5)) * h);
      const auto next = stop.ahead(start, static_cast<Scalar>(k) * h);
      const Scalar slack = 64 * this->kEpsilon * (std::abs(start.a) + size / duration / duration);
      ASSERT_LE(std::abs(next.a - now.a),
                bend * (1 + 64 * this->kEpsilon) + slack + 4 * this->kEpsilon * stop.jerk * duration);
      ASSERT_LE(std::abs(next.a),
                std::min(stop.acceleration, std::numeric_limits<Scalar>::max()) * (1 + 8 * this->kEpsilon))
          << where;
      ASSERT_NEAR(next.v - now.v, h * (now.a + next.a) / 2, bend * h / 4 + 256 * this->kEpsilon * size / duration)
          << where;
      displacement += h * (now.v + Scalar(4) * middle.v + next.v) / 6;
      ASSERT_NEAR(next.q, start.q + displacement, bend * h * h + 1024 * this->kEpsilon * size)
          << where << ", step " << k;
      now = next;
    }
    ASSERT_EQ(now.v, Scalar(0)) << where;
    ASSERT_EQ(now.a, Scalar(0)) << where;
    ASSERT_EQ(now.q, stop.end_position(start)) << where;
  }
}

/// From every later state of the stop, the remaining stop is the same.
TYPED_TEST(QuickestStops, continue_from_later_states) {
  using Scalar = TypeParam;
  for (int i = 0; i < trials(10000); ++i) {
    const auto [stop, start, duration, size] = this->next();
    const Scalar t = duration * static_cast<Scalar>(this->random_.uniform(0.0, 1.0));
    const Scalar s = duration * static_cast<Scalar>(this->random_.uniform(0.0, 1.0));
    const auto later = stop.ahead(start, t);
    ASSERT_NEAR(stop.end_position(later), stop.end_position(start), 512 * this->kEpsilon * size) << i;
    ASSERT_NEAR(stop.ahead(later, s).q, stop.ahead(start, t + s).q, 1024 * this->kEpsilon * size) << i;
  }
}

/// A tick with the acceleration u, then a stop from (v, a = u): the larger u is, the farther the stop ends.
TYPED_TEST(QuickestStops, end_farther_the_more_the_axis_accelerates) {
  using Scalar = TypeParam;
  for (int i = 0; i < trials(2000); ++i) {
    const auto [stop, start, duration, size] = this->next();
    const Scalar h = duration * static_cast<Scalar>(this->random_.uniform(1e-3, 0.1));
    const Scalar most = std::isinf(stop.acceleration) ? Scalar(2) * std::abs(start.a) : stop.acceleration;
    const auto held = [h, &from = start](Scalar u) {
      return AxisState<Scalar>{from.q + h * from.v + h * h * u / 2, from.v + h * u, u};
    };
    Scalar rest = stop.end_position(held(-most));
    for (int k = -19; k <= 20; ++k) {
      const auto state = held(most * static_cast<Scalar>(k) / 20);
      ASSERT_GE(stop.end_position(state), rest - 64 * this->kEpsilon * size) << i << ", " << k;
      rest = stop.end_position(state);
    }
  }
}

TYPED_TEST(QuickestStops, are_the_same_in_a_mirror) {
  using Scalar = TypeParam;
  for (int i = 0; i < trials(10000); ++i) {
    const auto [stop, start, duration, size] = this->next();
    const AxisState<Scalar> mirrored{-start.q, -start.v, -start.a};
    const Scalar t = duration * static_cast<Scalar>(this->random_.uniform(0.0, 1.0));
    ASSERT_EQ(stop.end_position(mirrored), -stop.end_position(start)) << i;
    const auto one = stop.ahead(start, t);
    const auto other = stop.ahead(mirrored, t);
    ASSERT_EQ(other.q, -one.q) << i;
    ASSERT_EQ(other.v, -one.v) << i;
    ASSERT_EQ(other.a, -one.a) << i;
  }
}

TYPED_TEST(QuickestStops, of_an_axis_at_rest_do_not_move) {
  const QuickestStop<TypeParam> stop{TypeParam(2), TypeParam(30)};
  const auto later = stop.ahead({TypeParam(0.7), TypeParam(0), TypeParam(0)}, TypeParam(0.1));
  EXPECT_EQ(later.q, TypeParam(0.7));
  EXPECT_EQ(later.v, TypeParam(0));
  EXPECT_EQ(later.a, TypeParam(0));
}

/// The root of a cubic is found as accurately as the number of rounds admits, and is never exceeded.
TYPED_TEST(QuickestStops, find_the_largest_below_zero) {
  using Scalar = TypeParam;
  for (int i = 0; i < trials(1000); ++i) {
    const auto root = static_cast<Scalar>(this->random_.uniform(0.05, 1.0));
    const auto cube = [&](Scalar x) { return x * x * x - root * root * root; };
    const Scalar found = largest_below_zero(cube, Scalar(0), Scalar(1), 20);
    ASSERT_LE(cube(found), Scalar(0));
    ASSERT_NEAR(found, root, 32 * this->kEpsilon / root) << i;
  }
  const auto above = [](Scalar) { return Scalar(1); };
  const auto below = [](Scalar) { return Scalar(-1); };
  EXPECT_EQ(largest_below_zero(above, Scalar(2), Scalar(3), 6), Scalar(2));
  EXPECT_EQ(largest_below_zero(below, Scalar(2), Scalar(3), 6), Scalar(3));
}

}  // namespace
}  // namespace fpbm::test::quickest_stop_laws
