#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "fpbm/target/target_filter.hpp"
#include "support/random.hpp"

/// Streams of targets from real senders: clocks that drift, jump and restart, and rounded orientations.
namespace fpbm::test::target_stream_laws {
namespace {

constexpr TargetBounds<> kBounds{0.5, 3.0, 100.0, 1.5, 8.0, 300.0};
template <typename Scalar>
TargetBounds<Scalar> bounds() {
  return {Scalar(0.5), Scalar(3), Scalar(100), Scalar(1.5), Scalar(8), Scalar(300)};
}
constexpr double kTick = 1e-3;
constexpr double kWindow = 10.0;  ///< Window of the estimated clock [s], as documented.

/// Largest deviation of RᵀR from the identity.
template <typename Scalar>
double skew(const Matrix<3, 3, Scalar>& R) {
  const Matrix<3, 3> wide = R.template cast<double>();
  return (wide.transpose() * wide - Matrix<3, 3>::Identity()).cwiseAbs().maxCoeff();
}

template <typename Scalar>
Transform<Scalar> rounded(const Vector<3>& turn, int decimals) {
  const double scale = std::pow(10.0, decimals);
  Transform<> x{Vector<3>::Zero(), rotation(turn)};
  x.R = x.R.unaryExpr([scale](double entry) { return std::round(entry * scale) / scale; });
  return x.cast<Scalar>();
}

/// Orientations with 4 to 7 decimals: velocity, acceleration and jerk, by differences of R, stay within the bounds.
TEST(TargetStream, rounded_orientations_keep_the_bounds) {
  for (int decimals = 4; decimals <= 7; ++decimals) {
    Random random(5);
    double acceleration = 0.0;
    double jerk = 0.0;
    int accepted = 0;
    for (int trial = 0; trial < trials(40); ++trial) {
      TargetFilter<Pose> filter({Vector<3>::Zero(), rotation(Vector<3>(random.uniform(3, -1.0, 1.0)))}, kBounds);
      Transform<> x = rounded<double>(random.uniform(3, -1.0, 1.0), decimals);
      if (!filter.push(x)) continue;
      ++accepted;
      Vector<3> w = Vector<3>::Zero();
      Vector<3> wd = Vector<3>::Zero();
      for (int k = 0; k < 4000; ++k) {
        if (k == 3000) {  // The same orientation farther away: no rotation.
          x.p(0) = 0.1;
          ASSERT_TRUE(filter.push(x));
        }
        const Matrix<3, 3> before = filter.reference().x.R;
        filter.advance();
        ASSERT_LE(skew<double>(filter.reference().x.R), 1e-14);
        const Vector<3> now = rotation_between<double>(filter.reference().x.R, before) / kTick;
        const Vector<3> change = (now - w) / kTick;
        acceleration = std::max(acceleration, change.cwiseAbs().maxCoeff());
        jerk = std::max(jerk, ((change - wd) / kTick).cwiseAbs().maxCoeff());
        w = now;
        wd = change;
        if (k == 3000) {
          ASSERT_TRUE(filter.reference().xd.tail<3>().isZero(0));
        }
      }
    }
    std::printf("%d decimals, %d accepted: angular acceleration %.4g (8), jerk %.4g (300)\n", decimals, accepted,
                acceleration, jerk);
    EXPECT_GE(accepted, decimals > 4 ? trials(40) : trials(40) / 2);
    EXPECT_LE(acceleration, 8.0 * 1.0001);
    EXPECT_LE(jerk, 300.0 * 1.1);  // A rotation about several axes curves within a tick.
  }
}

/// Deviations of RᵀR up to 1e-4 are corrected; larger deviations and reflections are rejected. A rotation does not
/// change bitwise.
template <typename Scalar>
void expect_orthonormal_targets() {
  Random random(6);
  constexpr Scalar kRound = 16 * std::numeric_limits<Scalar>::epsilon();
  for (int trial = 0; trial < 200; ++trial) {
    const Vector<3, Scalar> turn = random.uniform(3, -2.0, 2.0).cast<Scalar>();
    const Matrix<3, 3, Scalar> R = rotation(turn);
    Matrix<3, 3, Scalar> near = R;
    near.col(trial % 3) *= Scalar(1) + Scalar(4e-5) * (trial % 2 == 0 ? Scalar(1) : Scalar(-1));
    TargetFilter<Pose, Scalar> filter({Vector<3, Scalar>::Zero(), near}, bounds<Scalar>());
    EXPECT_LE(skew<Scalar>(filter.reference().x.R), kRound);
    ASSERT_TRUE(filter.reset({Vector<3, Scalar>::Zero(), R}));
    EXPECT_EQ(filter.reference().x.R, R);
    ASSERT_TRUE(filter.reset({Vector<3, Scalar>::Zero(), near}));
    EXPECT_LE(skew<Scalar>(filter.reference().x.R), kRound);
    // The nearest rotation: a scaling along an axis does not rotate it.
    EXPECT_LE((filter.reference().x.R - R).cwiseAbs().maxCoeff(), kRound);
    Matrix<3, 3, Scalar> far = R;
    far.col(1) *= Scalar(1.0002);
    EXPECT_FALSE(filter.reset({Vector<3, Scalar>::Zero(), far}));
    EXPECT_FALSE(filter.push({Vector<3, Scalar>::Zero(), far}));
    EXPECT_FALSE(filter.push({Vector<3, Scalar>::Zero(), Matrix<3, 3, Scalar>(-R)}));
  }
}

TEST(TargetStream, orientations_become_orthonormal) {
  expect_orthonormal_targets<double>();
  expect_orthonormal_targets<float>();
}

/// A target that moves at 0.1 m/s back and forth, 30 times a second.
Vector<2> zigzag(double t) {
  const double phase = std::fmod(t, 8.0);
  return {0.1 * (phase < 4.0 ? phase : 8.0 - phase), 0.0};
}

/// A clock of the sender with a drift of up to ±1e-3: the error is at most drift × window × speed, plus the effect of
/// jitter.
TEST(TargetStream, follows_a_clock_that_drifts) {
  for (const double jitter : {0.0, 0.02}) {
    for (const double drift : {0.0, -5e-5, 5e-5, -2e-4, 2e-4, -5e-4, 5e-4, -1e-3, 1e-3}) {
      Random random(7);
      TargetFilter<Position<2>> filter({0.0, 0.0}, kBounds);
      std::vector<std::array<double, 2>> seen;  // Arrival and time of each target [s].
      for (int k = 0; k < trials(3000); ++k) {
        if (k > 0 && jitter > 0.0 && random.uniform(0.0, 1.0) < 0.1) continue;
        seen.push_back({k / 30.0 + (k > 0 ? random.uniform(0.0, jitter) : 0.0), k / 30.0});
      }
      double worst = 0.0;
      std::size_t next = 0;
      for (int tick = 0; next < seen.size(); ++tick) {
        const double t = tick * kTick;
        for (; next < seen.size() && seen[next][0] <= t; ++next) {
          ASSERT_TRUE(filter.push(zigzag(seen[next][1]), 1e5 + seen[next][1] * (1 + drift)));
        }
        const double phase = std::fmod(t, 4.0);
        if (t > 8.0 && phase > 2.0 && phase < 3.9) {
          worst = std::max(worst, (filter.reference().x - zigzag(t)).norm());
        }
        filter.advance();
      }
      const double bound = 0.1 * (std::abs(drift) * kWindow + kTick * (jitter > 0.0 ? 2 : 1));
      std::printf("drift %+.0e, jitter %2.0f ms: error %.3f mm, bound %.3f mm\n", drift, 1e3 * jitter, 1e3 * worst,
                  1e3 * bound);
      EXPECT_LE(worst, bound) << drift;
    }
  }
}

/// A stream at 30 Hz of a motion with constant velocity.
template <typename Space, typename Scalar>
class Stream {
 public:
  using Filter = TargetFilter<Space, Scalar>;
  using Point = typename Filter::Point;

