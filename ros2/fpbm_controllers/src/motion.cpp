#include "fpbm_controllers/motion.hpp"

#include <algorithm>
#include <array>
#include <fpbm/any/any_stack.hpp>
#include <fpbm/model/robot.hpp>
#include <fpbm/realtime/stack_tracker.hpp>
#include <fpbm/scheme/schemes.hpp>
#include <fpbm/task/target_filter.hpp>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace fpbm_controllers {

namespace {

constexpr int kDof = Eigen::Dynamic;  // One instantiation serves robots of any number of joints.
using Joints = fpbm::Vector<kDof>;
using Robot = fpbm::Robot<kDof>;
using Stack = fpbm::AnyStack;
using Space = Stack::Space;
using Tasks = fpbm::RobotTasks<Robot, Stack>;
using Scheme = fpbm::ByLevels<fpbm::AccelerationScheme<kDof>, Stack>;
using Tracker = fpbm::Tracker<Tasks, Space, Scheme>;
using Reference = fpbm::Reference<Space>;
constexpr int kPerLevel = Stack::kTasks / Stack::kLevels;

/// The places of tasks in a stack, whose first places of each level are those of frames.
[[nodiscard]] std::vector<int> places_of(const std::vector<MotionTask>& tasks) {
  std::array<int, Stack::kLevels> counts{};
  std::vector<int> places;
  for (const MotionTask& task : tasks) {
    const int before = counts[static_cast<std::size_t>(task.level)]++;
    places.push_back(task.level * kPerLevel + before);
  }
  return places;
}

[[nodiscard]] Stack stack_of(const std::vector<MotionTask>& tasks) {
  const std::vector<int> places = places_of(tasks);
  std::array<fpbm::AnyFrameTask, Stack::kTasks> all;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    const MotionTask& task = tasks[k];
    all[static_cast<std::size_t>(places[k])] =
        fpbm::AnyFrameTask(fpbm::FrameCoordinates::kPose, task.frame, task.gains, {true, true, true, true, true, true},
                           false, {0.0, 0.0, 1.0}, task.reference);
  }
  const auto level = [&all](std::size_t k) {
    const std::size_t first = k * static_cast<std::size_t>(kPerLevel);
    return fpbm::AnyLevel(all[first], all[first + 1], fpbm::AnyPostureTask());
  };
  return Stack(level(0), level(1), level(2), level(3));
}

/// Throws std::invalid_argument, with the task's name, where a tick does not damp the error of a task with its gains.
void require_stable_tasks(const std::vector<MotionTask>& tasks, double dt) {
  constexpr fpbm::Level kLevel = fpbm::Level::kAcceleration;
  const bool several = std::any_of(tasks.begin(), tasks.end(), [](const auto& task) { return task.level > 0; });
  for (const MotionTask& task : tasks) {
    try {
      fpbm::require_stable_gains<kLevel, double>({"k1", task.gains.k1, "k2", task.gains.k2}, {dt, 0.0});
      if (several) fpbm::require_stable_in_levels<kLevel>(task.gains, dt);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(task.gains_of + error.what());
    }
  }
}

/// Calls f(i, row) for the place of a task: its index as a type, and the first row of its errors.
template <typename F>
void at_place(int place, F&& f) noexcept {
  Space::each([&](auto space, auto i, int row) noexcept {
    if constexpr (std::is_same_v<decltype(space), fpbm::FrameSpace>) {
      if (static_cast<int>(decltype(i)::value) == place) f(i, row);
    }
  });
}

}  // namespace

struct Motion::Loop {
  explicit Loop(const MotionSettings& settings)
      : scheme(settings.scheme),
        options(settings.options),
        limits(settings.limits),
        places(places_of(settings.tasks)),
        tasks(Robot(settings.tree), stack_of(settings.tasks)),
        filters(places.size(), Filter(fpbm::Transform<>{}, settings.bounds, settings.filter)) {
    require_stable_tasks(settings.tasks, options.dt);
    fpbm::require_stable(scheme_from(Joints::Zero(tasks.dof())), fpbm::TickOfGains<>{options.dt, 0.0});
  }

