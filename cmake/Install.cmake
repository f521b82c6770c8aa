include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(config_dir ${CMAKE_INSTALL_DATADIR}/cmake/fpbm)
set(pc_dir ${CMAKE_INSTALL_DATADIR}/pkgconfig)
file(RELATIVE_PATH include_from_pc /prefix/${pc_dir} /prefix/${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/cpp/include/fpbm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS fpbm EXPORT fpbmTargets)
install(EXPORT fpbmTargets NAMESPACE fpbm:: DESTINATION ${config_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/fpbmConfig.cmake.in fpbmConfig.cmake
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(fpbmConfigVersion.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fpbmConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/fpbmConfigVersion.cmake
        DESTINATION ${config_dir})
configure_file(${CMAKE_CURRENT_LIST_DIR}/fpbm.pc.in fpbm.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fpbm.pc DESTINATION ${pc_dir})
