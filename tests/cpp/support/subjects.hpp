#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "fpbm/core/status.hpp"
#include "support/random.hpp"
#include "support/schemes.hpp"
#include "support/textbook.hpp"

/// Every scheme on every type of arm, type-erased: a test of a law is compiled once and runs on all of them.
namespace fpbm::test {

/// An arm with links of these lengths in a state, and the reference of its tip. The reference position is given as a
/// displacement from the tip.
struct Scene {
  Eigen::VectorXd lengths;
  Eigen::VectorXd q;
  Eigen::VectorXd qd;
  Eigen::VectorXd displacement;
  Eigen::VectorXd xd;
  Eigen::VectorXd xdd;
};

/// The result of a scheme for a scene.
struct Outcome {
  Status status;
  RealVector u;  ///< Joint velocities or accelerations; kSentinel in all entries that the scheme did not change.
  Situation at;  ///< Input of the scheme, with J and Jd from the arm, so that the test of the scheme is independent of
                 ///< the arm.

  static constexpr double kSentinel = 42.0;
  [[nodiscard]] bool untouched() const { return (u.array() == static_cast<Real>(kSentinel)).all(); }
};

/// A scheme on a type of arm with a type of task.
struct Subject {
  std::string name;
  int dof;
  int rows;        ///< Rows of the task.
  double epsilon;  ///< Machine epsilon of the Scalar.
  Takes takes;
  std::function<Outcome(const Law&, const Scene&)> resolve;
};

inline void PrintTo(const Subject& subject, std::ostream* out) {
  *out << subject.name;
}

/// Planar arms of 4 joints, and of 2, 7 and 12 joints of run-time size; with diagonal weights, 4 joints in float, and 4
/// joints with the task space PlanarPose.
[[nodiscard]] std::vector<Subject> planar_subjects();
/// Arms in space: 7 joints with the task space Pose, without dense weights, and with Position<3>, with diagonal
/// weights; 9 joints of run-time size, on a rail.
[[nodiscard]] std::vector<Subject> spatial_subjects();
/// Planar and spatial subjects.
[[nodiscard]] std::vector<Subject> subjects();

/// The Panda with the task spaces Position<3> and Pose.
[[nodiscard]] std::vector<Subject> panda_position_subjects();
[[nodiscard]] std::vector<Subject> panda_pose_subjects();

/// A law for the subject with random parameters.
[[nodiscard]] Law random_law(Random& random, const Subject& subject, bool has_null_space);

/// Type of state of the arm.
enum class Regime { kRegular, kNearSingular, kAtRest };

[[nodiscard]] std::string name(Regime regime);

[[nodiscard]] Scene random_scene(Random& random, const Subject& subject, Regime regime);

}  // namespace fpbm::test
