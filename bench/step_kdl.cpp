#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "step.hpp"
#include "textbook.hpp"

// Orocos KDL: the schemes in Eigen on its kinematics, and its own solvers at velocity level.

namespace bench {
namespace {

KDL::Frame frame(const fpbm::Transform<>& transform) {
  KDL::Frame result;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(result.M.data) = transform.R;
  Eigen::Map<Eigen::Vector3d>(result.p.data) = transform.p;
  return result;
}

/// In KDL, the joint of a segment is before its frame: the frame of a segment is the placement of the next joint.
KDL::Chain segments(const fpbm::Chain<>& chain) {
  KDL::Chain result;
  result.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(chain.joints[0].placement)));
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const bool last = i + 1 == chain.joints.size();
    result.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::RotZ), frame(last ? chain.tip : chain.joints[i + 1].placement)));
  }
  return result;
}

template <typename Case>
class Kdl {
 public:
  static constexpr const char* kLibrary = "kdl";

  template <bool kWithRate>
  void move(const fpbm::State<Case::kDof>& state, Motion<Case>& motion) {
    constexpr int M = Case::kRows;
    velocity_.q.data = state.q;
    KDL::Frame tip;
    position_.JntToCart(velocity_.q, tip);
    jacobian_.JntToJac(velocity_.q, J_);
    motion.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(tip.M.data);
    motion.p = Eigen::Map<const Eigen::Vector3d>(tip.p.data);
    motion.J = J_.data.topRows<M>();
    if constexpr (kWithRate) {
      velocity_.qdot.data = state.qd;
      rate_.JntToJacDot(velocity_, Jd_);
      motion.Jd = Jd_.data.topRows<M>();
    }
  }

 private:
  static constexpr unsigned kDof = Case::kDof;

  KDL::Chain chain_ = segments(Case::Robot::chain());
  KDL::ChainFkSolverPos_recursive position_{chain_};
  KDL::ChainJntToJacSolver jacobian_{chain_};
  KDL::ChainJntToJacDotSolver rate_{chain_};
  KDL::JntArrayVel velocity_{kDof};
  KDL::Jacobian J_{kDof};
  KDL::Jacobian Jd_{kDof};
};

template <typename Case, Law law>
using KdlAndEigen = Textbook<Kdl, Case, law>;

/// A solver of KDL, with feedback on the tip pose, which KDL does not include.
template <typename Case_, Law law, typename Solver>
class KdlAlone {
 public:
  using Case = Case_;
  static constexpr Law kLaw = law;
  static constexpr bool kDamps = std::is_same_v<Solver, KDL::ChainIkSolverVel_wdls>;
  static constexpr const char* kLibrary = kDamps ? "kdl_wdls" : "kdl_pinv";

  KdlAlone() {
    if constexpr (kDamps) {
      solver_.setLambda(0.0);
      if constexpr (law == Law::kWMVN) {
        // KDL's weights M correspond to W = M⁻².
        solver_.setWeightJS(weights<Case::kDof>().cwiseSqrt().cwiseInverse().asDiagonal().toDenseMatrix());
      }
    }
  }

  void move(const Input<fpbm::Pose, Case::kDof>& input) {
    q_.data = input.state.q;
    position_.JntToCart(q_, tip_);
  }
  fpbm::Status resolve(const Input<fpbm::Pose, Case::kDof>& input, fpbm::Vector<Case::kDof>& out) {
    KDL::Twist v = KDL::diff(tip_, frame(input.reference.x)) * kGain;
    Eigen::Map<Eigen::Vector3d>(v.vel.data) += input.reference.xd.template head<3>();
    Eigen::Map<Eigen::Vector3d>(v.rot.data) += input.reference.xd.template tail<3>();
    const int error = solver_.CartToJnt(q_, v, qd_);
    out = qd_.data;
    return error == KDL::SolverI::E_NOERROR ? fpbm::Status::kOk : fpbm::Status::kSingular;
  }

 private:
  KDL::Chain chain_ = segments(Case::Robot::chain());
  KDL::ChainFkSolverPos_recursive position_{chain_};
  Solver solver_{chain_};
  KDL::JntArray q_{Case::kDof};
  KDL::JntArray qd_{Case::kDof};
  KDL::Frame tip_;
};

template <typename Case>
void add_solvers() {
  add_step<KdlAlone<Case, Law::kMVN, KDL::ChainIkSolverVel_pinv>>();
  add_step<KdlAlone<Case, Law::kMVN, KDL::ChainIkSolverVel_wdls>>();
  add_step<KdlAlone<Case, Law::kWMVN, KDL::ChainIkSolverVel_wdls>>();
}

[[maybe_unused]] const bool kAdded = [] {
  add_library<KdlAndEigen>();
  add_solvers<PandaPose>();
  add_solvers<Case<Iiwa14, fpbm::Pose>>();
  return true;
}();

}  // namespace
}  // namespace bench
