#pragma once

#include <cmath>

#include "fpbm/model/chain.hpp"

namespace fpbm {

/// Posture k of a sequence that fills the ranges of an arm's joints evenly, those without ends from −3 to 3: Weyl's,
/// multiples of the roots of the primes, modulo 1.
template <typename Scalar>
[[nodiscard]] Vector<Eigen::Dynamic, Scalar> spread_posture(const Chain<Scalar>& chain, int k) {
  constexpr int kPrimes[kMaxDof] = {2,  3,  5,  7,  11, 13, 17, 19, 23, 29,  31,  37,  41,  43,  47,  53,
                                    59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107, 109, 113, 127, 131};
  Vector<Eigen::Dynamic, Scalar> q(static_cast<Eigen::Index>(chain.joints.size()));
  Eigen::Index i = 0;
  for (const Joint<Scalar>& joint : chain.joints) {
    if (joint.mimic.joint >= 0) continue;
    const double way = (k + 1) * std::sqrt(static_cast<double>(kPrimes[i]));
    const auto share = static_cast<Scalar>(way - std::floor(way));
    const Scalar low = std::isfinite(joint.bounds.lower) ? joint.bounds.lower : Scalar(-3);
    const Scalar high = std::isfinite(joint.bounds.upper) ? joint.bounds.upper : Scalar(3);
    q(i++) = low + share * (high - low);
  }
  return q.head(i);
}

}  // namespace fpbm
