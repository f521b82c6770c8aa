#include "fpbm/realtime/tracker_batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "fpbm/core/lanes.hpp"
#include "fpbm/fpbm.hpp"
#include "support/arms.hpp"

/// Trackers in SIMD lanes move like single trackers.
namespace fpbm::test::tracker_batch_laws {
namespace {

constexpr int kLanes = 2;
using In = Lanes<kLanes>;

/// Schemes of one level with different parameters, one for each lane, and one scheme for all lanes.
template <Level kLevel, int N>
struct Laws {
  static Vector<N> weights(double lane) { return Vector<N>::LinSpaced(1.0, 2.0 + lane); }

  static auto of(double lane) {
    if constexpr (kLevel == Level::kVelocity) {
      return WMVN<N>(weights(lane), 5.0 + lane, {}, SingularDamping<>());
    } else {
      return FPBM<N>(0.3 + 0.4 * lane, weights(lane), 10.0 + lane, 25.0, NullSpace<N>().with_damping(2.0),
                     SingularDamping<>());
    }
  }
  using Law = decltype(of(0.0));

  static auto side_by_side() {
    const std::vector<Law> laws{of(0.0), of(1.0)};
    const auto weights = DiagonalWeights<N, In>::side_by_side([&](auto lane) -> auto& {
      return laws[static_cast<std::size_t>(lane)].weights;
    });
    const auto null_space = NullSpace<N, In>::side_by_side([&](auto lane) -> auto& {
      return laws[static_cast<std::size_t>(lane)].null_space;
    });
    const SingularDamping<In> singular;
    const In lane([](auto i) { return static_cast<double>(i); });
    if constexpr (kLevel == Level::kVelocity) {
      return VelocityScheme<N, In>(weights, In(5.0) + lane, null_space, singular);
    } else {
      return AccelerationScheme<N, In>(In(0.3) + In(0.4) * lane, weights, In(10.0) + lane, In(25.0), null_space,
                                       singular);
    }
  }
};

struct Planar {
  static constexpr int N = 4;
  using Space = Position<2>;
  static auto arm() { return PlanarArm<4>(Vector<4>(1.0, 0.8, 0.6, 0.4)); }
  static Vector<4> start(double offset) { return Vector<4>(0.3, 0.8 + offset, 0.6, 0.5 - offset); }
  static Vector<4> singular() { return Vector<4>(0.4, 0.01, -0.01, 0.02); }
  static auto path(double size) { return Path(Circle<>(size), 1.0); }
};

template <typename Space_>
struct Panda {
  static constexpr int N = 7;
  using Space = Space_;
  static auto arm() { return SerialArm<7>(presets::panda()); }
  static Vector<7> start(double offset) {
    Vector<7> q;
    q << 0.0, -0.3 + offset, 0.0, -2.2 - offset, 0.0, 2.0 + offset, 0.785;
    return q;
  }
  static Vector<7> singular() {
    Vector<7> q;
    if constexpr (std::is_same_v<Space, Pose>) {
      q << 0.0, 0.0, 0.0, -0.01, 0.0, 0.01, 0.0;
    } else {
      q << -0.38, 1.315, -0.847, -0.412, -1.571, 2.453, 0.0;
    }
    return q;
  }
  static auto path(double size) {
    const InPlane circle(Path(Circle<>(size), 1.0), Vector<3>(0, 1, 0), Vector<3>(0, 0, 1));
    if constexpr (std::is_same_v<Space, Pose>) {
      return WithRotation(circle, Vector<3>(2.0 * size, 0.0, 4.0 * size));
    } else {
      return circle;
    }
  }
};

template <typename Case_, Level kLevel_>
struct Subject {
  using Case = Case_;
  static constexpr Level kLevel = kLevel_;
};

/// Motions of a subject, in lanes and alone.
template <typename Subject>
struct Motions {
  using Case = typename Subject::Case;
  using Space = typename Case::Space;
  static constexpr Level kLevel = Subject::kLevel;
  static constexpr int N = Case::N;
  using Law = typename Laws<kLevel, N>::Law;
  using Arm = decltype(Case::arm());
  using Starts = std::array<Vector<N>, kLanes>;

  /// jerk: as a multiple of the bound on acceleration [1/s].
  static Limits<kLevel, N> limits(double velocity, double jerk = std::numeric_limits<double>::infinity()) {
    auto bounds = JointLimits<N>::none(N);
    for (int i = 0; i < N; ++i) bounds.set(i, {-3.5, 3.9, velocity, 10.0 * velocity, jerk * 10.0 * velocity});
    return {bounds, kTick};
  }

  static auto trackers(const Starts& starts, double velocity, const TrackerOptions<>& options,
                       double jerk = std::numeric_limits<double>::infinity()) {
    std::vector<Tracker<Arm, Space, Law>> all;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      all.emplace_back(Case::arm(), Space{}, Laws<kLevel, N>::of(static_cast<double>(lane)),
                       State<N>{starts[lane], Vector<N>::Zero()}, options, limits(velocity, jerk));
    }
    return all;
  }
  static auto batch(const std::vector<Tracker<Arm, Space, Law>>& trackers) {
    return TrackerBatch(Case::arm().template cast<In>(), Space{}, Laws<kLevel, N>::side_by_side(), trackers);
  }

