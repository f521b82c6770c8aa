#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "fpbm/core/status.hpp"
#include "fpbm/objective/null_space.hpp"
#include "support/random.hpp"
#include "support/textbook.hpp"

/// Every scheme on every kind of arm, their types erased: a law is written and compiled once and run over them all.
namespace fpbm::test {

/// An arm with links of these lengths in a state, and what is asked of its tip, x as a displacement from where the tip
/// is.
struct Scene {
  Eigen::VectorXd lengths;
  Eigen::VectorXd q;
  Eigen::VectorXd qd;
  Eigen::VectorXd displacement;
  Eigen::VectorXd xd;
  Eigen::VectorXd xdd;
};

/// What a scheme made of a scene.
struct Outcome {
  Status status;
  RealVector u;  ///< Joint velocities or accelerations; untouched if left as kSentinel in every entry.
  Situation at;  ///< What it was told, J and Jd as the arm computed them: the scheme is judged apart from the arm.

  static constexpr double kSentinel = 42.0;
  [[nodiscard]] bool untouched() const { return (u.array() == static_cast<Real>(kSentinel)).all(); }
};

/// A scheme type on an arm type.
struct Subject {
  std::string name;
  int dof;
  int rows;        ///< Of its task.
  double epsilon;  ///< Of its Scalar.
  Kind kind;
  Level level;
  bool weighted;
  bool dense;
  Outcome (*resolve)(const Law&, const Scene&);
};

inline void PrintTo(const Subject& subject, std::ostream* out) {
  *out << subject.name;
}

[[nodiscard]] std::vector<Subject> subjects_n2();
[[nodiscard]] std::vector<Subject> subjects_n4();
[[nodiscard]] std::vector<Subject> subjects_n7();
[[nodiscard]] std::vector<Subject> subjects_dynamic();
[[nodiscard]] std::vector<Subject> subjects_float();
[[nodiscard]] std::vector<Subject> subjects_planar_pose();
[[nodiscard]] std::vector<Subject> subjects_position();
[[nodiscard]] std::vector<Subject> subjects_pose();
[[nodiscard]] std::vector<Subject> subjects_pose_dynamic();

/// All of the above.
[[nodiscard]] std::vector<Subject> subjects();

/// A law of the subject's kind with random parameters.
[[nodiscard]] Law random_law(Random& random, const Subject& subject, bool has_null_space);

/// Where in its state space the arm is.
enum class Regime { kRegular, kNearSingular, kAtRest };

[[nodiscard]] std::string name(Regime regime);

[[nodiscard]] Scene random_scene(Random& random, const Subject& subject, Regime regime);

}  // namespace fpbm::test
