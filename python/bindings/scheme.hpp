#pragma once

#include <optional>
#include <string>
#include <variant>

#include "fpbm/resolver/fpbm.hpp"
#include "fpbm/resolver/man.hpp"
#include "fpbm/resolver/wmvn.hpp"

namespace fpbm::bindings {

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
  std::string repr = {};

  [[nodiscard]] Level level() const noexcept { return law == Law::kWMVN ? Level::kVelocity : Level::kAcceleration; }

  /// Calls visitor(scheme) with the library's scheme of N joints, dof of them where N is dynamic.
  /// Throws std::invalid_argument where a parameter is wrong or does not fit the number of joints.
  template <int N, typename Visitor>
  auto visit(int dof, Visitor&& visitor) const {
    const NullSpace<N> null_space = make_null_space<N>(dof);
    if (law == Law::kMAN) return visitor(MAN<N>(null_space));
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
    if (law == Law::kWMVN) return visitor(WMVN<N, double, Weights>(W, k, null_space));
    return visitor(FPBM<N, double, Weights>(alpha, W, k1, k2, null_space));
  }

  template <int N>
  [[nodiscard]] NullSpace<N> make_null_space(int dof) const {
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
    return result;
  }
};

}  // namespace fpbm::bindings
