#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "fpbm/scheme/fpbm.hpp"
#include "fpbm/scheme/man.hpp"
#include "fpbm/scheme/wmvn.hpp"

namespace fpbm::bindings {

template <typename Space>
class TaskModel;
struct Recipe;

/// A second task as Python sees it: the tip of another arm on a point, or the tip's z axis along a direction.
struct PySecondTask {
  template <typename Space>
  struct Point {
    std::shared_ptr<const TaskModel<Space>> arm;
    int dof;
    typename Space::template Point<double> x;
  };
  struct Direction {
    Vector<3> d;
  };

  std::variant<Point<Position<2>>, Point<Position<3>>, Direction> what;
  double k1;
  double k2;
  std::string repr;
  std::shared_ptr<const Recipe> recipe;
};

/// A scheme as Python sees it: its parameters, before the number of joints is known.
///
/// Every scheme is one of three of the library's: WMVN (7) with W = I is MVN (6); FPBM (13) without feedback is the
/// balance (16), of which α = 1 is WMVN (9). MAN (8) stands alone.
struct PyScheme {
  enum class Law : unsigned char { kWMVN, kMAN, kFPBM };
  using Diagonal = Vector<Eigen::Dynamic>;
  using Dense = Matrix<Eigen::Dynamic, Eigen::Dynamic>;

  Law law;
  std::variant<std::monostate, Diagonal, Dense> weights = std::monostate{};  ///< None: W = I.
  double alpha = 0.0;
  double k = 0.0;
  double k1 = 0.0;
  double k2 = 0.0;
  double null_damping = 0.0;
  double null_stiffness = 0.0;
  std::optional<Diagonal> rest_posture = std::nullopt;
  std::optional<Diagonal> c = std::nullopt;
  double joint_centring = 0.0;
  double manipulability_gain = 0.0;
  std::optional<PySecondTask> second_task = std::nullopt;
  SingularDamping<> singular = SingularDamping<>::off();
  std::string repr = {};
  std::shared_ptr<const Recipe> recipe = nullptr;

  [[nodiscard]] Level level() const noexcept { return law == Law::kWMVN ? Level::kVelocity : Level::kAcceleration; }

  /// Whether there are objectives that wrap the library's scheme and need an arm.
  [[nodiscard]] bool has_wrappers() const noexcept { return manipulability_gain != 0.0 || second_task.has_value(); }

  /// Calls visitor(scheme) with the library's scheme of N joints, dof of them where N is dynamic.
  /// Throws std::invalid_argument where a parameter is wrong, does not fit the number of joints, or needs an arm.
  template <int N, typename Visitor>
  auto visit(int dof, Visitor&& visitor) const {
    if (has_wrappers() || joint_centring != 0.0) {
      throw std::invalid_argument(
          "scheme: joint_centring, manipulability_gain and second_task need an arm, and there is none here");
    }
    return visit_core<N>(JointLimits<N>::none(dof), visitor);
  }

  /// The same for an arm of these limits, but for the objectives that wrap.
  template <int N, typename Visitor>
  auto visit_core(const JointLimits<N>& limits, Visitor&& visitor) const {
    const Eigen::Index dof = limits.lower.size();
    const NullSpace<N> null_space = make_null_space<N>(limits);
    if (law == Law::kMAN) return visitor(MAN<N>(null_space, singular));
    if (const auto* W = std::get_if<Dense>(&weights)) {
      validation::require_size("weights", W->rows(), dof);
      return visit_weighted<N>(DenseWeights<N>(*W), null_space, visitor);
    }
    Vector<N> w = Vector<N>::Ones(dof);
    if (const auto* diagonal = std::get_if<Diagonal>(&weights)) {
      validation::require_size("weights", diagonal->size(), dof);
      w = *diagonal;
    }
    return visit_weighted<N>(DiagonalWeights<N>(w), null_space, visitor);
  }

 private:
  template <int N, typename Weights, typename Visitor>
  auto visit_weighted(const Weights& W, const NullSpace<N>& null_space, Visitor&& visitor) const {
    if (law == Law::kWMVN) return visitor(WMVN<N, double, Weights>(W, k, null_space, singular));
    return visitor(FPBM<N, double, Weights>(alpha, W, k1, k2, null_space, singular));
  }

  template <int N>
  [[nodiscard]] NullSpace<N> make_null_space(const JointLimits<N>& limits) const {
    const Eigen::Index dof = limits.lower.size();
    NullSpace<N> result;
    result = result.with_damping(null_damping);
    if (rest_posture) {
      validation::require_size("rest_posture", rest_posture->size(), dof);
      result = result.with_rest_posture(*rest_posture, null_stiffness);
    } else if (null_stiffness != 0.0) {
      validation::fail("null_stiffness", null_stiffness, "0 where no rest_posture is given");
    }
    if (c) {
      validation::require_size("c", c->size(), dof);
      result = result.with_free_choice(*c);
    }
    if (joint_centring != 0.0) result = result.with_joint_centring(limits, joint_centring);
    return result;
  }
};

}  // namespace fpbm::bindings
