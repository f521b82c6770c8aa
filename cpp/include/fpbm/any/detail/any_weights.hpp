#pragma once

#include <Eigen/Core>
#include <variant>

#include "fpbm/scheme/detail/dense_weights.hpp"
#include "fpbm/scheme/weights.hpp"

namespace fpbm {

/// One type for all weights, whose number of joints is known at run time: a law is compiled once for all three types.
class AnyWeights {
  /// Calls f(weights) with the stored weights. std::visit() would instantiate about a hundred classes and functions for
  /// each call.
  template <typename F>
  auto held(const F& f) const {
    if (const auto* diagonal = std::get_if<DiagonalWeights<Eigen::Dynamic>>(&weights_)) return f(*diagonal);
    if (const auto* dense = std::get_if<DenseWeights<Eigen::Dynamic>>(&weights_)) return f(*dense);
    return f(UnitWeights{});
  }

 public:
  explicit AnyWeights(const UnitWeights& weights) : weights_(weights) {}
  explicit AnyWeights(const DiagonalWeights<Eigen::Dynamic>& weights) : weights_(weights) {}
  explicit AnyWeights(const DenseWeights<Eigen::Dynamic>& weights) : weights_(weights) {}

  void require_dof(Eigen::Index dof) const {
    held([&](const auto& weights) { weights.require_dof(dof); });
  }

  [[nodiscard]] bool is_unit() const noexcept { return std::holds_alternative<UnitWeights>(weights_); }

  template <typename Scalar>
  [[nodiscard]] Scalar inverse_bound() const noexcept {
    return held([](const auto& weights) { return weights.template inverse_bound<Scalar>(); });
  }

  // Not inlined, so that the large callers stay small. Templates, so that only the functions that a program calls are
  // compiled.
  template <typename = void>
  [[nodiscard, gnu::noinline]] Vector<Eigen::Dynamic> root(const Vector<Eigen::Dynamic>& a) const noexcept {
    return held([&](const auto& weights) -> Vector<Eigen::Dynamic> { return weights.root(a); });
  }

  template <typename = void>
  [[nodiscard, gnu::noinline]] Vector<Eigen::Dynamic> inverse_root(const Vector<Eigen::Dynamic>& a) const noexcept {
    return held([&](const auto& weights) -> Vector<Eigen::Dynamic> { return weights.inverse_root(a); });
  }

  template <int Columns>
  [[nodiscard, gnu::noinline]] Matrix<Eigen::Dynamic, Columns> root_transpose(
      const Matrix<Eigen::Dynamic, Columns>& A) const noexcept {
    return held([&](const auto& weights) -> Matrix<Eigen::Dynamic, Columns> { return weights.root_transpose(A); });
  }

  template <int M>
  [[nodiscard, gnu::noinline]] Matrix<Eigen::Dynamic, M, Pair<double>> with_unit(
      const Matrix<M, Eigen::Dynamic>& J) const noexcept {
    return held([&](const auto& weights) { return weights.with_unit(J); });
  }

 private:
  std::variant<UnitWeights, DiagonalWeights<Eigen::Dynamic>, DenseWeights<Eigen::Dynamic>> weights_;
};

}  // namespace fpbm