  Stream() : filter(Space::template origin<Scalar>(), bounds<Scalar>()) {}

  [[nodiscard]] Point where(double t) const {
    return Space::template displace<Scalar>(Space::template origin<Scalar>(),
                                            Vector<Space::kRows, Scalar>::Constant(Scalar(0.1 * t)));
  }
  /// Runs to the time `until`. Stamps are ahead of the time of the sender by `offset`. Returns the number of rejected
  /// messages.
  int run(double until, double offset) {
    int rejected = 0;
    for (; ticks * kTick < until; ++ticks) {
      if (ticks % 33 == 0) rejected += filter.push(where(ticks * kTick), ticks * kTick + offset) ? 0 : 1;
      filter.advance();
    }
    return rejected;
  }
  [[nodiscard]] double lag() const {
    return static_cast<double>(
        Space::template difference<Scalar>(where(ticks * kTick), filter.reference().x).cwiseAbs().maxCoeff());
  }

  Filter filter;
  int ticks = 0;
};

template <typename Kind>
class TargetStreams : public ::testing::Test {};
template <typename Space_, typename Scalar_>
struct Kind {
  using Space = Space_;
  using Scalar = Scalar_;
};
using Kinds = ::testing::Types<Kind<Position<2>, double>, Kind<PlanarPose, float>, Kind<Pose, double>>;
TYPED_TEST_SUITE(TargetStreams, Kinds, );

/// A stamp from the future is rejected, and changes no bit of the motion.
TYPED_TEST(TargetStreams, a_stamp_from_the_future_changes_nothing) {
  using S = Stream<typename TypeParam::Space, typename TypeParam::Scalar>;
  for (const double ahead : {0.3, 10.0, 1e300}) {
    for (const int strays : {1, 5}) {
      S pure;
      S stray;
      for (int moment = 1; moment <= 5; ++moment) {
        const double t = 0.71 * moment;
        ASSERT_EQ(pure.run(t, 1e5), 0);
        ASSERT_EQ(stray.run(t, 1e5), 0) << ahead;
        for (int i = 0; i < strays; ++i) {
          ASSERT_FALSE(stray.filter.push(stray.where(-50.0), 1e5 + t + ahead * (1 + i))) << ahead;
          ASSERT_FALSE(
              stray.filter.push_twist(S::Filter::Twist::Constant(typename TypeParam::Scalar(-1)), 1e5 + t + ahead))
              << ahead;
        }
        ASSERT_EQ(stray.filter.reference().xd, pure.filter.reference().xd);
        ASSERT_EQ(stray.filter.reference().xdd, pure.filter.reference().xdd);
      }
      EXPECT_LE(stray.lag(), 1e-4);
    }
  }
}

/// If the first stamp is from the future, the stream is followed within the timeout and three messages.
TYPED_TEST(TargetStreams, a_first_stamp_from_the_future_does_not_block) {
  for (const double ahead : {0.05, 0.15, 0.3, 10.0, 1e9}) {
    Stream<typename TypeParam::Space, typename TypeParam::Scalar> stream;
    ASSERT_TRUE(stream.filter.push(stream.where(0.0), 1e5 + ahead));
    ASSERT_LE(stream.run(2.0, 1e5), 9) << ahead;
    ASSERT_EQ(stream.run(20.0, 1e5), 0);
    EXPECT_LE(stream.lag(), 1e-4) << ahead;
  }
}

/// A clock that restarts at 0, or is set forward or back: the stream is followed within the timeout and three messages.
TYPED_TEST(TargetStreams, a_clock_that_is_set_is_estimated_again) {
  for (const double step : {-1e5, -3600.0, -1.0, -0.3, 0.3, 1.0, 3600.0, 1e7}) {
    Stream<typename TypeParam::Space, typename TypeParam::Scalar> stream;
    ASSERT_EQ(stream.run(3.0, 1e5), 0);
    ASSERT_LE(stream.run(3.4, 1e5 + step), 9) << step;
    ASSERT_EQ(stream.run(7.0, 1e5 + step), 0) << step;
    EXPECT_LE(stream.lag(), 1e-4) << step;
  }
}

/// After a silence, the stream is followed, whether the clock of the sender continues or restarts.
TYPED_TEST(TargetStreams, a_pause_does_not_block) {
  for (const double step : {-1e5, -20.0, 0.0, 0.01, 5.0, 100.0}) {
    Stream<typename TypeParam::Space, typename TypeParam::Scalar> stream;
    ASSERT_EQ(stream.run(3.0, 1e5), 0);
    for (; stream.ticks < 23001; ++stream.ticks) stream.filter.advance();
    ASSERT_EQ(stream.run(24.0, 1e5 + step), 0) << step;
    ASSERT_EQ(stream.run(31.0, 1e5 + step), 0) << step;  // The target is 2 m away by then.
    EXPECT_LE(stream.lag(), 1e-4) << step;
  }
}

/// Any number of old messages is rejected: duplicates, bursts in order, reordered messages, and messages of a second
/// sender.
TEST(TargetStream, old_messages_stay_rejected) {
  Random random(8);
  StampClock<double> clock(kTick, 0.2, {});
  double newest = -1.0;
  for (int k = 0; k < trials(60000); ++k) {
    const double t = k * kTick;
    if (k % 10 == 0) {  // 100 Hz, up to 0.1 s late: reordered by up to ten positions.
      const double stamp = t - random.uniform(0.0, 0.1);
      ASSERT_EQ(clock.accept(stamp).has_value(), stamp > newest || k == 0) << k;
      newest = std::max(newest, stamp);
    }
    if (k % 100 == 50) {  // A queue that is flushed.
      for (int i = 20; i >= 0; --i) ASSERT_FALSE(clock.accept(newest - 0.033 * i)) << k;
    }
    if (k % 30 == 7) {
      ASSERT_FALSE(clock.accept(t - 5e4)) << k;  // A second sender.
      ASSERT_FALSE(clock.accept(std::numeric_limits<double>::quiet_NaN()));
    }
    clock.advance();
  }
  for (int k = 0; k < 5000; ++k) {  // A message that is sent again and again.
    if (k % 20 == 0) {
      ASSERT_FALSE(clock.accept(newest)) << k;
    }
    if (k % 20 == 3) {
      ASSERT_FALSE(clock.accept(newest - 0.1)) << k;
    }
    clock.advance();
  }
}

}  // namespace
}  // namespace fpbm::test::target_stream_laws
