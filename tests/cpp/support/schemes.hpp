#pragma once

#include <optional>
#include <string>

#include "fpbm/fpbm.hpp"
#include "support/textbook.hpp"

/// The library's schemes, built from the textbook's laws: the one list of schemes that the tests have.
namespace fpbm::test {

/// What a scheme can be told.
struct Takes {
  bool acceleration;            ///< Its level.
  std::optional<double> alpha;  ///< Its share of WMVN; empty where the caller chooses it.
  bool feedback;
  bool weights;
  bool dense;  ///< All of W, and not its diagonal alone.
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

/// Calls visit(name, takes, make) for every scheme, where make(law) is the library's scheme of that law; with dense
/// weights besides diagonal ones only where kDense says so.
template <int N, typename S = double, bool kDense = true, typename Visit>
void for_every_scheme(Visit&& visit) {
  const auto diagonal = [](const Law& law) { return Vector<N, S>(law.W.diagonal().cast<S>()); };
  [[maybe_unused]] const auto dense = [](const Law& law) { return Matrix<N, N, S>(law.W.cast<S>()); };
  const auto z = [](const Law& law) { return make_null_space<N, S>(law); };
  const auto damping = [](const Law& law) { return make_damping<S>(law); };
  const auto number = [](double value) { return static_cast<S>(value); };

  visit("MVN", Takes{false, 0.0, true, false, false},
        [=](const Law& law) { return MVN<N, S>(number(law.k), z(law), damping(law)); });
  visit("MAN", Takes{true, 0.0, false, false, false}, [=](const Law& law) { return MAN<N, S>(z(law), damping(law)); });
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
  if constexpr (kDense) visit_weighted("_dense", true, dense);
}

}  // namespace fpbm::test
