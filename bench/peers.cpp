#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "fpbm/fpbm.hpp"

#if __has_include(<pinocchio/algorithm/jacobian.hpp>)
#define FPBM_HAS_PINOCCHIO
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#endif

#if __has_include(<kdl/chain.hpp>)
#define FPBM_HAS_KDL
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#endif

// A whole Panda pose step (tip, J, Jd and FPBM with α = 0.6) by this library and by others, in the same run. Those who
// have no such scheme get it from Eigen, fixed in size, as one would write it. Rows are NAME/kinematics and NAME/step.

namespace {

using Pose = fpbm::Pose;
using Joints = Eigen::Matrix<double, 7, 1>;
using Task = Eigen::Matrix<double, 6, 1>;
using Jacobian = Eigen::Matrix<double, 6, 7>;

constexpr double kAlpha = 0.6;
constexpr double kGain1 = 20.0;
constexpr double kGain2 = 100.0;

const Joints& weights() {
  static const Joints w = Joints::LinSpaced(7, 1.0, 7.0);
  return w;
}

struct Input {
  fpbm::State<7> state;
  fpbm::Reference<Pose> reference;
};

/// Tip, J and Jd, linear rows first, in the base frame's axes at the tip.
struct Motion {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
  Jacobian J;
  Jacobian Jd;
};

/// The balance as the paper writes it, with Cholesky factorisations in place of its pseudoinverses.
class EigenFPBM {
 public:
  void resolve(const Motion& motion, const Input& input, Joints& qdd) const {
    const Joints qd = input.state.qd;
    const Task xd = input.reference.xd;
    Task error;
    error.head<3>() = input.reference.x.p - motion.p;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(input.reference.x.R * motion.R.transpose()));
    error.tail<3>() = turn.angle() * turn.axis();
    const Task b = input.reference.xdd - motion.Jd * qd + kGain1 * (xd - motion.J * qd) + kGain2 * error;
    const Eigen::Matrix<double, 7, 6> Jt = motion.J.transpose();
    const Eigen::Matrix<double, 7, 6> WinvJt = inverse_.asDiagonal() * Jt;
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> plain(motion.J * Jt);
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> weighted(motion.J * WinvJt);
    const Joints u = kAlpha * inverse_.cwiseProduct(motion.Jd.transpose() * weighted.solve(xd));
    const Task rest = kAlpha * b - motion.J * u;
    qdd = (1.0 - kAlpha) * (Jt * plain.solve(b)) + u + WinvJt * weighted.solve(rest);
  }

 private:
  Joints inverse_ = weights().cwiseInverse();
};

class Ours {
 public:
  static constexpr const char* kName = "fpbm_cpp";

  void move(const Input& input) { arm_.kinematics(input.state.q, input.state.qd, kinematics_); }
  void resolve(const Input& input, Joints& qdd) {
    fpbm::Vector<7> answer;
    benchmark::DoNotOptimize(scheme_.resolve(kinematics_, input.reference, input.state, answer));
    qdd = answer;
  }

 private:
  fpbm::SerialArm<7> arm_{fpbm::presets::panda()};
  fpbm::FPBM<7> scheme_{kAlpha, fpbm::DiagonalWeights<7>(weights()), kGain1, kGain2};
  fpbm::Kinematics<Pose, 7> kinematics_;
};

#ifdef FPBM_HAS_PINOCCHIO
class Pinocchio {
 public:
  static constexpr const char* kName = "pinocchio";

  Pinocchio() {
    const fpbm::Chain<> chain = fpbm::presets::panda();
    pinocchio::JointIndex parent = 0;
    for (const auto& joint : chain.joints) {
      const pinocchio::SE3 placement(joint.placement.R, joint.placement.p);
      parent = model_.addJoint(parent, pinocchio::JointModelRZ(), placement, joint.name);
    }
    tip_ = model_.addFrame(pinocchio::Frame("tip", parent, 0, {chain.tip.R, chain.tip.p}, pinocchio::OP_FRAME));
    data_ = pinocchio::Data(model_);
    q_.resize(7);
    qd_.resize(7);
    J_.setZero(6, 7);
    Jd_.setZero(6, 7);
  }

  void move(const Input& input) {
    q_ = input.state.q;
    qd_ = input.state.qd;
    pinocchio::computeJointJacobiansTimeVariation(model_, data_, q_, qd_);
    pinocchio::updateFramePlacement(model_, data_, tip_);
    pinocchio::getFrameJacobian(model_, data_, tip_, pinocchio::LOCAL_WORLD_ALIGNED, J_);
    pinocchio::getFrameJacobianTimeVariation(model_, data_, tip_, pinocchio::LOCAL_WORLD_ALIGNED, Jd_);
    motion_ = {data_.oMf[tip_].rotation(), data_.oMf[tip_].translation(), J_, Jd_};
  }
  void resolve(const Input& input, Joints& qdd) { scheme_.resolve(motion_, input, qdd); }

 private:
  pinocchio::Model model_;
  pinocchio::Data data_;
  pinocchio::FrameIndex tip_;
  Eigen::VectorXd q_;
  Eigen::VectorXd qd_;
  pinocchio::Data::Matrix6x J_;
  pinocchio::Data::Matrix6x Jd_;
  Motion motion_;
  EigenFPBM scheme_;
};
#endif

