#pragma once

#include <cfloat>

// The library requires IEEE 754 arithmetic.
//
// An infinite bound means that there is no bound, and an arm brakes if a value is NaN. If compiler flags exclude
// infinity and NaN, or let the compiler reorder sums, the results are wrong, and no error is reported. Compilation
// therefore fails if a macro reveals a flag that breaks IEEE arithmetic. g++ before version 12 only reveals that IEEE
// arithmetic is incomplete. clang does not reveal -fassociative-math alone; the library is correct with this flag
// (sincos.hpp).
#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0) ||    \
    defined(__ASSOCIATIVE_MATH__) || defined(__NO_SIGNED_ZEROS__) ||                                                   \
    (defined(__GCC_IEC_559) && __GCC_IEC_559 == 0 && __GNUC__ < 12 && (defined(__x86_64__) || defined(__aarch64__)) && \
     !defined(__clang__))
#error "fpbm needs IEEE arithmetic, with infinity and NaN: compile without -ffast-math, -Ofast and the flags they set"
#endif

namespace fpbm {

/// Whether the results of operations on doubles may have excess precision before they are stored, as on the x87 FPU
/// (g++ -mfpmath=387, and 32-bit programs).
inline constexpr bool kHasExcessDigits = FLT_EVAL_METHOD == 2 || FLT_EVAL_METHOD < 0;

}  // namespace fpbm
