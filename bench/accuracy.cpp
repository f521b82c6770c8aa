#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "cases.hpp"

// Round-off error of the scheme alone: the largest relative error compared with pseudoinverses in long double, by
// decades of the condition number of J, over states near singular postures. FPBM (13) with null-space damping.
namespace bench {
namespace {

using Real = long double;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

constexpr int kDecades = 6;
constexpr int kStates = 4000;  ///< For each arm.
constexpr double kDamping = 2.0;

/// The law as printed. b: commanded acceleration.
RealVector textbook(const RealMatrix& J, const RealMatrix& Jd, const RealVector& b, const RealVector& xd,
                    const RealVector& z) {
  const auto n = J.cols();
  const RealVector roots = weights<Eigen::Dynamic>(n).cast<Real>().cwiseSqrt().cwiseInverse();  // W^(−1/2)
  const auto pseudoinverse = [](const RealMatrix& A) -> RealMatrix {
    return A.completeOrthogonalDecomposition().pseudoInverse();
  };
  const RealMatrix half = pseudoinverse(J * roots.asDiagonal());
  const RealMatrix JWp = roots.asDiagonal() * half;
  const RealVector mu = half.transpose() * (half * xd);
  const auto alpha = static_cast<Real>(kAlpha);
  const RealVector u = alpha * roots.cwiseAbs2().asDiagonal() * (Jd.transpose() * mu) + z;
  return (1 - alpha) * (pseudoinverse(J) * b) + JWp * (alpha * b - J * u) + u;
}

/// Moves q toward a posture with about this condition number, along the gradient of the smallest singular value.
template <typename Kinematics, typename Arm, int N>
void draw(const Arm& arm, double condition, fpbm::Vector<N>& q) {
  for (int pass = 0; pass < 12; ++pass) {
    Kinematics kinematics;
    arm.kinematics(q, kinematics);
    const Eigen::MatrixXd J = kinematics.J;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const auto last = svd.singularValues().size() - 1;
    const double gap = svd.singularValues()(0) / condition - svd.singularValues()(last);
    fpbm::Vector<N> gradient;
    for (int i = 0; i < N; ++i) {
      arm.kinematics(q, fpbm::Vector<N>::Unit(i), kinematics);
      gradient(i) = svd.matrixU().col(last).dot(kinematics.Jd * svd.matrixV().col(last));
    }
    const fpbm::Vector<N> step = gap / (gradient.squaredNorm() + 1e-12) * gradient;
    q += step * std::min(1.0, 0.3 / (step.norm() + 1e-300));
    if (std::abs(gap) < 0.1 * svd.singularValues()(0) / condition) return;
  }
}

struct Row {
  double error[kDecades] = {};
  int failed = 0;
};

template <typename Space, typename Arm>
Row measure(const Arm& arm) {
  constexpr int N = Arm::kDof;
  constexpr int M = Space::kRows;
  using Kinematics = fpbm::Kinematics<Space, N>;
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto random = [&](auto vector, double reach) {
    for (double& value : vector) value = reach * uniform(generator);
    return vector;
  };
  auto fpbm = scheme<Law::kFPBM, N>();
  fpbm.null_space = fpbm::NullSpace<N>().with_damping(kDamping);
  Row row;
  for (int i = 0; i < kStates; ++i) {
    fpbm::State<N> state{random(fpbm::Vector<N>(), 2.5), random(fpbm::Vector<N>(), 1.0)};
    draw<Kinematics>(arm, std::pow(10.0, 3.2 + 2.6 * uniform(generator)), state.q);
    Kinematics kinematics;
    arm.kinematics(state.q, state.qd, kinematics);
    const auto reference_at = [&](const fpbm::Vector<M>& error) {
      return fpbm::Reference<Space>{Space::template displace<double>(kinematics.tip, error),
                                    random(fpbm::Vector<M>(), 0.5), random(fpbm::Vector<M>(), 0.5)};
    };
    const auto reference = reference_at(random(fpbm::Vector<M>(), 0.01));

    const RealMatrix J = kinematics.J.template cast<Real>();
    const RealVector sigma = Eigen::JacobiSVD<RealMatrix>(J).singularValues();
    const auto decade = static_cast<int>(std::log10(static_cast<double>(sigma(0) / sigma(M - 1))));
    if (decade >= kDecades) continue;
    fpbm::Vector<N> qdd;
    if (failed(fpbm.resolve(kinematics, reference, state, qdd))) {
      ++row.failed;
      continue;
    }
    const fpbm::Vector<M> b = fpbm::commanded_acceleration(kGain1, kGain2, kinematics, reference, state);
    const RealVector z = -static_cast<Real>(kDamping) * state.qd.template cast<Real>();
    const RealVector exact = textbook(J, kinematics.Jd.template cast<Real>(), b.template cast<Real>(),
                                      reference.xd.template cast<Real>(), z);
    const auto error = static_cast<double>((qdd.template cast<Real>() - exact).norm() / exact.norm());
    row.error[decade] = std::max(row.error[decade], error);
  }
  return row;
}

void print(const std::string& name, const Row& row) {
  std::printf("%-22s", name.c_str());
  for (const double error : row.error) std::printf("  %8.1e", error);
  std::printf("  %6d\n", row.failed);
}

template <typename Space, int N>
void planar(const char* task) {
  print("planar n = " + std::to_string(N) + ' ' + task,
        measure<Space>(fpbm::PlanarArm<N>(fpbm::Vector<N>::LinSpaced(1.0, 0.5))));
}

template <int N>
void spatial(const std::string& name, const fpbm::Chain<>& chain) {
  const fpbm::SerialArm<N> arm(chain);
  print(name + " position", measure<fpbm::Position<3>>(arm));
  print(name + " pose", measure<fpbm::Pose>(arm));
}

fpbm::Chain<> on_rail(fpbm::Chain<> chain) {
  fpbm::Joint<> rail;
  rail.type = fpbm::JointType::kPrismatic;
  rail.axis = fpbm::Vector<3>::UnitY();
  chain.joints.insert(chain.joints.begin(), rail);
  return chain;
}

}  // namespace
}  // namespace bench

int main() {
  using namespace bench;
  std::printf("%-22s", "condition of J below");
  for (int i = 1; i <= kDecades; ++i) std::printf("  %8.0e", std::pow(10.0, i));
  std::printf("  %6s\n", "failed");
  planar<fpbm::Position<2>, 3>("position");
  planar<fpbm::Position<2>, 4>("position");
  planar<fpbm::Position<2>, 5>("position");
  planar<fpbm::Position<2>, 6>("position");
  planar<fpbm::Position<2>, 7>("position");
  planar<fpbm::Position<2>, 8>("position");
  planar<fpbm::PlanarPose, 3>("pose");
  planar<fpbm::PlanarPose, 4>("pose");
  planar<fpbm::PlanarPose, 5>("pose");
  planar<fpbm::PlanarPose, 8>("pose");
  for (const auto& preset : fpbm::presets::kAll) {
    const fpbm::Chain<> chain = preset.chain();
    if (chain.joints.size() == 6) spatial<6>(preset.name, chain);
    if (chain.joints.size() == 7) spatial<7>(preset.name, chain);
  }
  spatial<8>("panda on rail", on_rail(fpbm::presets::panda()));
}