#ifdef FPBM_HAS_KDL
class Kdl {
 public:
  static constexpr const char* kName = "kdl";

  Kdl() : chain_(panda()), position_(chain_), jacobian_(chain_), rate_(chain_), q_(7), qd_(7), J_(7), Jd_(7) {}

  void move(const Input& input) {
    q_.data = input.state.q;
    qd_.data = input.state.qd;
    const KDL::JntArrayVel velocity(q_, qd_);
    KDL::Frame tip;
    position_.JntToCart(q_, tip);
    jacobian_.JntToJac(q_, J_);
    rate_.JntToJacDot(velocity, Jd_);
    motion_.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(tip.M.data);
    motion_.p = Eigen::Map<const Eigen::Vector3d>(tip.p.data);
    motion_.J = J_.data;
    motion_.Jd = Jd_.data;
  }
  void resolve(const Input& input, Joints& qdd) { scheme_.resolve(motion_, input, qdd); }

 private:
  static KDL::Frame frame(const fpbm::Transform<>& transform) {
    KDL::Frame result;
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(result.M.data) = transform.R;
    Eigen::Map<Eigen::Vector3d>(result.p.data) = transform.p;
    return result;
  }

  /// A segment of KDL turns before it goes on: its placement is that of the joint after it.
  static KDL::Chain panda() {
    const fpbm::Chain<> chain = fpbm::presets::panda();
    KDL::Chain result;
    result.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(chain.joints[0].placement)));
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const bool last = i + 1 == chain.joints.size();
      result.addSegment(
          KDL::Segment(KDL::Joint(KDL::Joint::RotZ), frame(last ? chain.tip : chain.joints[i + 1].placement)));
    }
    return result;
  }

  KDL::Chain chain_;
  KDL::ChainFkSolverPos_recursive position_;
  KDL::ChainJntToJacSolver jacobian_;
  KDL::ChainJntToJacDotSolver rate_;
  KDL::JntArray q_;
  KDL::JntArray qd_;
  KDL::Jacobian J_;
  KDL::Jacobian Jd_;
  Motion motion_;
  EigenFPBM scheme_;
};
#endif

/// States about a bent posture, and references near by; the same for all.
std::vector<Input> inputs() {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  const Joints bent = (Joints() << 0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.8).finished();
  const auto vector = [&](auto size, double reach) {
    Eigen::Matrix<double, decltype(size)::value, 1> v;
    for (double& value : v) value = reach * uniform(generator);
    return v;
  };
  using Six = std::integral_constant<int, 6>;
  using Seven = std::integral_constant<int, 7>;
  std::vector<Input> result(64);
  for (Input& input : result) {
    input.state = {bent + vector(Seven{}, 0.5), vector(Seven{}, 1.0)};
    fpbm::Kinematics<Pose, 7> kinematics;
    arm.kinematics(input.state.q, kinematics);
    input.reference = {Pose::displace<double>(kinematics.tip, vector(Six{}, 0.01)), vector(Six{}, 0.5),
                       vector(Six{}, 0.5)};
  }
  return result;
}

template <typename Library>
void kinematics(benchmark::State& bench) {
  Library library;
  const std::vector<Input> ring = inputs();
  std::size_t turn = 0;
  for (auto _ : bench) {
    library.move(ring[++turn % ring.size()]);
    benchmark::DoNotOptimize(&library);
    benchmark::ClobberMemory();
  }
}

template <typename Library>
void step(benchmark::State& bench) {
  Library library;
  const std::vector<Input> ring = inputs();
  Joints qdd = Joints::Zero();
  std::size_t turn = 0;
  for (auto _ : bench) {
    const Input& input = ring[++turn % ring.size()];
    library.move(input);
    library.resolve(input, qdd);
    benchmark::DoNotOptimize(&qdd);
    benchmark::ClobberMemory();
  }
}

/// The largest difference from this library's answer, relative: all do the same job.
template <typename Library>
double disagreement() {
  Ours ours;
  Library library;
  double worst = 0.0;
  for (const Input& input : inputs()) {
    Joints expected;
    Joints found;
    ours.move(input);
    ours.resolve(input, expected);
    library.move(input);
    library.resolve(input, found);
    worst = std::max(worst, (found - expected).norm() / expected.norm());
  }
  return worst;
}

double least(const std::vector<double>& times) {
  return *std::min_element(times.begin(), times.end());
}

template <typename Library>
void add() {
  const double difference = disagreement<Library>();
  if (!(difference < 1e-9)) {
    std::fprintf(stderr, "%s answers otherwise, by %g\n", Library::kName, difference);
    std::exit(EXIT_FAILURE);
  }
  const std::string name = Library::kName;
  benchmark::RegisterBenchmark((name + "/kinematics").c_str(), kinematics<Library>)->ComputeStatistics("min", least);
  benchmark::RegisterBenchmark((name + "/step").c_str(), step<Library>)->ComputeStatistics("min", least);
}

[[maybe_unused]] const bool kRegistered = [] {
  add<Ours>();
#ifdef FPBM_HAS_PINOCCHIO
  add<Pinocchio>();
#endif
#ifdef FPBM_HAS_KDL
  add<Kdl>();
#endif
  return true;
}();

}  // namespace
