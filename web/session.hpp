#pragma once

#include <algorithm>
#include <fpbm/bound/clearance.hpp>
#include <fpbm/model/robot.hpp>
#include <fpbm/objective/null_space.hpp>
#include <fpbm/path/path_follower.hpp>
#include <fpbm/realtime/tracker.hpp>
#include <fpbm/scheme/schemes.hpp>
#include <fpbm/target/target_filter.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "plain.hpp"

namespace page {

/// An arm with a scheme of either level, moved by a Tracker: on its path, or toward a dragged target.
template <typename Arm, typename Space, typename Path>
class Session final : public Simulator {
 public:
  static constexpr int N = Arm::kDof;
  using State = fpbm::State<N>;
  using JointVector = fpbm::Vector<N>;
  using Bounds = fpbm::JointLimits<N>;

  Session(const fpbm::Chain<>& chain, const std::vector<fpbm::LinkCapsule<>>& capsules, const Arm& arm,
          const Bounds& bounds, const JointVector& q0, const Path& path, const fpbm::TargetBounds<>& target_bounds,
          const Settings& settings)
      : robot_(chain),
        capsules_(capsules),
        arm_(arm),
        bounds_(bounds),
        start_{q0, JointVector::Zero()},
        path_(path),
        settings_(settings),
        tracker_(accelerations(start_, JointVector::Zero())),
        follower_(path, tip(), kRamp),
        filter_(tip(), target_bounds) {
    restart();
  }

  /// Continues from the current state with new settings. If the state exceeds the limits, the arm continues from rest.
  /// If the posture exceeds the limits, the arm restarts, and the function returns false.
  bool change(const Settings& settings) override {
    const bool same =
        settings.limited == settings_.limited && at_velocity_level(settings) == at_velocity_level(settings_);
    settings_ = settings;
    const auto [state, qdd] = motion();
    const State at_rest{state.q, JointVector::Zero()};
    if (same) {
      begin(state, qdd);
    } else if (admits(state)) {
      begin(state, JointVector::Zero());
    } else if (admits(at_rest)) {
      begin(at_rest, JointVector::Zero());
    } else {
      restart();
      return false;
    }
    return true;
  }

  void restart() override {
    begin(start_, JointVector::Zero());
    filter_.reset(tip());
    following_ = leaving_ = false;
    ticks_ = 0;
  }

  void follow_path() override {
    restart();
    follower_ = Follower(path_, tip(), kRamp);
    following_ = true;
  }

  /// A target at the current time. If the arm is on its path, it first stops.
  void push(const fpbm::Vector<3>& target) noexcept override {
    if (following_ && !leaving_) follower_.pause();
    leaving_ = following_;
    auto point = filter_.reference().x;
    place(point) = target.head<kAxes>();
    if (!following_) (void)filter_.push(point);
  }

  void ticks(int count) noexcept override {
    worst_ = fpbm::Status::kOk;
    scale_ = 1.0;
    for (int k = 0; k < count; ++k) tick();
  }

  void show(View& view) noexcept override {
    const State state = motion().first;
    const auto reference = now();
    const auto at = tip();
    view.dof = N;
    view.time = kTick * static_cast<double>(ticks_);
    view.status = static_cast<double>(worst_);
    view.scale = scale_;
    view.error = (place(reference) - place(at)).norm();
    view.following = following_ && !follower_.done() ? 1.0 : 0.0;
    std::copy_n(state.q.data(), N, view.q);
    std::copy_n(state.qd.data(), N, view.qd);
    std::copy_n(place(at).data(), kAxes, view.tip);
    std::copy_n(place(reference).data(), kAxes, view.reference);
    fpbm::RobotState<N> placed;
    robot_.update(state.q, placed);
    for (int i = 0; i <= N; ++i) {
      const fpbm::Transform<> link = robot_.frame(placed, i, robot_.in_joint(i, {}));
      std::copy_n(link.p.data(), 3, view.frames[i]);
      std::copy_n(link.R.data(), 9, view.frames[i] + 3);
    }
    for (std::size_t i = 0; i < capsules_.size(); ++i) {
      const auto& [link, capsule, name] = capsules_[i];
      view.capsules[i][0] = static_cast<double>(link);
      std::copy_n(capsule.a.data(), 3, view.capsules[i] + 1);
      std::copy_n(capsule.b.data(), 3, view.capsules[i] + 4);
      view.capsules[i][7] = capsule.radius;
    }
  }