  /// Compares a motion in lanes with the motions alone, sample by sample. Returns the worst status.
  static Status expect_agreement(const Starts& starts, double size, double velocity, double tolerance,
                                 const TrackerOptions<>& options) {
    const auto path = Case::path(size);
    auto alone = trackers(starts, velocity, options);
    auto all = batch(alone);
    std::vector<Sample<Space, N, In>> seen;
    EXPECT_EQ(track_batch(all, path, grid(), [&](const auto& sample) { seen.push_back(sample); }), grid().samples());
    Status worst = Status::kOk;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      PathFollower follower(path, alone[lane].tip());
      double difference = 0.0;
      const auto result = track(alone[lane], follower, grid(), [&](const auto& one, const auto&) {
        const auto& same = seen[static_cast<std::size_t>(one.index)];
        EXPECT_EQ(same.t, one.t);
        difference = std::max(
            {difference, (lane_of(same.q, lane) - one.q).norm(), (lane_of(same.qd, lane) - one.qd).norm(),
             kTick * (lane_of(same.qdd, lane) - one.qdd).norm(), (lane_of(same.error, lane) - one.error).norm(),
             (lane_of(same.J, lane) - one.J).norm(), (lane_of(same.reference.xdd, lane) - one.reference.xdd).norm()});
      });
      EXPECT_LE(difference, tolerance) << lane;
      EXPECT_EQ(all.status()[lane], result.status) << lane;
      worst = worse(worst, result.status);
    }
    return worst;
  }

  static TimeGrid<> grid() { return {1.0, kTick, 0.2}; }
  static constexpr double kTick = 4e-3;
  static TrackerOptions<> options() {
    TrackerOptions<> result;
    result.dt = kTick;
    return result;
  }
};

template <typename Subject>
class TrackerBatchLaws : public testing::Test {};

#ifdef FPBM_FEW_TYPES
using Subjects = testing::Types<Subject<Planar, Level::kVelocity>, Subject<Panda<Pose>, Level::kAcceleration>>;
#else
// Both levels, and each type of factorisation of J once (two rows, several redundant joints, one redundant joint).
using Subjects = testing::Types<Subject<Planar, Level::kVelocity>, Subject<Panda<Position<3>>, Level::kAcceleration>,
                                Subject<Panda<Pose>, Level::kAcceleration>>;
#endif
TYPED_TEST_SUITE(TrackerBatchLaws, Subjects, );

TYPED_TEST(TrackerBatchLaws, move_without_limits_like_single_trackers) {
  using All = Motions<TypeParam>;
  using Case = typename TypeParam::Case;
  auto options = All::options();
  EXPECT_EQ(All::expect_agreement({Case::start(0.0), Case::start(0.1)}, 0.03, 50.0, 1e-12, options), Status::kOk);
  options.integral_gain = 0.5;
  options.error_bound = 1e-5;  // Some errors exceed the bound.
  EXPECT_EQ(All::expect_agreement({Case::start(0.0), Case::start(0.1)}, 0.03, 50.0, 1e-12, options), Status::kOk);
}

TYPED_TEST(TrackerBatchLaws, keep_their_limits_like_single_trackers) {
  using All = Motions<TypeParam>;
  using Case = typename TypeParam::Case;
  constexpr int N = Case::N;
  const auto options = All::options();
  const std::array<Vector<N>, kLanes> starts{Case::start(0.0), Case::start(0.1)};
  EXPECT_EQ(All::expect_agreement(starts, 0.1, 0.2, 1e-9, options), Status::kSlowed);

  auto impatient = options;
  impatient.stall_time = 0.03;
  EXPECT_EQ(All::expect_agreement(starts, 5.0, 0.5, 1e-9, impatient), Status::kStalled);  // Unreachable.

  const auto limits = All::limits(0.2);
  auto all = All::batch(All::trackers(starts, 0.2, options));
  double fastest = 0.0;
  (void)track_batch(all, Case::path(0.1), All::grid(), [&](const auto& sample) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto& tracker = all.trackers()[lane];
      EXPECT_NO_THROW(limits.require_viable(tracker.state(), tracker.acceleration()));
      fastest = std::max(fastest, lane_of(sample.qd, lane).cwiseAbs().maxCoeff());
    }
  });
  EXPECT_LE(fastest, 0.2 + 1e-12);
  EXPECT_GT(fastest, 0.199);
}