  [[nodiscard]] Scheme scheme_from(const Joints& start) const {
    auto null_space = fpbm::NullSpace<kDof>().with_damping(scheme.null_damping);
    if (scheme.rest_stiffness > 0.0) {
      null_space = null_space.with_rest_posture(scheme.rest_posture.value_or(start), scheme.rest_stiffness);
    }
    return Scheme(fpbm::Balanced<kDof>(scheme.alpha, scheme.weights, null_space));
  }

  /// The references of all tasks some seconds into the coming tick; those of empty places are held.
  [[nodiscard]] Reference ahead(double seconds) const noexcept {
    Reference all = held;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto own = filters[k].ahead(seconds);
      at_place(places[k], [&](auto i, int row) noexcept {
        std::get<decltype(i)::value>(all.x).at = own.x;
        all.xd.segment<6>(row) = own.xd;
        all.xdd.segment<6>(row) = own.xdd;
      });
    }
    return all;
  }

  using Filter = fpbm::TargetFilter<fpbm::Pose>;

  MotionScheme scheme;
  fpbm::TrackerOptions<> options;
  fpbm::Limits<fpbm::Level::kAcceleration, kDof> limits;
  std::vector<int> places;  ///< Of each task in the stack.
  Tasks tasks;
  std::vector<Filter> filters;
  std::optional<Tracker> tracker;
  Reference held = Reference::hold(Space::origin<double>());
};

Motion::Motion(const MotionSettings& settings) : loop_(std::make_unique<Loop>(settings)) {}

Motion::~Motion() = default;

void Motion::begin(const Joints& q) {
  const fpbm::State<kDof> start{q, Joints::Zero(q.size())};
  loop_->tracker.emplace(loop_->tasks, Space{}, loop_->scheme_from(q), start, loop_->options, loop_->limits);
  loop_->held = Reference::hold(loop_->tracker->tip());
  for (std::size_t k = 0; k < loop_->places.size(); ++k) {
    at_place(loop_->places[k], [&](auto i, int) noexcept {
      (void)loop_->filters[k].reset(std::get<decltype(i)::value>(loop_->held.x).at);
    });
  }
}

bool Motion::push(std::size_t task, const Target& target) noexcept {
  auto& filter = loop_->filters[task];
  const auto push = [&](auto... stamp) noexcept {
    return target.moves ? filter.push_twist(target.twist, stamp...) : filter.push(target.pose, stamp...);
  };
  return target.stamp == 0.0 ? push() : push(target.stamp);
}

void Motion::tick(Report& report) noexcept {
  const auto references =
      fpbm::TickReferences<Space>::of([this](double t) noexcept { return loop_->ahead(t); }, loop_->options.dt);
  const auto tick = loop_->tracker->advance(references);
  for (auto& filter : loop_->filters) filter.advance();
  report.status = tick.status;
  for (std::size_t k = 0; k < loop_->places.size(); ++k) {
    at_place(loop_->places[k], [&](auto i, int row) noexcept {
      constexpr auto kLevel = static_cast<std::size_t>(Stack::level(static_cast<int>(decltype(i)::value)));
      report.tasks[k].scale = tick.scales[kLevel];
      report.tasks[k].position_error = tick.error.segment<3>(row).norm();
      report.tasks[k].orientation_error = tick.error.segment<3>(row + 3).norm();
    });
  }
}

void Motion::stop() noexcept {
  loop_->tracker->stop();
}

const fpbm::State<kDof>& Motion::state() const noexcept {
  return loop_->tracker->state();
}

void Motion::locate(Report& report) const noexcept {
  const Stack::Point at = loop_->tracker->tip();
  for (std::size_t k = 0; k < loop_->places.size(); ++k) {
    at_place(loop_->places[k], [&](auto i, int) noexcept { report.tasks[k].at = std::get<decltype(i)::value>(at).at; });
  }
}

}  // namespace fpbm_controllers
