#include "fpbm_controllers/motion.hpp"

#include <algorithm>
#include <array>
#include <fpbm/any/any_stack.hpp>
#include <fpbm/model/robot.hpp>
#include <fpbm/realtime/stack_tracker.hpp>
#include <fpbm/scheme/schemes.hpp>
#include <fpbm/target/target_filter.hpp>
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
using Tracker = fpbm::Tracker<Tasks, Space, Scheme, SharedBounds::View>;
using Reference = fpbm::Reference<Space>;
constexpr int kPerLevel = Stack::kTasks / Stack::kLevels;

/// The places of tasks in a stack. The first places of each level are for tasks of frames.
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
        fpbm::AnyFrameTask(task.coordinates, task.frame, task.gains, {true, true, true, true, true, true}, false,
                           {0.0, 0.0, 1.0}, task.reference);
  }
  const auto level = [&all](std::size_t k) {
    const std::size_t first = k * static_cast<std::size_t>(kPerLevel);
    return fpbm::AnyLevel(all[first], all[first + 1], fpbm::AnyPostureTask());
  };
  return Stack(level(0), level(1), level(2), level(3));
}

/// Throws std::invalid_argument, with the task's name, if a tick does not damp the error of a task with its gains.
void require_stable_tasks(const std::vector<MotionTask>& tasks, const fpbm::TickOfGains<>& tick) {
  constexpr fpbm::Level kLevel = fpbm::Level::kAcceleration;
  for (const MotionTask& task : tasks) {
    try {
      fpbm::require_stable_gains<kLevel, double>({"k1", task.gains.k1, "k2", task.gains.k2}, tick);
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

class StackMotion final : public Motion {
 public:
  explicit StackMotion(const MotionSettings& settings)
      : scheme_(settings.scheme),
        options_(settings.options),
        limits_(settings.limits),
        parts_(parts_of(settings.tasks)),
        tasks_(Robot(settings.tree), stack_of(settings.tasks)),
        bounds_(settings.bounds),
        filters_(settings.tasks.back().target + 1, Filter(fpbm::Transform<>{}, settings.target, settings.filter)) {
    const fpbm::TickOfGains<> tick{options_.dt, 0.0};
    require_stable_tasks(settings.tasks, tick);
    fpbm::require_stable(scheme_from(Joints::Zero(tasks_.dof())), tick);
  }

  void begin(const Joints& q, const Joints& rest) override {
    const fpbm::State<kDof> start{q, Joints::Zero(q.size())};
    tracker_.emplace(tasks_, Space{}, scheme_from(rest), start, options_, limits_, start.qd, bounds_);
    held_ = Reference::hold(tracker_->tip());
    for (const Part& part : parts_) {
      at_place(part.place, [&](auto i, int) noexcept {
        (void)filters_[part.target].reset(std::get<decltype(i)::value>(held_.x).at);
      });
    }
  }

  bool push(std::size_t task, const Target& target) noexcept override { return push_to(filters_[task], target); }

  void set_speed(double fraction) noexcept override {
    for (auto& filter : filters_) (void)filter.set_speed(fraction);
  }

  void tick(Report& report) noexcept override {
    const auto references =
        fpbm::TickReferences<Space>::of([this](double t) noexcept { return ahead(t); }, options_.dt);
    const auto tick = tracker_->advance(references);
    for (auto& filter : filters_) filter.advance();
    report.status = tick.status;
    for (const Part& part : parts_) {
      at_place(part.place, [&](auto i, int row) noexcept {
        constexpr auto kLevel = static_cast<std::size_t>(Stack::level(static_cast<int>(decltype(i)::value)));
        TaskReport& its = report.tasks[part.target];
        if (part.coordinates != fpbm::FrameCoordinates::kAxis) {
          its.scale = tick.scales[kLevel];
          its.position_error = tick.error.segment<3>(row).norm();
        }
        if (part.coordinates != fpbm::FrameCoordinates::kPosition) {
          its.orientation_error = tick.error.segment<3>(row + 3).norm();
        }
      });
    }
  }

  void stop() noexcept override { tracker_->stop(); }

  [[nodiscard]] const fpbm::State<kDof>& state() const noexcept override { return tracker_->state(); }

  [[nodiscard]] const Joints& acceleration() const noexcept override { return tracker_->acceleration(); }

  void locate(Report& report) const noexcept override {
    const Stack::Point at = tracker_->tip();
    for (const Part& part : parts_) {
      at_place(part.place,
               [&](auto i, int) noexcept { report.tasks[part.target].at = std::get<decltype(i)::value>(at).at; });
    }
  }

 private:
  using Filter = fpbm::TargetFilter<fpbm::Pose>;

  /// A task of the stack.
  struct Part {
    int place;           ///< In the stack.
    std::size_t target;  ///< Index of the filter.
    fpbm::FrameCoordinates coordinates;
  };

  [[nodiscard]] static std::vector<Part> parts_of(const std::vector<MotionTask>& tasks) {
    const std::vector<int> places = places_of(tasks);
    std::vector<Part> parts;
    for (std::size_t k = 0; k < tasks.size(); ++k) parts.push_back({places[k], tasks[k].target, tasks[k].coordinates});
    return parts;
  }

  [[nodiscard]] Scheme scheme_from(const Joints& rest) const {
    return Scheme(fpbm::Balanced<kDof>(scheme_.alpha, scheme_.weights, null_space_of(scheme_, rest)));
  }

  /// The references of all tasks at a time in the next tick [s]; the references of empty places are held.
  [[nodiscard]] Reference ahead(double seconds) const noexcept {
    Reference all = held_;
    for (const Part& part : parts_) {
      const auto own = filters_[part.target].ahead(seconds);
      at_place(part.place, [&](auto i, int row) noexcept {
        std::get<decltype(i)::value>(all.x).at = own.x;
        all.xd.segment<6>(row) = own.xd;
        all.xdd.segment<6>(row) = own.xdd;
      });
    }
    return all;
  }

  MotionScheme scheme_;
  fpbm::TrackerOptions<> options_;
  fpbm::Limits<fpbm::Level::kAcceleration, kDof> limits_;
  std::vector<Part> parts_;
  Tasks tasks_;
  SharedBounds::View bounds_;
  std::vector<Filter> filters_;
  std::optional<Tracker> tracker_;
  Reference held_ = Reference::hold(Space::origin<double>());
};

}  // namespace

std::unique_ptr<Motion> make_stack_motion(const MotionSettings& settings) {
  return std::make_unique<StackMotion>(settings);
}

}  // namespace fpbm_controllers
