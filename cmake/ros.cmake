# All that ties the package to catkin: messages, reconfigure options, exports, install rules of what is no target.
find_package(catkin REQUIRED COMPONENTS
  actionlib actionlib_msgs camera_info_manager cv_bridge diagnostic_msgs diagnostic_updater dynamic_reconfigure
  geometry_msgs image_transport message_filters message_generation nodelet pluginlib rosbag_storage roscpp sensor_msgs
  std_msgs std_srvs tf2_msgs tf2_ros visualization_msgs)

# Not everywhere: with it, detections come as vision_msgs/Detection3DArray, too.
find_package(vision_msgs QUIET)
if(vision_msgs_FOUND)
  include_directories(SYSTEM ${vision_msgs_INCLUDE_DIRS})
else()
  message(STATUS "vision_msgs not found: no topic detections_3d")
endif()

add_message_files(FILES
  Detection.msg
  DetectionArray.msg
  Feedback.msg
  Hypothesis.msg
  HypothesisArray.msg
  ImageFeatures.msg
  ObjectMatches.msg
  ObjectSummary.msg
  Patch.msg
  SceneFeatures.msg
  Segmentation.msg
  StageTiming.msg
  Track.msg
  TrackArray.msg
  TrainingProgress.msg)
add_service_files(FILES
  Detect.srv
  GetObject.srv
  ListObjects.srv
  RemoveObject.srv
  RenameObject.srv
  TrainObject.srv)
add_action_files(FILES
  Detect.action
  TrainObject.action)
generate_messages(DEPENDENCIES actionlib_msgs geometry_msgs sensor_msgs std_msgs)

generate_dynamic_reconfigure_options(
  cfg/FeatureExtraction.cfg
  cfg/HypothesisGeneration.cfg
  cfg/Openni2Camera.cfg
  cfg/ReprojectionVerification.cfg
  cfg/Segmentation.cfg)

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES rgbd_recognition_core rgbd_recognition_ros
  CATKIN_DEPENDS
    actionlib actionlib_msgs camera_info_manager cv_bridge diagnostic_msgs diagnostic_updater dynamic_reconfigure
    geometry_msgs image_transport message_filters message_runtime nodelet pluginlib rosbag_storage roscpp sensor_msgs
    std_msgs std_srvs tf2_msgs tf2_ros visualization_msgs
  DEPENDS EIGEN3 OpenCV)

set(RGBD_RECOGNITION_INSTALL_TARGETS
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY include/${PROJECT_NAME}/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
install(DIRECTORY config launch rviz DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

# Not by catkin_install_python, after which rosrun finds it twice: in the devel space and in the sources.
file(MAKE_DIRECTORY ${CATKIN_DEVEL_PREFIX}/lib/${PROJECT_NAME})
foreach(script doctor collision_objects)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/scripts/${script}.py ${CATKIN_DEVEL_PREFIX}/lib/${PROJECT_NAME}/${script} SYMBOLIC)
  install(PROGRAMS scripts/${script}.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION} RENAME ${script})
endforeach()
install(FILES nodelet_plugins.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
