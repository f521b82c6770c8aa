#pragma once

#include <cstdint>

namespace fpbm {

/// sin and cos of one angle |x| ≤ kReach [rad] in float, with an error of up to 6.1e-8. The bits of the result are
/// equal on all processors that round each product and each sum separately; C libraries differ in the last bit. Uses no
/// double arithmetic, which small processors emulate in software.
///
/// Cody-Waite reduction (see ReducedSinCos) by multiples of π/2 in three parts, then minimax polynomials on |r| ≤ π/4,
/// with relative errors of 3.8e-9 (sine) and 1.2e-10 (cosine).
struct FloatSinCos {
  /// For |x| ≤ kReach, the products of the quadrant k with the first two parts of π/2 are exact: k < 2¹³, and the parts
  /// have 8 and 11 bits.
  static constexpr float kReach = 8192.0F;

  static void evaluate(float x, float& sine, float& cosine) noexcept {
#if defined(__clang__) && __clang_major__ >= 12
#pragma clang fp reassociate(off)  // Reassociation would combine the three parts of π/2.
#endif
    const auto quadrant = static_cast<std::int32_t>(x * 6.36619772e-01F + (x < 0.0F ? -0.5F : 0.5F));
    const auto k = static_cast<float>(quadrant);
    const float first = x - k * 1.5703125F;              // First 8 bits of π/2, exact.
    const float second = k * 4.837512969970703125e-04F;  // Next 11 bits, exact.
    const float third = k * 7.54978995e-08F;             // Remaining bits.
    const float sum = first - second;
    const float r = sum - third;
    const float lost = ((first - sum) - second) + ((sum - r) - third);  // Round-off error of r, below 6e-8.
    const float z = r * r;
    const float sin_tail = z * ((-1.9515282e-04F * z + 8.33216e-03F) * z - 1.6666655e-01F);
    const float sin_r = r + (r * sin_tail + lost);
    const float head = 1.0F - 0.5F * z;
    const float cos_tail = z * z * ((2.4433157e-05F * z - 1.3887316e-03F) * z + 4.1666646e-02F);
    const float cos_r = head + ((((1.0F - head) - 0.5F * z) + cos_tail) - r * lost);

    // Quadrant k mod 4: an odd quadrant swaps sine and cosine. Bit 1 of k is the sign of the sine, bit 1 of k + 1 the
    // sign of the cosine.
    const bool odd = (quadrant & 1) != 0;
    sine = odd ? cos_r : sin_r;
    cosine = odd ? sin_r : cos_r;
    if ((quadrant & 2) != 0) sine = -sine;
    if (((quadrant + 1) & 2) != 0) cosine = -cosine;
  }
};

}  // namespace fpbm
