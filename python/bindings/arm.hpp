#pragma once

#include <atomic>
#include <memory>

#include "fpbm/model/chain.hpp"
#include "fpbm/model/coupled_arm.hpp"
#include "fpbm/model/planar_arm.hpp"
#include "fpbm/model/serial_arm.hpp"
#include "fpbm/sim/rollout.hpp"
#include "outcome.hpp"
#include "path.hpp"
#include "recorder.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

inline constexpr int kDynamic = Eigen::Dynamic;
using Joints = Vector<kDynamic>;

/// An arm with a task in Space, behind its number of joints: every call ends in code made for just that number.
template <typename Space_>
class TaskModel : public std::enable_shared_from_this<TaskModel<Space_>> {
 public:
  using Space = Space_;

  TaskModel() = default;
  TaskModel(const TaskModel&) = delete;
  TaskModel& operator=(const TaskModel&) = delete;
  virtual ~TaskModel() = default;

  [[nodiscard]] virtual Kinematics<Space, kDynamic> kinematics(const Joints& q, const Joints& qd) const = 0;
  [[nodiscard]] virtual RolloutResult<kDynamic> simulate(const PyScheme& scheme, const AnyPath<Space>& path,
                                                         const State<kDynamic>& start, const TimeGrid<double>& grid,
                                                         const Wanted<Space>& wanted) const = 0;
  /// How many motions of this arm go side by side; 1 where there is no such code for the arm or the processor.
  [[nodiscard]] virtual int lanes() const noexcept = 0;
  /// As many motions as there are lanes, as RunInLanes says.
  virtual void run_in_lanes(const AnyPath<Space>& path, const TimeGrid<double>& grid, const PyScheme* const* schemes,
                            const Joints* starts, const std::atomic<bool>& stop, Outcome* outcomes) const = 0;
  /// Throws std::invalid_argument where a parameter of the scheme does not fit the arm.
  virtual void require(const PyScheme& scheme) const = 0;
};

/// An arm with each of its tasks.
template <typename Positions>
struct ArmModels {
  std::shared_ptr<const TaskModel<Positions>> position;
  std::shared_ptr<const TaskModel<typename PoseOver<Positions>::type>> pose;
};

/// What an arm of the library is made from, and the space of its tip's positions.
template <typename Arm>
struct ArmTraits {
  using Source = Chain<>;
  using Positions = Position<3>;
};
template <int N>
struct ArmTraits<PlanarArm<N>> {
  using Source = Joints;
  using Positions = Position<2>;
};

template <typename Arm>
using ModelsOf = ArmModels<typename ArmTraits<Arm>::Positions>;

/// The models of an arm. Source files written by CMake define it, one for each kind and number of joints.
template <typename Arm>
ModelsOf<Arm> make_models(const typename ArmTraits<Arm>::Source& source);

}  // namespace fpbm::bindings
