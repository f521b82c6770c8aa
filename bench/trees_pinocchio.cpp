#include <cstdio>
#include <cstdlib>

#include "pinocchio_tree.hpp"
#include "trees.hpp"

namespace bench {
namespace {

template <typename Case>
class TreeByPinocchio {
 public:
  static constexpr int N = Case::kDof;
  static constexpr const char* kLibrary = "pinocchio";

  template <Rates rates>
  void move(const fpbm::State<N>& at) {
    q_ = at.q;
    if constexpr (rates != Rates::kNone) qd_ = at.qd;
    motions = rates == Rates::kNone       ? &tree_.move(q_)
              : rates == Rates::kJacobian ? &tree_.move_with_rates(q_, qd_)
                                          : &tree_.move_with_bias(q_, qd_);
  }

  const std::vector<PinocchioTree::Motion>* motions = nullptr;

 private:
  PinocchioTree tree_{Case::tree()};
  Eigen::VectorXd q_;
  Eigen::VectorXd qd_;
};

/// Largest difference from the results of this library.
template <typename Case>
double difference() {
  OurTree<Case> ours;
  TreeByPinocchio<Case> peer;
  double worst = 0.0;
  const auto compare = [&](const auto& a, const auto& b) { worst = std::max(worst, (a - b).cwiseAbs().maxCoeff()); };
  for (const auto& state : states_of<Case>()) {
    for (int with_bias = 0; with_bias < 2; ++with_bias) {
      ours.template move<Rates::kBias>(state);
      with_bias != 0 ? peer.template move<Rates::kBias>(state) : peer.template move<Rates::kJacobian>(state);
      for (std::size_t i = 0; i < 2; ++i) {
        const auto& [x, J, Jd, bias] = ours.motions[i];
        const auto& theirs = (*peer.motions)[i];
        compare(x.p, theirs.p);
        compare(x.R, theirs.R);
        compare(J, theirs.J);
        with_bias != 0 ? compare(bias, theirs.bias) : compare(Jd, theirs.Jd);
      }
    }
  }
  return worst;
}

template <typename Case>
bool add() {
  if (const double worst = difference<Case>(); !(worst < 1e-12)) {
    std::fprintf(stderr, "%s: Pinocchio's kinematics differ by %g\n", Case::name().c_str(), worst);
    std::exit(EXIT_FAILURE);
  }
  add_tree<TreeByPinocchio, Case>();
  return true;
}

[[maybe_unused]] const bool kAdded = add<TwoPandas>() && add<UpperBody>();

}  // namespace
}  // namespace bench
