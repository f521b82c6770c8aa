#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/typing.h>

#include "arrays.hpp"
#include "path.hpp"
#include "stack_tracker.hpp"
#include "target_filter.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {

/// By the names of tasks: what each is to follow, and where it is.
using PyReferences = py::typing::Dict<py::str, py::object>;
using PyPoints = py::typing::Dict<py::str, Array>;

struct PyFollower {
  std::variant<AnyFollower<Position<2>>, AnyFollower<PlanarPose>, AnyFollower<Position<3>>, AnyFollower<Pose>> any;
};

/// A tracker of a stack as Python has it: the tasks by name, and the reference that each had last.
class StackLoop {
 public:
  using Tracker = StackTracker;
  using Space = StackTracker::Space;
  using Result = StackTracker::Result;

  /// stack: an fpbm_cpp.Stack. Throws std::invalid_argument where a task does not suit the arm, and as fpbm::Tracker.
  StackLoop(const py::object& stack, const Scheme& scheme, const Arm& arm, const State<kDynamic>& start,
            const TrackerOptions<>& options, const JointLimits<kDynamic>& limits, const JointVector& qdd0,
            const Clearance<kDynamic>& clearance);

  /// One tick toward references: a dictionary of what Tracker.tick() takes, by the names of the tasks. A task that is
  /// not in it keeps its last target, at rest. Throws std::invalid_argument, before the tick, on a bad reference.
  [[nodiscard]] Result tick(const PyReferences& references);
  [[nodiscard]] Result resolve_measured(const State<kDynamic>& measured, const PyReferences& references);

  /// A path laid out from where a task is now. task: its name, or none of the only one that follows paths.
  [[nodiscard]] PyFollower follow(const Path& path, double ramp, const std::optional<std::string>& task) const;

  /// Throws std::invalid_argument unless there is such a level below the first.
  void enable(int level, bool on);
  void stop() noexcept;
  void resume() noexcept;

  [[nodiscard]] StackTracker& tracker() const noexcept { return *tracker_; }
  /// Where each task is, as references have it, by name.
  [[nodiscard]] PyPoints points() const;
  /// The frame of a task, shape (4, 4); of an axis, its z axis is that.
  [[nodiscard]] Array frame(const std::string& task) const;

  [[nodiscard]] Array scales(const Result& tick) const;
  [[nodiscard]] PyPoints errors(const Result& tick) const;
  /// The errors one after another.
  [[nodiscard]] Array error(const Result& tick) const;

 private:
  enum class Kind { kPosition, kOrientation, kPose, kAxis, kPosture };
  struct Task {
    std::string name;
    Kind kind;
    int index;  ///< Of AnyStack's tasks.
    int size;   ///< Rows of its point's displacements.
    std::vector<int> joints;
  };
  /// A reference of one task.
  struct Target {
    Transform<> at;
    Vector<kDynamic> q;
    Vector<kDynamic> xd;
    Vector<kDynamic> xdd;
  };
  /// What a task follows in a tick: a path or a filter, which have their own references.
  using Source =
      std::variant<AnyFollower<Position<3>>*, AnyFollower<Pose>*, TargetFilter<Position<3>>*, TargetFilter<Pose>*>;

  [[nodiscard]] AnyStack build(const py::object& stack, const Scheme& scheme, const Arm& arm);
  [[nodiscard]] Transform<> frame_of(const Task& task) const noexcept;
  [[nodiscard]] const Task& task_named(const std::string& name) const;
  /// The targets of references that are numbers, at the others' sources.
  [[nodiscard]] std::vector<std::pair<const Task*, Source>> read(const PyReferences& references);
  [[nodiscard]] Target target_of(const Task& task, const py::handle& given) const;
  [[nodiscard]] std::optional<Source> source_of(const Task& task, const py::handle& given) const;
  void put(const Task& task, const Target& target, Reference<Space>& to) const noexcept;
  void put(const Task& task, const Source& source, double seconds, Reference<Space>& to) const noexcept;

  std::vector<Task> tasks_;
  int levels_ = 0;
  double dt_;
  bool stopping_ = false;
  std::unique_ptr<StackTracker> tracker_;
  Reference<Space> held_;
};

}  // namespace fpbm::bindings
