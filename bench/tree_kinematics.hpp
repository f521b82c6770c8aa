#pragma once

#include <array>
#include <random>
#include <string>

#include "fpbm/fpbm.hpp"
#include "g1_upper_body.hpp"

// Kinematics of robots with several branches: their frames and J, with J̇ or with J̇q̇.
namespace bench {

struct TwoPandas {
  static constexpr int kDof = 14;
  static std::string name() { return "two_pandas"; }
  static fpbm::Tree<> tree() { return fpbm::presets::two_pandas(); }
};
struct UpperBody {
  static constexpr int kDof = 17;
  static std::string name() { return "g1_upper_body"; }
  static fpbm::Tree<> tree() { return g1_upper_body(); }
};

enum class Rates { kNone, kJacobian, kBias };

/// States around the middle of the joint ranges.
template <typename Case>
[[nodiscard]] std::array<fpbm::State<Case::kDof>, 64> states_of() {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const fpbm::Robot<Case::kDof> robot(Case::tree());
  std::array<fpbm::State<Case::kDof>, 64> states;
  for (auto& [q, qd] : states) {
    for (int i = 0; i < Case::kDof; ++i) {
      const auto& limits = robot.limits();
      q(i) = (limits.lower(i) + limits.upper(i)) / 2 + 0.3 * uniform(generator) * (limits.upper(i) - limits.lower(i));
      qd(i) = uniform(generator);
    }
  }
  return states;
}

/// Placement, J, J̇ and J̇q̇ of a frame.
template <int N>
struct FrameMotion {
  fpbm::Transform<> x;
  fpbm::Matrix<6, N> J;
  fpbm::Matrix<6, N> Jd;
  fpbm::Vector<6> bias;
};

/// This library, for the first two frames of a robot.
template <typename Case>
class OurTree {
 public:
  static constexpr int N = Case::kDof;
  static constexpr const char* kLibrary = "fpbm_cpp";

  template <Rates rates>
  void move(const fpbm::State<N>& at) noexcept {
    if constexpr (rates == Rates::kNone) {
      robot_.update(at.q, state_);
    } else {
      robot_.update(at.q, at.qd, state_);
    }
    for (std::size_t i = 0; i < motions.size(); ++i) {
      auto& [x, J, Jd, bias] = motions[i];
      x = robot_.frame(state_, frames_[i].link, frames_[i].seen);
      robot_.columns(state_, frames_[i].link, x.p,
                     [&](Eigen::Index j, const auto& columns, const auto& turned) noexcept {
                       columns.store(J, j);
                       if constexpr (rates != Rates::kNone) turned.store(Jd, j);
                     });
      if constexpr (rates == Rates::kBias) bias.noalias() = Jd * at.qd;
    }
  }

  std::array<FrameMotion<N>, 2> motions;

 private:
  struct Frame {
    int link;
    fpbm::Transform<> seen;
  };

  fpbm::Tree<> tree_ = Case::tree();
  fpbm::Robot<N> robot_{tree_};
  typename fpbm::Robot<N>::State state_;
  std::array<Frame, 2> frames_{frame(0), frame(1)};

  [[nodiscard]] Frame frame(std::size_t i) const {
    const auto& [name, link, offset] = tree_.frames[i];
    return {link, robot_.in_joint(link, offset)};
  }
};

}  // namespace bench
