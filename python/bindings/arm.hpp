#pragma once

#include <memory>

#include "fpbm/core/status.hpp"
#include "fpbm/sim/motion.hpp"
#include "fpbm/sim/rollout.hpp"
#include "path.hpp"
#include "scheme.hpp"

namespace fpbm::bindings {

inline constexpr int kDynamic = Eigen::Dynamic;

/// An arm behind its number of joints: every call ends in code made for just that number.
class ArmModel {
 public:
  using Joints = Vector<kDynamic>;
  using Rows = Matrix<2, kDynamic>;
  using Buffers = MotionBuffers<2, kDynamic>;

  ArmModel() = default;
  ArmModel(const ArmModel&) = delete;
  ArmModel& operator=(const ArmModel&) = delete;
  virtual ~ArmModel() = default;

  [[nodiscard]] virtual Kinematics<Position<2>, kDynamic> kinematics(const Joints& q, const Joints& qd) const = 0;
  [[nodiscard]] virtual Status resolve(const PyScheme& scheme, const Reference<Position<2>>& reference,
                                       const State<kDynamic>& state, Joints& out) const = 0;
  [[nodiscard]] virtual RolloutResult<kDynamic> simulate(const PyScheme& scheme, const PyPath& path,
                                                         const State<kDynamic>& start, const TimeGrid<double>& grid,
                                                         const Buffers& buffers) const = 0;
};

/// Fixed-size code for this many joints; beyond, the heap-free code of run-time size.
inline constexpr int kSmallestFixedDof = 2;
inline constexpr int kLargestFixedDof = 10;

/// The arm's model in code of exactly N joints. One source file per N, written by CMake, instantiates it.
template <int N>
std::unique_ptr<const ArmModel> make_planar_model(const ArmModel::Joints& lengths);

/// The choice of N.
template <int N = kSmallestFixedDof>
std::unique_ptr<const ArmModel> choose_planar_model(const ArmModel::Joints& lengths) {
  if constexpr (N > kLargestFixedDof) {
    return make_planar_model<kDynamic>(lengths);
  } else {
    if (lengths.size() == N) return make_planar_model<N>(lengths);
    return choose_planar_model<N + 1>(lengths);
  }
}

}  // namespace fpbm::bindings
