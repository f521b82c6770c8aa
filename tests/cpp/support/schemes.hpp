#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include "fpbm/any/detail/any_weights.hpp"
#include "fpbm/fpbm.hpp"
#include "support/textbook.hpp"

/// The schemes of the library, constructed from the laws of the textbook: the single list of schemes of the tests.
namespace fpbm::test {

/// Parameters of a scheme.
struct Takes {
  bool acceleration;            ///< Whether the scheme is at acceleration level.
  std::optional<double> alpha;  ///< Weight of WMVN in the balance; empty if the caller chooses it.
  bool feedback;
  bool weights;
  bool dense;  ///< Whether W may be dense, not only diagonal.
};

template <int N, typename S>
[[nodiscard]] NullSpace<N, S> make_null_space(const Law& law) {
  if (!law.has_null_space) return {};
  return NullSpace<N, S>{}
      .with_damping(static_cast<S>(law.damping))
      .with_rest_posture(law.q_rest.cast<S>(), static_cast<S>(law.stiffness))
      .with_free_choice(law.c.cast<S>());
}

template <typename S>
[[nodiscard]] SingularDamping<S> make_damping(const Law& law) {
  return SingularDamping<S>(static_cast<S>(law.singular_radius), static_cast<S>(law.singular_brake));
}

/// Weights in a list of schemes.
enum class Kinds { kAll, kUnitAndDiagonal, kDiagonal };

/// Weights of run-time size become AnyWeights, so that a scheme is compiled once for all their types. Other weights do
/// not change.
template <int N, typename S, typename Weights>
[[nodiscard]] auto any_kind(const Weights& weights) {
  if constexpr (N == Eigen::Dynamic && std::is_same_v<S, double>) {
    return AnyWeights(weights);
  } else {
    return weights;
  }
}

/// Calls visit(name, takes, make) for every scheme with weights of these types. make(law) returns the scheme of the
/// library for the law.
template <int N, typename S = double, Kinds kKinds = Kinds::kAll, typename Visit>
void for_every_scheme(Visit&& visit) {
  const auto diagonal = [](const Law& law) {
    return any_kind<N, S>(DiagonalWeights<N, S>(Vector<N, S>(law.W.diagonal().cast<S>())));
  };
  [[maybe_unused]] const auto dense = [](const Law& law) {
    return any_kind<N, S>(DenseWeights<N, S>(Matrix<N, N, S>(law.W.cast<S>())));
  };
  const auto z = [](const Law& law) { return make_null_space<N, S>(law); };
  const auto damping = [](const Law& law) { return make_damping<S>(law); };
  const auto number = [](double value) { return static_cast<S>(value); };

  constexpr Takes kMvn{false, 0.0, true, false, false};
  constexpr Takes kMan{true, 0.0, false, false, false};
  if constexpr (N == Eigen::Dynamic && std::is_same_v<S, double>) {
    const auto unit = any_kind<N, S>(UnitWeights{});
    visit("MVN", kMvn, [=](const Law& law) { return WMVN<N, S>(unit, number(law.k), z(law), damping(law)); });
    visit("MAN", kMan, [=](const Law& law) { return Balanced<N, S>(S(0), unit, z(law), damping(law)); });
  } else if constexpr (kKinds != Kinds::kDiagonal) {
    visit("MVN", kMvn, [=](const Law& law) { return MVN<N, S>(number(law.k), z(law), damping(law)); });
    visit("MAN", kMan, [=](const Law& law) { return MAN<N, S>(z(law), damping(law)); });
  }
  const auto visit_weighted = [&](const std::string& suffix, bool is_dense, const auto& W) {
    visit("WMVN" + suffix, Takes{false, 1.0, true, true, is_dense},
          [=](const Law& law) { return WMVN<N, S>(W(law), number(law.k), z(law), damping(law)); });
    visit("WMVNAcceleration" + suffix, Takes{true, 1.0, false, true, is_dense},
          [=](const Law& law) { return WMVNAcceleration<N, S>(W(law), z(law), damping(law)); });
    visit("Balanced" + suffix, Takes{true, {}, false, true, is_dense},
          [=](const Law& law) { return Balanced<N, S>(number(law.alpha), W(law), z(law), damping(law)); });
    visit("FPBM" + suffix, Takes{true, {}, true, true, is_dense}, [=](const Law& law) {
      return FPBM<N, S>(number(law.alpha), W(law), number(law.k1), number(law.k2), z(law), damping(law));
    });
  };
  visit_weighted("", false, diagonal);
  if constexpr (kKinds == Kinds::kAll) visit_weighted("_dense", true, dense);
}

}  // namespace fpbm::test
