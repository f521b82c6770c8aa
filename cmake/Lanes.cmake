# Whether code in a processor's lanes can be compiled (FPBM_HAS_SIMD), and for x86-64 (FPBM_HAS_LANES), with which options
# for each kind of those processors. Some standard libraries have the header and little in it, so what the lanes need of
# it is tried.
include(CheckCXXSourceCompiles)
set(CMAKE_REQUIRED_FLAGS ${CMAKE_CXX17_STANDARD_COMPILE_OPTION})
check_cxx_source_compiles("
  #include <experimental/simd>
  int main() {
    const std::experimental::native_simd<double> lanes([](auto i) { return 1.0 + i; });
    return all_of(isfinite(sqrt(lanes))) ? 0 : 1;
  }" FPBM_HAS_SIMD)
check_cxx_source_compiles("int main() { return __x86_64__ - 1; }" FPBM_ON_X86_64)
unset(CMAKE_REQUIRED_FLAGS)
set(FPBM_HAS_LANES FALSE)
if(FPBM_HAS_SIMD AND FPBM_ON_X86_64)
  set(FPBM_HAS_LANES TRUE)
endif()
set(lane_options -fno-math-errno)
set(avx2_options -mavx2 -mfma)
set(avx512_options ${avx2_options} -mavx512f -mavx512dq -mavx512vl -mavx512bw -mprefer-vector-width=512)
