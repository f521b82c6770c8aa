#pragma once

#include <array>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tree_ticks.hpp"

// Motions with the longest ticks. search_worst.cpp finds them, worst_motions.txt contains them, worst.cpp measures
// them, and `fpbm-cpp bench --worst` runs Python's trackers with the same numbers.
namespace bench {

/// Numbers in [-1, 1] that define a motion: the start posture, then phases. In each phase, the target jumps to a pose
/// near the start pose and continues from there with a constant velocity.
using Numbers = std::vector<double>;

constexpr int kPhases = 6;
constexpr int kPhaseNumbers = 13;  ///< Numbers of a phase: displacement, rotation, their rates, duration.
constexpr double kFar = 0.8;       ///< Largest displacement along each axis [m].
constexpr double kTurn = 1.5;      ///< Largest rotation about each axis [rad].
constexpr double kFast = 1.5;      ///< Largest rate along or about each axis [m/s, rad/s].
constexpr int kShortest = 10;      ///< Ticks of a phase.
constexpr int kLongest = 160;

struct Phase {
  fpbm::Vector<3> displacement;
  fpbm::Vector<3> turned;
  fpbm::Vector<6> rates;
  int ticks;

  Phase(const Numbers& numbers, std::size_t first) {
    for (int i = 0; i < 3; ++i) {
      displacement(i) = kFar * numbers[first + static_cast<std::size_t>(i)];
      turned(i) = kTurn * numbers[first + 3 + static_cast<std::size_t>(i)];
    }
    for (int i = 0; i < 6; ++i) rates(i) = kFast * numbers[first + 6 + static_cast<std::size_t>(i)];
    ticks = kShortest + static_cast<int>((numbers[first + 12] + 1.0) / 2.0 * (kLongest - kShortest));
  }
};

/// Moves a target relative to its start pose, s seconds after the jump of a phase.
inline void move(fpbm::Reference<fpbm::Pose>& target, const fpbm::Transform<>& start, const Phase& phase, double s) {
  const fpbm::Vector<3> angles = phase.turned + s * phase.rates.tail<3>();
  target.x.p = start.p + phase.displacement + s * phase.rates.head<3>();
  target.x.R = fpbm::rotation(angles) * start.R;
  target.xd = phase.rates;
}
inline void move(fpbm::Reference<fpbm::Position<3>>& target, const fpbm::Vector<3>& start, const Phase& phase,
                 double s) {
  target.x = start + phase.displacement + s * phase.rates.head<3>();
  target.xd = phase.rates.head<3>();
}
/// For the second task of a stack with a grasp, and for the hand and the elbow of other stacks.
template <typename... Levels, typename Point>
void move(fpbm::Reference<fpbm::StackSpace<Levels...>>& target, const Point& start, const Phase& phase, double s) {
  constexpr bool kGrasp =
      sizeof...(Levels) == 3 && !std::is_same_v<std::decay_t<decltype(std::get<1>(start))>, fpbm::Vector<3>>;
  constexpr int kMoved = kGrasp ? 1 : 0;
  auto pose = fpbm::Reference<fpbm::Pose>::hold(std::get<kMoved>(start));
  move(pose, std::get<kMoved>(start), phase, s);
  std::get<kMoved>(target.x) = pose.x;
  target.xd.template segment<6>(6 * kMoved) = pose.xd;
  if constexpr (!kGrasp) std::get<1>(target.x) = std::get<1>(start) - phase.displacement / 2.0;
}

/// A tracker and its motion.
template <typename Case>
class WorstMotion {
 public:
  static constexpr std::size_t kNumbers = Case::kDof + kPhases * kPhaseNumbers;

  explicit WorstMotion(const Numbers& numbers) : tracker_(Case::tracker(start_of(numbers))), start_(tracker_.tip()) {
    for (std::size_t k = 0; k < kPhases; ++k) phases_.emplace_back(numbers, Case::kDof + k * kPhaseNumbers);
  }

  /// Returns whether there is a next tick, and sets the target of the next tick.
  [[nodiscard]] bool next() {
    if (phase_ == phases_.size()) return false;
    move(target_, start_, phases_[phase_], 1e-3 * tick_);
    if (++tick_ == phases_[phase_].ticks) {
      ++phase_;
      tick_ = 0;
    }
    return true;
  }
  void tick() noexcept {
    auto result = tracker_.tick(target_);
    escape(result);
    escape(*this);
  }

 private:
  using Tracker = decltype(Case::tracker(fpbm::Vector<Case::kDof>()));

  static fpbm::Vector<Case::kDof> start_of(const Numbers& numbers) {
    if (numbers.size() != kNumbers) {
      throw std::invalid_argument(Case::name() + ": the motion must have " + std::to_string(kNumbers) + " numbers");
    }
    return Case::start(numbers);
  }

