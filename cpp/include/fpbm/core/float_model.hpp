#pragma once

#include <cfloat>

// What the library needs of the compiler's arithmetic: that it is IEEE 754's.
//
// An infinite bound is none, and an arm that meets NaN brakes. Where a compiler may assume that neither occurs, or may
// regroup sums, the answers are wrong without a word; so these flags are refused, as far as a compiler tells of them.
// Before version 12 g++ tells only that something is missing. clang does not tell of -fassociative-math alone, under
// which the library is right (sincos.hpp).
#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0) ||    \
    defined(__ASSOCIATIVE_MATH__) || defined(__NO_SIGNED_ZEROS__) ||                                                   \
    (defined(__GCC_IEC_559) && __GCC_IEC_559 == 0 && __GNUC__ < 12 && (defined(__x86_64__) || defined(__aarch64__)) && \
     !defined(__clang__))
#error "fpbm needs IEEE arithmetic, with infinity and NaN: compile it without -ffast-math, -Ofast, or parts of these"
#endif

namespace fpbm {

/// Whether the result of an operation on doubles may have more digits than a double, until it is stored: on the 8087
/// (g++ -mfpmath=387, and 32-bit programs).
inline constexpr bool kHasExcessDigits = FLT_EVAL_METHOD == 2 || FLT_EVAL_METHOD < 0;

}  // namespace fpbm
