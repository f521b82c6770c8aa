#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/typing.h>

#include "arrays.hpp"
#include "bounds.hpp"
#include "fpbm/simulate/fastest.hpp"
#include "sources.hpp"
#include "stack_references.hpp"

namespace fpbm::bindings {

/// Reference and point of each task, by the name of the task.
using PyReferences = py::typing::Dict<py::str, py::object>;
using PyPoints = py::typing::Dict<py::str, Array>;

/// The followers of one path, or of the paths of a stack with one clock.
struct PyFollower {
  using Any =
      std::variant<AnyFollower<Position<2>>, AnyFollower<PlanarPose>, AnyFollower<Position<3>>, AnyFollower<Pose>>;
  std::vector<std::pair<std::string, Any>> each;  ///< With the names of the tasks, which are empty for a single task.

  /// The follower of a task, or the only follower. Throws std::invalid_argument if there is none.
  [[nodiscard]] Any& of(const std::string& task);
};
/// The arguments of a follower, apart from its paths. The scheme and the limits are the tracker's.
struct FollowOptions {
  double ramp;
  bool keep_path;
  FastestOptions fastest;  ///< With keep_path, as shortest.
  double shortest;         ///< Least duration [s].
  const Scheme& scheme;
  const JointLimits<kDynamic>& limits;
};

/// A tracker of a stack in Python: references and results by the names of the tasks.
class StackLoop {
 public:
  using Any = AnyTracker<AnyStack::Space>;
  using Result = Any::Result;
  using Parts = std::vector<std::pair<std::string, int>>;

  /// Throws std::invalid_argument as make_tracker() does.
  StackLoop(const StackPlan& plan, const Scheme& scheme, const TrackerStart& from);

  /// One tick toward references: a dictionary of arguments of Tracker.tick(), by the names of the tasks. A task that is
  /// not in the dictionary keeps its last target, at rest. If a reference is invalid, throws std::invalid_argument
  /// before the tick.
  [[nodiscard]] Result tick(const PyReferences& references);
  [[nodiscard]] Result resolve_measured(const State<kDynamic>& measured, const PyReferences& references);

  /// Paths from the present points of tasks, by the names of the tasks.
  [[nodiscard]] PyFollower follow(const std::vector<std::pair<std::string, const Path*>>& paths,
                                  const FollowOptions& options) const;

  /// Throws std::invalid_argument unless the level exists and is below the first.
  void enable(int level, bool on);
  /// The new level k is the old level order[k]. Throws std::invalid_argument unless order has each level once, and its
  /// first level is enabled.
  void reorder(const std::vector<int>& order);
  [[nodiscard]] const StackPlan& plan() const noexcept { return references_.plan(); }
  [[nodiscard]] Any& tracker() const noexcept { return *tracker_; }
  /// The present point of each task, by name, in the shape of references.
  [[nodiscard]] PyPoints points() const;
  /// The frame of a task, shape (4, 4); for an axis task, z is the axis.
  [[nodiscard]] Array frame(const std::string& task) const;

  [[nodiscard]] Eigen::VectorXd scales(const Result& tick) const;
  /// The errors of the tasks one after another.
  [[nodiscard]] Eigen::VectorXd error(const Result& tick) const;
  /// Name and number of entries of the error of each task.
  [[nodiscard]] const std::shared_ptr<const Parts>& parts() const noexcept { return parts_; }

 private:
  /// Sets the references of a tick.
  void read(const PyReferences& references);
  [[nodiscard]] std::optional<StackReferences::Source> source_of(const StackTask& task, const py::handle& given) const;

  double dt_;
  std::unique_ptr<Any> tracker_;
  StackReferences references_;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace fpbm::bindings
