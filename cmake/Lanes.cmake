# FPBM_HAS_SIMD: code in SIMD lanes can be compiled. FPBM_HAS_LANES: also for all kinds of x86-64 processors.
# avx2_options, avx512_options: options for each kind. Some standard libraries have an incomplete header. Therefore, a
# program tries the functions that the lanes need.
include(CheckCXXCompilerFlag)
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
# By default, g++ copies structs of AVX2 vectors in parts of 16 bytes. A load of a whole vector then waits for two
# stores. For AVX-512, the default is the preferred width.
check_cxx_compiler_flag("-mmove-max=256 -mstore-max=256" FPBM_HAS_MOVE_MAX)
if(FPBM_HAS_MOVE_MAX)
  list(APPEND avx2_options -mmove-max=256 -mstore-max=256)
endif()

# Sets a variable to the kinds in a choice: native, all, or a list of kinds. native is the kind of this machine's
# processor, by the macros of the compiler; in a cross build, where the processor is unknown, native is all.
function(fpbm_lane_kinds choice result)
  set(all)
  if(FPBM_HAS_LANES)
    set(all avx2 avx512)
  endif()
  set(kinds ${choice})
  if(choice STREQUAL "all" OR (choice STREQUAL "native" AND CMAKE_CROSSCOMPILING))
    set(kinds ${all})
  elseif(choice STREQUAL "native")
    set(kinds)
    set(avx2_macros "defined(__AVX2__) && defined(__FMA__)")
    set(avx512_macros "${avx2_macros} && defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__) && defined(__AVX512BW__)")
    set(CMAKE_REQUIRED_FLAGS -march=native)
    foreach(kind IN LISTS all)
      check_cxx_source_compiles("
        #if !(${${kind}_macros})
        #error
        #endif
        int main() { return 0; }" FPBM_IS_${kind})
      if(FPBM_IS_${kind})
        set(kinds ${kind})
      endif()
    endforeach()
  endif()
  foreach(kind IN LISTS kinds)
    if(NOT kind MATCHES "^avx(2|512)$")
      message(FATAL_ERROR "FPBM_LANES names '${kind}', but must be native, all, or a list of avx2 and avx512")
    endif()
  endforeach()
  set(${result} ${kinds} PARENT_SCOPE)
endfunction()
