# Finds Eigen 3.4 in the system, or else in the Python package cmeel-eigen.
find_package(Eigen3 3.4 QUIET NO_MODULE)
if(NOT Eigen3_FOUND)
  find_package(Python QUIET COMPONENTS Interpreter)
  if(Python_FOUND)
    execute_process(COMMAND "${Python_EXECUTABLE}" -m cmeel cmake
                    OUTPUT_VARIABLE cmeel_prefix OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    file(TO_CMAKE_PATH "${cmeel_prefix}" cmeel_prefix)
    find_package(Eigen3 3.4 QUIET NO_MODULE HINTS ${cmeel_prefix})
  endif()
endif()
if(NOT Eigen3_FOUND)
  message(FATAL_ERROR "fpbm needs Eigen 3.4: install libeigen3-dev (Debian) or cmeel-eigen (pip), "
                      "or set Eigen3_DIR to the folder that holds Eigen3Config.cmake")
endif()
