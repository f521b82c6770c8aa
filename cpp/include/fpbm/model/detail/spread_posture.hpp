#pragma once

#include <cmath>

#include "fpbm/model/joint.hpp"

namespace fpbm {

/// The first primes.
inline constexpr int kPrimes[kMaxDof] = {
    2,   3,   5,   7,   11,  13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,  59,  61,  67,  71,  73,  79,
    83,  89,  97,  101, 103, 107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193,
    197, 199, 211, 223, 227, 229, 233, 239, 241, 251, 257, 263, 269, 271, 277, 281, 283, 293, 307, 311};

/// Posture k of a sequence that fills the ranges of the joints evenly: Weyl's sequence, with multiples of the square
/// roots of the primes, modulo 1 (H. Weyl, Über die Gleichverteilung von Zahlen mod. Eins, 1916). A missing bound is
/// replaced by −3 or 3 [rad or m], nearly a full turn.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> spread_posture(const JointLimits<N, Scalar>& limits, int k) {
  return entrywise(limits.lower, [&](Eigen::Index i) {
    const double multiple = (k + 1) * std::sqrt(static_cast<double>(kPrimes[i]));
    const auto fraction = static_cast<Scalar>(multiple - std::floor(multiple));
    const Scalar low = std::isfinite(limits.lower(i)) ? limits.lower(i) : Scalar(-3);
    const Scalar high = std::isfinite(limits.upper(i)) ? limits.upper(i) : Scalar(3);
    return low + fraction * (high - low);
  });
}

}  // namespace fpbm
