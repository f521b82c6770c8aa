#pragma once

#include "fpbm/core/unrolled.hpp"

namespace fpbm {

/// Trace of (L D Lᵀ)⁻¹ = Σ (1 + Σ_j (L⁻¹)²_ij) / D_i, of m rows. L has ones on its
/// diagonal, which are not read; reciprocal is 1/D.
template <int kMost, typename Value, typename Size>
[[nodiscard, gnu::always_inline]] inline Value inverse_trace(const Value (&L)[kMost][kMost],
                                                             const Value (&reciprocal)[kMost], Size m) noexcept {
  constexpr Constant<0> kFirst{};
  Value inverse[kMost][kMost];  // −L⁻¹ below the diagonal.
  Value trace = reciprocal[0];
  each(next(kFirst), m, [&](auto i) {
    Value row = reciprocal[i];
    each(kFirst, i, [&](auto j) {
      Value entry = L[i][j];
      each(next(j), i, [&](Eigen::Index k) { entry -= L[i][k] * inverse[k][j]; });
      inverse[i][j] = entry;
      row += entry * entry * reciprocal[i];
    });
    trace += row;
  });
  return trace;
}

}  // namespace fpbm
