#include "support/subjects.hpp"

#include <algorithm>

namespace fpbm::test {

std::vector<Subject> subjects() {
  std::vector<Subject> all = planar_subjects();
  const std::vector<Subject> spatial = spatial_subjects();
  all.insert(all.end(), spatial.begin(), spatial.end());
  return all;
}

Law random_law(Random& random, const Subject& subject, bool has_null_space) {
  const Eigen::Index n = subject.dof;
  const Takes& takes = subject.takes;
  Law law;
  law.acceleration = takes.acceleration;
  const double share = std::clamp(random.uniform(-0.3, 1.3), 0.0, 1.0);  // 0 and 1 are separate branches.
  law.alpha = takes.alpha.value_or(share);
  const double feedback = takes.feedback ? 1.0 : 0.0;
  law.k = feedback * random.uniform(0.0, 5.0);
  law.k1 = feedback * random.uniform(0.0, 5.0);
  law.k2 = feedback * random.uniform(0.0, 5.0);
  law.W = Eigen::MatrixXd::Identity(n, n);
  if (takes.dense) {
    law.W = random.positive_definite(n);
  } else if (takes.weights) {
    law.W = random.uniform(n, 0.5, 8.0).asDiagonal();
  }
  law.has_null_space = has_null_space;
  law.damping = random.uniform(0.1, 3.0);
  law.stiffness = random.uniform(0.1, 3.0);
  law.q_rest = random.uniform(n, -1.0, 1.0);
  law.c = random.uniform(n, -1.0, 1.0);
  return law;
}

std::string name(Regime regime) {
  switch (regime) {
    case Regime::kRegular: return "regular";
    case Regime::kNearSingular: return "near-singular";
    case Regime::kAtRest: return "at rest";
  }
  return "";
}

namespace {

/// Condition number of J.
double condition(const Subject& subject, const Scene& scene) {
  Law law;
  law.W = Eigen::MatrixXd::Identity(subject.dof, subject.dof);
  const RealVector sigma = singular_values(subject.resolve(law, scene).at.J);
  return static_cast<double>(sigma(0) / sigma(sigma.size() - 1));
}

/// A planar arm with a position task. All joints bend in the same direction, by 1 to 2 rad in total, far from stretched
/// and folded postures. Nearly singular: by a few hundredths, so that the square of the condition number of J leaves
/// the Scalar some digits.
Eigen::VectorXd bent_posture(Random& random, const Subject& subject, Regime regime) {
  const double small = subject.epsilon < 1e-10 ? 0.05 : 0.3;
  const double bend = (regime == Regime::kNearSingular ? small : 2.0) / subject.dof;
  Eigen::VectorXd q = random.uniform(subject.dof, 0.5 * bend, bend);
  q(0) = random.uniform(-3.0, 3.0);
  return q;
}

/// Any other arm: by rejection sampling.
Eigen::VectorXd tried_posture(Random& random, const Subject& subject, Regime regime, const Eigen::VectorXd& lengths) {
  const bool near = regime == Regime::kNearSingular;
  const Eigen::VectorXd at_rest = Eigen::VectorXd::Zero(subject.rows);
  while (true) {
    const Eigen::VectorXd q = random.uniform(subject.dof, -2.0, 2.0);
    const double at = condition(subject, {lengths, q, 0.0 * q, at_rest, at_rest, at_rest});
    if (near ? at > 60.0 && at < 200.0 : at < 30.0) return q;
  }
}

}  // namespace

Scene random_scene(Random& random, const Subject& subject, Regime regime) {
  const double rate = regime == Regime::kAtRest ? 0.0 : 1.0;
  Scene scene;
  scene.lengths = random.uniform(subject.dof, 0.5, 1.5);
  scene.q =
      subject.rows == 2 ? bent_posture(random, subject, regime) : tried_posture(random, subject, regime, scene.lengths);
  scene.qd = random.uniform(subject.dof, -rate, rate);
  scene.displacement = random.uniform(subject.rows, -1.0, 1.0);
  scene.xd = random.uniform(subject.rows, -rate, rate);
  scene.xdd = random.uniform(subject.rows, -rate, rate);
  return scene;
}

}  // namespace fpbm::test