  Tracker tracker_;
  decltype(Tracker(tracker_).tip()) start_;
  typename Tracker::Target target_ = Tracker::Target::hold(start_);
  std::vector<Phase> phases_;
  std::size_t phase_ = 0;
  int tick_ = 0;
};

/// Posture within a fraction of each joint range, around its middle.
template <int N>
fpbm::Vector<N> within(const fpbm::JointLimits<N>& limits, const Numbers& numbers, double share) {
  fpbm::Vector<N> q;
  for (int i = 0; i < N; ++i) {
    const double middle = (limits.upper(i) + limits.lower(i)) / 2.0;
    q(i) = middle + share * numbers[static_cast<std::size_t>(i)] * (limits.upper(i) - middle);
  }
  return q;
}

template <typename Space, bool kJerk>
struct WorstPanda {
  static constexpr int kDof = 7;
  static std::string name() {
    return std::string("panda/") + (Space::kRows == 6 ? "pose" : "position") + (kJerk ? "_jerk" : "");
  }
  static auto arm() {
    auto chain = Panda::chain();
    for (auto& joint : chain.joints) {
      if (!kJerk) joint.bounds.jerk = fpbm::JointBounds<>::kNone;
    }
    return fpbm::SerialArm<7>(chain);
  }
  static fpbm::Vector<7> start(const Numbers& numbers) { return within(arm().limits(), numbers, 0.95); }
  static auto tracker(const fpbm::Vector<7>& q) { return fpbm::Tracker(arm(), Space{}, damped(), q); }
};

/// A Panda among surroundings(). The start is near a posture that keeps the margin.
struct WorstClearPanda {
  static constexpr int kDof = 7;
  static std::string name() { return "panda/pose_clear"; }
  static fpbm::Vector<7> start(const Numbers& numbers) {
    fpbm::Vector<7> q = Panda::bent();
    for (int i = 0; i < 7; ++i) q(i) += 0.05 * numbers[static_cast<std::size_t>(i)];
    return q;
  }
  static auto tracker(const fpbm::Vector<7>& q) {
    using Kept = fpbm::Bounds<fpbm::Clearance<7>>;
    const fpbm::SerialArm<7> arm(Panda::chain());
    return fpbm::Tracker<fpbm::SerialArm<7>, fpbm::Pose, decltype(damped()), Kept>(
        arm, fpbm::Pose{}, damped(), {q, fpbm::Vector<7>::Zero()}, {},
        fpbm::Limits<fpbm::Level::kAcceleration, 7>(arm.limits(), 1e-3), fpbm::Vector<7>::Zero(), Kept(surroundings()));
  }
};

/// Stacks of three levels: a Panda with a pose, the position of a joint and a posture, and two Pandas that hold an
/// object.
template <int Arms>
struct WorstStack {
  using Robot = Pandas<Arms, 0>;
  static constexpr int kDof = Robot::kDof;
  static std::string name() { return Arms == 1 ? "panda/three_levels" : "two_pandas/grasp"; }
  static auto stack() {
    if constexpr (Arms == 1) {
      return growing_stack<Robot, 3>();
    } else {
      return grasp<Robot>();
    }
  }
  static fpbm::Vector<kDof> start(const Numbers& numbers) {
    if constexpr (Arms == 1) return within(fpbm::Robot<kDof>(Robot::tree()).limits(), numbers, 0.95);
    fpbm::Vector<kDof> q = Robot::start();
    for (int i = 0; i < kDof; ++i) q(i) += 0.3 * numbers[static_cast<std::size_t>(i)];
    return q;
  }
  static auto tracker(const fpbm::Vector<kDof>& q) {
    const auto scheme = fpbm::Balanced<kDof>(0.0, fpbm::UnitWeights{}, fpbm::NullSpace<kDof>().with_damping(2.0));
    fpbm::TrackerOptions<> options;
    options.keep_first_level = Arms > 1;
    return fpbm::stack_tracker(fpbm::Robot<kDof>(Robot::tree()), stack(), scheme, q, options);
  }
};

/// Calls f(case) for each case.
template <typename F>
void for_each_worst(const F& f) {
  f(WorstPanda<fpbm::Pose, true>{});
  f(WorstPanda<fpbm::Pose, false>{});
  f(WorstPanda<fpbm::Position<3>, true>{});
  f(WorstPanda<fpbm::Position<3>, false>{});
  f(WorstClearPanda{});
  f(WorstStack<1>{});
  f(WorstStack<2>{});
}

/// A motion, and the number of its longest tick.
struct Found {
  Numbers numbers;
  int tick = 0;
};

/// The motion of a case in a file with lines "name tick numbers". Without numbers if the file does not have the line.
inline Found found_in(const std::string& file, const std::string& name) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first != name) continue;
    Found found;
    words >> found.tick;
    for (double number; words >> number;) found.numbers.push_back(number);
    return found;
  }
  return {};
}

}  // namespace bench
