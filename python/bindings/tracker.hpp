#pragma once

#include <memory>
#include <utility>
#include <variant>

#include "fpbm/realtime/path_follower.hpp"
#include "fpbm/realtime/tick.hpp"
#include "whole_arm.hpp"

namespace fpbm::bindings {

template <typename Space>
using AnyCourse = PathFollower<AnyPath<Space>>;

/// A tracker of any arm under any scheme.
template <typename Space>
class LoopModel {
 public:
  using Result = Tick<Space, kDynamic>;

  LoopModel() = default;
  LoopModel(const LoopModel&) = delete;
  LoopModel& operator=(const LoopModel&) = delete;
  virtual ~LoopModel() = default;

  virtual Result tick(const Reference<Space>& reference) = 0;
  virtual Result tick(AnyCourse<Space>& course) = 0;
  /// Throws std::invalid_argument at velocity level.
  virtual Result resolve_measured(const State<kDynamic>& measured, const Reference<Space>& reference) = 0;
  virtual void stop() = 0;
  virtual void resume() = 0;
  [[nodiscard]] virtual const State<kDynamic>& state() const = 0;
  [[nodiscard]] virtual typename Space::template Point<double> tip() const = 0;
};

template <typename... Spaces>
struct LoopOver {
  using Models = std::variant<std::shared_ptr<LoopModel<Spaces>>...>;
  using Courses = std::variant<AnyCourse<Spaces>...>;
};
using AnyLoop = LoopOver<Position<2>, PlanarPose, Position<3>, Pose>;

/// A tracker in code of run-time size. Throws std::invalid_argument where scheme, state, options or limits do not fit.
template <typename Space>
std::shared_ptr<LoopModel<Space>> make_loop(const WholeArm<Space>& arm, PyScheme scheme, const State<kDynamic>& start,
                                            const TrackerOptions<>& options, const JointLimits<kDynamic>& limits);

}  // namespace fpbm::bindings
