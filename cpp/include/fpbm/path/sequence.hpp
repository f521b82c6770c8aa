#pragma once

#include <limits>
#include <type_traits>

#include "fpbm/path/path.hpp"

namespace fpbm {

/// One path after another: the second path starts at the end of the first. For more than two paths, nest sequences.
template <typename First, typename Second>
class Sequence {
 public:
  using Scalar = typename First::Scalar;
  using Space = typename First::Space;
  static_assert(std::is_same_v<Space, typename Second::Space> && std::is_same_v<Scalar, typename Second::Scalar>,
                "both paths must have the same task space and the same Scalar");

  Sequence(const First& first, const Second& second)
      : first_(first), second_(second), end_of_first_(first.sample(first.duration()).x) {}

  [[nodiscard]] Scalar duration() const noexcept { return first_.duration() + second_.duration(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    const Scalar T = first_.duration();
    // A step of an integrator ends at a multiple of its length. Because of round-off, a step may end just before or
    // after T.
    if (since < T * (Scalar(1) - kRounding)) return sample_within(first_, t < T ? t : T, since);
    const Scalar begun = t > T ? t - T : Scalar(0);
    Reference<Space, Scalar> reference = sample_within(second_, begun, since > T ? since - T : Scalar(0));
    reference.x = Space::template compose<Scalar>(end_of_first_, reference.x);
    return reference;
  }

 private:
  /// Relative tolerance. A multiple k h of the step h = T/k has a round-off error of at most ε.
  static constexpr Scalar kRounding = 8 * std::numeric_limits<Scalar>::epsilon();

  First first_;
  Second second_;
  typename Space::template Point<Scalar> end_of_first_;
};

}  // namespace fpbm
