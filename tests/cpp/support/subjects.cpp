#include "support/subjects.hpp"

#include <algorithm>

namespace fpbm::test {

std::vector<Subject> subjects() {
  std::vector<Subject> all;
  for (const auto& some : {subjects_n2(), subjects_n4(), subjects_n7(), subjects_dynamic(), subjects_float()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

Law random_law(Random& random, const Subject& subject, bool has_null_space) {
  const Eigen::Index n = subject.dof;
  Law law;
  law.kind = subject.kind;
  law.alpha = std::clamp(random.uniform(-0.3, 1.3), 0.0, 1.0);  // Both ends are paths of their own through the code.
  law.k = random.uniform(0.0, 5.0);
  law.k1 = random.uniform(0.0, 5.0);
  law.k2 = random.uniform(0.0, 5.0);
  law.W = Eigen::MatrixXd::Identity(n, n);
  if (subject.dense) {
    law.W = random.positive_definite(n);
  } else if (subject.weighted) {
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

Scene random_scene(Random& random, const Subject& subject, Regime regime) {
  const Eigen::Index n = subject.dof;
  // All joints bend the same way, by 1 to 2 rad in all: far from straight and from folded. Near a singular posture by
  // a few hundredths, as long as the square of J's condition number leaves the Scalar some digits.
  const double small = subject.epsilon < 1e-10 ? 0.05 : 0.3;
  const double bend = (regime == Regime::kNearSingular ? small : 2.0) / static_cast<double>(n);
  const double rate = regime == Regime::kAtRest ? 0.0 : 1.0;
  Scene scene;
  scene.lengths = random.uniform(n, 0.5, 1.5);
  scene.q = random.uniform(n, 0.5 * bend, bend);
  scene.q(0) = random.uniform(-3.0, 3.0);
  scene.qd = random.uniform(n, -rate, rate);
  scene.displacement = random.uniform(2, -1.0, 1.0);
  scene.xd = random.uniform(2, -rate, rate);
  scene.xdd = random.uniform(2, -rate, rate);
  return scene;
}

}  // namespace fpbm::test
