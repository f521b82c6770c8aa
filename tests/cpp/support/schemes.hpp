#pragma once

#include "fpbm/fpbm.hpp"
#include "support/textbook.hpp"

/// The library's schemes, built from the textbook's laws.
namespace fpbm::test {

template <int N, typename Scalar>
[[nodiscard]] NullSpace<N, Scalar> make_null_space(const Law& law) {
  if (!law.has_null_space) return {};
  return NullSpace<N, Scalar>{}
      .with_damping(static_cast<Scalar>(law.damping))
      .with_rest_posture(law.q_rest.cast<Scalar>(), static_cast<Scalar>(law.stiffness))
      .with_free_choice(law.c.cast<Scalar>());
}

/// How to build a weight from W.
template <typename Weights>
struct WeightsTraits;

template <int N, typename Scalar>
struct WeightsTraits<DiagonalWeights<N, Scalar>> {
  static constexpr bool kDense = false;
  static DiagonalWeights<N, Scalar> make(const Eigen::MatrixXd& W) {
    return DiagonalWeights<N, Scalar>(W.diagonal().cast<Scalar>());
  }
};

template <int N, typename Scalar>
struct WeightsTraits<DenseWeights<N, Scalar>> {
  static constexpr bool kDense = true;
  static DenseWeights<N, Scalar> make(const Eigen::MatrixXd& W) { return DenseWeights<N, Scalar>(W.cast<Scalar>()); }
};

/// How to build a scheme from a law.
template <typename Scheme>
struct SchemeTraits;

template <int N, typename Scalar>
struct SchemeTraits<MVN<N, Scalar>> {
  static constexpr Kind kKind = Kind::kMVN;
  static constexpr bool kWeighted = false;
  static constexpr bool kDense = false;
  static MVN<N, Scalar> make(const Law& law) {
    return MVN<N, Scalar>(static_cast<Scalar>(law.k), make_null_space<N, Scalar>(law));
  }
};

template <int N, typename Scalar, typename Weights>
struct SchemeTraits<WMVN<N, Scalar, Weights>> : WeightsTraits<Weights> {
  static constexpr Kind kKind = Kind::kWMVN;
  static constexpr bool kWeighted = true;
  static WMVN<N, Scalar, Weights> make(const Law& law) {
    return WMVN<N, Scalar, Weights>(WeightsTraits<Weights>::make(law.W), static_cast<Scalar>(law.k),
                                    make_null_space<N, Scalar>(law));
  }
};

template <int N, typename Scalar>
struct SchemeTraits<MAN<N, Scalar>> {
  static constexpr Kind kKind = Kind::kMAN;
  static constexpr bool kWeighted = false;
  static constexpr bool kDense = false;
  static MAN<N, Scalar> make(const Law& law) { return MAN<N, Scalar>(make_null_space<N, Scalar>(law)); }
};

template <int N, typename Scalar, typename Weights>
struct SchemeTraits<WMVNAcceleration<N, Scalar, Weights>> : WeightsTraits<Weights> {
  static constexpr Kind kKind = Kind::kWMVNAcceleration;
  static constexpr bool kWeighted = true;
  static WMVNAcceleration<N, Scalar, Weights> make(const Law& law) {
    return WMVNAcceleration<N, Scalar, Weights>(WeightsTraits<Weights>::make(law.W), make_null_space<N, Scalar>(law));
  }
};

template <int N, typename Scalar, typename Weights>
struct SchemeTraits<Balanced<N, Scalar, Weights>> : WeightsTraits<Weights> {
  static constexpr Kind kKind = Kind::kBalanced;
  static constexpr bool kWeighted = true;
  static Balanced<N, Scalar, Weights> make(const Law& law) {
    return Balanced<N, Scalar, Weights>(static_cast<Scalar>(law.alpha), WeightsTraits<Weights>::make(law.W),
                                        make_null_space<N, Scalar>(law));
  }
};

template <int N, typename Scalar, typename Weights>
struct SchemeTraits<FPBM<N, Scalar, Weights>> : WeightsTraits<Weights> {
  static constexpr Kind kKind = Kind::kFPBM;
  static constexpr bool kWeighted = true;
  static FPBM<N, Scalar, Weights> make(const Law& law) {
    return FPBM<N, Scalar, Weights>(static_cast<Scalar>(law.alpha), WeightsTraits<Weights>::make(law.W),
                                    static_cast<Scalar>(law.k1), static_cast<Scalar>(law.k2),
                                    make_null_space<N, Scalar>(law));
  }
};

}  // namespace fpbm::test
