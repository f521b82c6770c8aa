# Configures a package with stand-ins for the packages of ROS and for an installed fpbm. The headers of the
# repository must precede the installed headers.
#   -DSOURCE=folder of the package
#   -DBUILD=folder that this script replaces
file(REMOVE_RECURSE ${BUILD})
set(packages ${BUILD}/packages)
foreach(name IN ITEMS controller_interface fpbm hardware_interface pluginlib rclcpp rclcpp_lifecycle realtime_tools urdf)
  file(WRITE ${packages}/Find${name}.cmake "
    add_library(${name}::${name} INTERFACE IMPORTED)
    set_target_properties(${name}::${name} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${packages}/installed_${name})
    set(${name}_FOUND TRUE)")
  file(MAKE_DIRECTORY ${packages}/installed_${name})
endforeach()
foreach(name IN ITEMS diagnostic_msgs geometry_msgs moveit_core moveit_msgs shape_msgs std_msgs trajectory_msgs)
  file(WRITE ${packages}/Find${name}.cmake "set(${name}_FOUND TRUE)")
endforeach()
file(WRITE ${packages}/Findgenerate_parameter_library.cmake "
  function(generate_parameter_library name)
    add_library(\${name} INTERFACE)
  endfunction()
  set(generate_parameter_library_FOUND TRUE)")
file(WRITE ${packages}/Findament_cmake.cmake "
  foreach(name IN ITEMS ament_export_targets ament_export_dependencies ament_package pluginlib_export_plugin_description_file)
    cmake_language(EVAL CODE \"function(\${name})
    endfunction()\")
  endforeach()
  set(ament_cmake_FOUND TRUE)")
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD}/build -G ${GENERATOR} -DCMAKE_MODULE_PATH=${packages}
          -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DBUILD_TESTING=OFF
  RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(failed)
  message(FATAL_ERROR "${output}")
endif()
file(READ ${BUILD}/build/compile_commands.json commands)
string(FIND "${commands}" "cpp/include" repository)
string(FIND "${commands}" "installed_fpbm" installed)
if(repository EQUAL -1 OR installed EQUAL -1 OR repository GREATER installed)
  message(FATAL_ERROR "the installed fpbm comes before the repository's headers: at ${installed}, ${repository}")
endif()
