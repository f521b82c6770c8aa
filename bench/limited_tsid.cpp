#include <tsid/formulations/inverse-dynamics-formulation-acc-force.hpp>
#include <tsid/robots/robot-wrapper.hpp>
#include <tsid/solvers/solver-HQP-eiquadprog-fast.hpp>
#include <tsid/tasks/task-joint-posVelAcc-bounds.hpp>
#include <tsid/tasks/task-se3-equality.hpp>

#include "limited.hpp"
#include "pinocchio_model.hpp"

// TSID's own method on the same problem, with eiquadprog-fast: the tip task is a cost, and TSID computes the bounds on
// the joints. TSID always computes the dynamics of the arm too, and has no bounds on jerk.
namespace bench {
namespace {

template <typename Case_, Bounds>
class Tsid {
 public:
  using Case = Case_;
  static constexpr const char* kLibrary = "tsid";

  Tsid() {
    const auto limits = bench::limits<Case>(Bounds::kAcceleration).bounds();
    bounds_.setPositionBounds(limits.lower, limits.upper);
    bounds_.setVelocityBounds(limits.velocity);
    bounds_.setAccelerationBounds(limits.acceleration);
    bounds_.setVerbose(false);
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(6);
    tip_.Kp(kGain2 * ones);
    tip_.Kd(kGain1 * ones);
    tip_.useLocalFrame(false);
    if constexpr (!Case::kWithOrientation) tip_.setMask((Eigen::VectorXd(6) << 1, 1, 1, 0, 0, 0).finished());
    program_.addMotionTask(bounds_, 1.0, 0);
    program_.addMotionTask(tip_, 1.0, 1);
    solver_.resize(program_.nVar(), program_.nEq(), program_.nIn());
  }

  void move(const Asked<Case>& asked) {
    q_ = asked.state.q;
    qd_ = asked.state.qd;
    const auto& x = asked.reference.x;
    if constexpr (Case::kWithOrientation) {
      pose_ << x.p, x.R.reshaped();
      rate_ = asked.reference.xd;
      second_ = asked.reference.xdd;
    } else {
      pose_ << x, Eigen::Matrix3d::Identity().reshaped();
      rate_.head<3>() = asked.reference.xd;
      second_.head<3>() = asked.reference.xdd;
    }
    sample_.setValue(pose_);
    sample_.setDerivative(rate_);
    sample_.setSecondDerivative(second_);
    tip_.setReference(sample_);
    problem_ = &program_.computeProblemData(0.0, q_, qd_);
  }

  bool limit(const Asked<Case>&, Answer<Case>& answer) {
    const auto& found = solver_.solve(*problem_);
    if (found.status != tsid::solvers::HQP_STATUS_OPTIMAL) return false;
    answer = {program_.getAccelerations(found), 1.0};
    return true;
  }

 private:
  tsid::robots::RobotWrapper robot_{pinocchio_model(Case::Robot::chain()),
                                    tsid::robots::RobotWrapper::FIXED_BASE_SYSTEM};
  tsid::tasks::TaskJointPosVelAccBounds bounds_{"bounds", robot_, kTick, false};
  tsid::tasks::TaskSE3Equality tip_{"tip", robot_, "tip"};
  tsid::InverseDynamicsFormulationAccForce program_{"program", robot_};
  tsid::solvers::SolverHQuadProgFast solver_{"solver"};
  tsid::trajectories::TrajectorySample sample_{12, 6};
  const tsid::solvers::HQPData* problem_ = nullptr;
  Eigen::VectorXd q_;
  Eigen::VectorXd qd_;
  Eigen::VectorXd pose_{12};
  Eigen::VectorXd rate_ = Eigen::VectorXd::Zero(6);
  Eigen::VectorXd second_ = Eigen::VectorXd::Zero(6);
};

/// Stops if a small motion far from all limits differs from the motion of this library.
template <typename Case>
void require_agreement() {
  Tsid<Case, Bounds::kAcceleration> tsid;
  OursLimited<Case, Bounds::kAcceleration> ours;
  for (const auto& [state, reference] : inputs(Case{})) {
    Asked<Case> asked{{{state.q, 0.01 * state.qd}, reference}, {}};
    fpbm::Kinematics<typename Case::Space, Case::kDof> kinematics;
    Case::Robot::arm().kinematics(state.q, kinematics);
    asked.reference.x = Case::Space::template displace<double>(kinematics.tip, 0.01 * reference.xd);
    asked.reference.xd *= 0.01;
    asked.reference.xdd *= 0.01;
    ours.move(asked);
    tsid.move(asked);
    Answer<Case> answer{fpbm::Vector<Case::kDof>::Zero(), 0.0};
    const bool solved = tsid.limit(asked, answer);
    const fpbm::Vector<Case::kRows> expected = ours.J() * ours.desired();
    const double difference = (ours.J() * answer.u - expected).norm() / expected.norm();
    if (!solved || !(difference <= 1e-3)) {
      std::fprintf(stderr, "the result of TSID differs by %g\n", difference);
      std::exit(EXIT_FAILURE);
    }
  }
}

template <typename Arm>
void add() {
  require_agreement<Arm>();
  add_limited<Tsid<Arm, Bounds::kAcceleration>, Bounds::kAcceleration>();
}
[[maybe_unused]] const bool kAdded = (add<PandaPose>(), add<Case<Panda, fpbm::Position<3>>>(), true);

}  // namespace
}  // namespace bench