/// Each tick starts from equal states, because a long motion on limits with bounds on jerk amplifies round-off errors.
TYPED_TEST(TrackerBatchLaws, tick_from_equal_states_like_single_trackers) {
  using All = Motions<TypeParam>;
  using Case = typename TypeParam::Case;
  using Space = typename Case::Space;
  constexpr int N = Case::N;
  const auto path = Case::path(0.1);
  for (const double jerk : {std::numeric_limits<double>::infinity(), 100.0, 20.0}) {
    for (const double velocity : {0.2, 0.5}) {
      auto all = All::batch(All::trackers({Case::start(0.0), Case::start(0.1)}, velocity, All::options(), jerk));
      const std::array<typename Space::template Point<double>, kLanes> tips{all.trackers()[0].tip(),
                                                                            all.trackers()[1].tip()};
      PathFollower follower(path, Space::template origin<double>());
      Sample<Space, N, In> sample;
      double difference = 0.0;  // Largest difference of accelerations, relative to their bound.
      int limited = 0;
      for (int k = 0; k < All::grid().samples(); ++k) {
        const auto ahead = [&follower](double seconds) noexcept { return follower.ahead(seconds); };
        const auto displacements = TickReferences<Space, double>::of(ahead, All::kTick);
        auto alone = all.trackers();
        all.tick(displacements, sample);
        follower.advance(All::kTick);
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
          const auto tick = alone[lane].advance(displacements.template from<double>(tips[lane]));
          if (tick.status == Status::kSlowed || tick.saturated != 0) ++limited;
          const auto& same = all.trackers()[lane];
          const auto apart = [](const Vector<N>& one, const Vector<N>& other) {
            return (one - other).cwiseAbs().maxCoeff();
          };
          difference = std::max({difference, apart(same.state().q, alone[lane].state().q),
                                 apart(same.state().qd, alone[lane].state().qd),
                                 apart(same.acceleration(), alone[lane].acceleration()) / (10.0 * velocity)});
        }
      }
      std::printf("jerk %g, velocity %g: %d limited ticks, %.1e apart\n", jerk, velocity, limited, difference);
      EXPECT_LE(difference, 1e-9) << jerk << ' ' << velocity;
      EXPECT_GT(limited, 0) << jerk << ' ' << velocity;
    }
  }
}

/// Bitwise, in any lane, for all contents of the other lanes.
TYPED_TEST(TrackerBatchLaws, do_not_influence_one_another) {
  using All = Motions<TypeParam>;
  using Case = typename TypeParam::Case;
  constexpr int N = Case::N;
  const auto options = All::options();
  for (const double velocity : {0.2, 50.0}) {
    const auto run = [&](std::size_t lane, const Vector<N>& here, const Vector<N>& there) {
      std::array<Vector<N>, kLanes> starts{there, there};
      starts[lane] = here;
      auto all = All::batch(All::trackers(starts, velocity, options));
      (void)track_batch(all, Case::path(0.1), All::grid(), [](const auto&) {});
      return std::make_pair(all.trackers()[lane].state(), all.status());
    };
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto [same, calm] = run(lane, Case::start(0.0), Case::start(0.05));
      const auto [state, mixed] = run(lane, Case::start(0.0), Case::singular());
      EXPECT_EQ(same.q, state.q);
      EXPECT_EQ(same.qd, state.qd);
      EXPECT_EQ(calm[lane], mixed[lane]);
      EXPECT_GE(mixed[1 - lane], Status::kDamped);
    }
  }
}

/// If damping acts in every tick, the trackers compute all ticks themselves: bitwise the same result.
TYPED_TEST(TrackerBatchLaws, compute_nearly_singular_postures_like_single_trackers) {
  using All = Motions<TypeParam>;
  using Case = typename TypeParam::Case;
  const auto start = Case::singular();
  EXPECT_EQ(All::expect_agreement({start, start}, 1e-4, 50.0, 1e-13, All::options()), Status::kDamped);

  const auto path = Case::path(1e-4);
  auto alone = All::trackers({start, start}, 50.0, All::options());
  auto all = All::batch(alone);
  PathFollower follower(path, alone[1].tip());
  bool damped = true;
  (void)track(alone[1], follower, All::grid(),
              [&](const auto&, const auto& tick) { damped = damped && tick.status == Status::kDamped; });
  (void)track_batch(all, path, All::grid(), [](const auto&) {});
  EXPECT_TRUE(damped);
  EXPECT_EQ(all.trackers()[1].state().q, alone[1].state().q);
  EXPECT_EQ(all.trackers()[1].state().qd, alone[1].state().qd);
}

TYPED_TEST(TrackerBatchLaws, end_if_the_recorder_returns_false) {
  using All = Motions<TypeParam>;
  using Case = typename TypeParam::Case;
  const auto options = All::options();
  auto all = All::batch(All::trackers({Case::start(0.0), Case::start(0.1)}, 50.0, options));
  int seen = 0;
  EXPECT_EQ(track_batch(all, Case::path(0.03), All::grid(), [&](const auto&) { return ++seen < 7; }), 7);
  EXPECT_EQ(seen, 7);
  auto few = All::trackers({Case::start(0.0), Case::start(0.1)}, 50.0, options);
  few.pop_back();
  EXPECT_EQ(complaint([&] { (void)All::batch(few); }), "trackers has 1 entries: must have 2, one per lane");
}

}  // namespace
}  // namespace fpbm::test::tracker_batch_laws