 private:
  static constexpr int kAxes = Space::kRows - Space::kTurns;
  static constexpr double kTick = 1e-3;  ///< [s]
  static constexpr double kRamp = 0.2;   ///< Duration of the stop on the path [s].
  using Weights = fpbm::DiagonalWeights<N, double>;
  using AtVelocity = fpbm::Tracker<Arm, Space, fpbm::VelocityScheme<N, double, Weights>>;
  using AtAcceleration = fpbm::Tracker<Arm, Space, fpbm::AccelerationScheme<N, double, Weights>>;
  using Follower = fpbm::PathFollower<Path>;
  using Point = typename Space::template Point<double>;

  [[nodiscard]] static bool at_velocity_level(const Settings& settings) noexcept {
    return static_cast<Scheme>(settings.scheme) <= Scheme::kWmvn;
  }

  /// The position of a point.
  template <typename P>
  [[nodiscard]] static auto& place(P& point) noexcept {
    if constexpr (Space::kTurns > 0) {
      return point.p;
    } else {
      return point;
    }
  }

  template <fpbm::Level kLevel>
  [[nodiscard]] fpbm::Limits<kLevel, N> limits() const {
    return fpbm::Limits<kLevel, N>(settings_.limited != 0.0 ? bounds_ : Bounds::none(N), kTick);
  }

  [[nodiscard]] bool admits(const State& state) const {
    return at_velocity_level(settings_) ? limits<fpbm::Level::kVelocity>().admits(state, state)
                                        : limits<fpbm::Level::kAcceleration>().admits(state, state);
  }

  [[nodiscard]] Weights weights(bool all_one) const {
    return Weights(all_one ? JointVector::Ones() : JointVector(JointVector::Map(settings_.weights)));
  }

  [[nodiscard]] AtVelocity velocities(const State& state, const JointVector& qdd) const {
    const auto scheme =
        fpbm::WMVN<N>(weights(static_cast<Scheme>(settings_.scheme) == Scheme::kMvn), settings_.feedback);
    return AtVelocity(arm_, Space{}, scheme, state, {}, limits<fpbm::Level::kVelocity>(), qdd);
  }

  [[nodiscard]] AtAcceleration accelerations(const State& state, const JointVector& qdd) const {
    const auto kind = static_cast<Scheme>(settings_.scheme);
    const double alpha = kind == Scheme::kMan ? 0.0 : kind == Scheme::kFpbm ? settings_.alpha : 1.0;
    const double rate = kind == Scheme::kFpbm ? settings_.feedback : 0.0;
    const auto scheme = fpbm::FPBM<N>(alpha, weights(kind == Scheme::kMan), 2.0 * rate, rate * rate,
                                      fpbm::NullSpace<N>().with_damping(settings_.damping));
    fpbm::TrackerOptions<> options;
    options.null_damping = 0.0;  // The page also shows the schemes without damping.
    return AtAcceleration(arm_, Space{}, scheme, state, options, limits<fpbm::Level::kAcceleration>(), qdd);
  }

  void begin(const State& state, const JointVector& qdd) {
    if (at_velocity_level(settings_)) {
      tracker_ = velocities(state, qdd);
    } else {
      tracker_ = accelerations(state, qdd);
    }
  }

  void tick() noexcept {
    std::visit(
        [&](auto& tracker) noexcept {
          const auto result = following_ ? tracker.tick(follower_) : tracker.tick(filter_);
          worst_ = worse(worst_, result.status);
          scale_ = std::min(scale_, result.scale);
        },
        tracker_);
    ++ticks_;
    const auto reference = follower_.ahead(0.0);
    if (leaving_ && reference.xd.isZero(0.0) && reference.xdd.isZero(0.0)) {
      filter_.reset(reference.x);
      following_ = leaving_ = false;
    }
  }

  [[nodiscard]] std::pair<State, JointVector> motion() const noexcept {
    return std::visit([](const auto& tracker) { return std::pair(tracker.state(), tracker.acceleration()); }, tracker_);
  }
  [[nodiscard]] Point tip() const noexcept {
    return std::visit([](const auto& tracker) { return tracker.tip(); }, tracker_);
  }
  [[nodiscard]] Point now() const noexcept { return following_ ? follower_.ahead(0.0).x : filter_.reference().x; }

  fpbm::Robot<N> robot_;
  std::vector<fpbm::LinkCapsule<>> capsules_;
  Arm arm_;
  Bounds bounds_;
  State start_;
  Path path_;
  Settings settings_;
  std::variant<AtAcceleration, AtVelocity> tracker_;
  Follower follower_;
  fpbm::TargetFilter<Space> filter_;
  bool following_ = false;
  bool leaving_ = false;  ///< Whether the arm brakes on its path, to follow a target.
  double ticks_ = 0;
  fpbm::Status worst_ = fpbm::Status::kOk;
  double scale_ = 1.0;
};

}  // namespace page
