# macOS by zig (pip install ziglang), which carries Apple's headers and a linker. The programs cannot be run here.
set(FPBM_MACOS_ARCH aarch64 CACHE STRING "Kind of Mac: aarch64 or x86_64")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES FPBM_MACOS_ARCH)
set(CMAKE_SYSTEM_NAME Darwin)
set(CMAKE_SYSTEM_PROCESSOR ${FPBM_MACOS_ARCH})
set(CMAKE_CXX_COMPILER python-zig c++ -target ${FPBM_MACOS_ARCH}-macos.11.0)
set(CMAKE_C_COMPILER python-zig cc -target ${FPBM_MACOS_ARCH}-macos.11.0)
# At low optimisation levels, zig enables sanitizers.
set(CMAKE_CXX_FLAGS_INIT -fno-sanitize=all)
# The linker of zig crashes if CMake passes -bundle.
set(CMAKE_MODULE_LINKER_FLAGS_INIT -dynamiclib)
# CMAKE_AR and CMAKE_RANLIB must be names of programs, without arguments.
set(CMAKE_CXX_ARCHIVE_CREATE "python-zig ar qc <TARGET> <LINK_FLAGS> <OBJECTS>")
set(CMAKE_CXX_ARCHIVE_FINISH "python-zig ranlib <TARGET>")
# Nothing is installed, and strip of another system does not support Mach-O.
set(CMAKE_INSTALL_NAME_TOOL /bin/true)
set(CMAKE_STRIP /bin/true)
