#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "fpbm/core/status.hpp"
#include "support/random.hpp"
#include "support/schemes.hpp"
#include "support/textbook.hpp"

/// Every scheme on every kind of arm, their types erased: a test of a law compiles once and runs on all of them.
namespace fpbm::test {

/// An arm with links of these lengths in a state, and the reference of its tip, x as a displacement from where the tip
/// is.
struct Scene {
  Eigen::VectorXd lengths;
  Eigen::VectorXd q;
  Eigen::VectorXd qd;
  Eigen::VectorXd displacement;
  Eigen::VectorXd xd;
  Eigen::VectorXd xdd;
};

/// A scheme's answer to a scene.
struct Outcome {
  Status status;
  RealVector u;  ///< Joint velocities or accelerations; kSentinel in every entry where the scheme left them untouched.
  Situation at;  ///< The scheme's input, J and Jd as the arm computed them: the scheme is judged apart from the arm.

  static constexpr double kSentinel = 42.0;
  [[nodiscard]] bool untouched() const { return (u.array() == static_cast<Real>(kSentinel)).all(); }
};

/// A scheme on a kind of arm with a kind of task.
struct Subject {
  std::string name;
  int dof;
  int rows;        ///< Of its task.
  double epsilon;  ///< Of its Scalar.
  Takes takes;
  std::function<Outcome(const Law&, const Scene&)> resolve;
};

inline void PrintTo(const Subject& subject, std::ostream* out) {
  *out << subject.name;
}

/// Planar arms of 4 joints and of 2, 7 and 12 joints at run-time size; with diagonal weights of 4 joints in float, and
/// of 4 joints with the task space PlanarPose.
[[nodiscard]] std::vector<Subject> planar_subjects();
/// Arms in space of 7 joints with the task space Pose, without dense weights, and, with diagonal weights, Position<3>;
/// of 9 joints at run-time size, on a rail.
[[nodiscard]] std::vector<Subject> spatial_subjects();
/// Both.
[[nodiscard]] std::vector<Subject> subjects();

/// The Panda with the task spaces Position<3> and Pose.
[[nodiscard]] std::vector<Subject> panda_position_subjects();
[[nodiscard]] std::vector<Subject> panda_pose_subjects();

/// A law for the subject with random parameters.
[[nodiscard]] Law random_law(Random& random, const Subject& subject, bool has_null_space);

/// Where in its state space the arm is.
enum class Regime { kRegular, kNearSingular, kAtRest };

[[nodiscard]] std::string name(Regime regime);

[[nodiscard]] Scene random_scene(Random& random, const Subject& subject, Regime regime);

}  // namespace fpbm::test
