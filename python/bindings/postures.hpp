#pragma once

#include <functional>
#include <memory>

#include "arm.hpp"
#include "bounds.hpp"
#include "fpbm/any/any_stack.hpp"
#include "fpbm/inverse/inverse_kinematics.hpp"
#include "fpbm/model/chain.hpp"

namespace fpbm::bindings {

using AnyPosture = Posture<kDynamic>;

/// fpbm::InverseKinematics of tasks in Space, for any arm.
template <typename Space>
class PostureSolver {
 public:
  using Point = typename Space::template Point<double>;
  using Found = std::function<bool(const AnyPosture&)>;

  PostureSolver() = default;
  PostureSolver(const PostureSolver&) = delete;
  PostureSolver& operator=(const PostureSolver&) = delete;
  virtual ~PostureSolver() = default;

  [[nodiscard]] virtual AnyPosture solve(const Point& target, const JointVector& start) noexcept = 0;
  virtual void search(const Point& target, const JointVector& start, const Found& found) noexcept = 0;
  /// Points of the tasks in a posture.
  [[nodiscard]] virtual Point tip(const JointVector& q) const noexcept = 0;
  [[nodiscard]] virtual double manipulability(const JointVector& q) const noexcept = 0;
  [[nodiscard]] virtual std::unique_ptr<PostureSolver> clone() const = 0;
};

/// PostureSolver of an InverseKinematics with any number of joints.
template <typename Inverse, typename Space>
class PostureSolverOf final : public PostureSolver<Space> {
 public:
  using typename PostureSolver<Space>::Found;
  using typename PostureSolver<Space>::Point;

  explicit PostureSolverOf(const Inverse& inverse) : inverse_(inverse) {}

  [[nodiscard]] AnyPosture solve(const Point& target, const JointVector& start) noexcept override {
    return any(inverse_.solve(target, typename Inverse::JointVector(start)));
  }
  void search(const Point& target, const JointVector& start, const Found& found) noexcept override {
    (void)inverse_.search(target, typename Inverse::JointVector(start),
                          [&](const auto& posture) noexcept { return found(any(posture)); });
  }
  [[nodiscard]] Point tip(const JointVector& q) const noexcept override {
    return inverse_.tip(typename Inverse::JointVector(q));
  }
  [[nodiscard]] double manipulability(const JointVector& q) const noexcept override {
    return inverse_.manipulability(typename Inverse::JointVector(q));
  }
  [[nodiscard]] std::unique_ptr<PostureSolver<Space>> clone() const override {
    return std::make_unique<PostureSolverOf>(inverse_);
  }

 private:
  template <typename Found_>
  [[nodiscard]] static AnyPosture any(const Found_& found) noexcept {
    return {found.q, found.status, found.error, found.starts};
  }

  Inverse inverse_;
};

/// Solver in SIMD lanes for the pose of a chain of N joints.
template <int N>
using PosturesInLanes = std::unique_ptr<PostureSolver<Pose>> (*)(const Chain<>& chain, const InverseOptions<>& options,
                                                                 const JointLimits<N>& limits);

/// Solvers without lanes. Throw std::invalid_argument as fpbm::InverseKinematics does. Compiled once, in postures.cpp.
template <typename Space>
std::unique_ptr<PostureSolver<Space>> posture_solver(const AnyArmFor<Space>& arm, const InverseOptions<>& options,
                                                     const JointLimits<kDynamic>& limits);
std::unique_ptr<PostureSolver<AnyStack::Space>> posture_solver(const Tree<>& tree, const AnyStack& stack,
                                                               const InverseOptions<>& options,
                                                               const JointLimits<kDynamic>& limits,
                                                               const AnyBounds& bounds);

}  // namespace fpbm::bindings
