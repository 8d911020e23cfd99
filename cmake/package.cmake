# Installs the libraries that know no ROS with a package for plain CMake: find_package(rgbd_recognition_core), targets
# rgbd_recognition::core, training, evaluation, simulation. catkin's own package is called rgbd_recognition.
# catkin_lint knows neither targets of a function of ours nor files that CMake writes.
#catkin_lint: ignore missing_file undefined_target
include(CMakePackageConfigHelpers)
set(libraries core training evaluation simulation)
foreach(library ${libraries})
  set_target_properties(rgbd_recognition_${library} PROPERTIES EXPORT_NAME ${library})
  install(TARGETS rgbd_recognition_${library} EXPORT rgbd_recognition_core_targets
    LIBRARY DESTINATION lib ARCHIVE DESTINATION lib RUNTIME DESTINATION bin)
endforeach()
set(package_folder lib/cmake/rgbd_recognition_core)
install(EXPORT rgbd_recognition_core_targets NAMESPACE rgbd_recognition:: DESTINATION ${package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/rgbd_recognition_core-config.cmake.in
  ${PROJECT_BINARY_DIR}/rgbd_recognition_core-config.cmake INSTALL_DESTINATION ${package_folder})
install(FILES ${PROJECT_BINARY_DIR}/rgbd_recognition_core-config.cmake DESTINATION ${package_folder})
if(NOT RGBD_RECOGNITION_ROS)
  install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION include/${PROJECT_NAME} PATTERN ros EXCLUDE)
  install(DIRECTORY config DESTINATION share/${PROJECT_NAME})
endif()
