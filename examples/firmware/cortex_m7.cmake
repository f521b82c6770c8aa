# A Cortex-M7 with a floating-point unit for float only, with Debian's gcc-arm-none-eabi and newlib-nano.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-sp-d16")
set(CMAKE_EXE_LINKER_FLAGS_INIT "--specs=nano.specs -nostartfiles")
set(CMAKE_CROSSCOMPILING_EMULATOR
    qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none -icount shift=0
    -chardev stdio,id=console -semihosting-config enable=on,chardev=console -kernel)
