# With CMAKE_UNITY_BUILD (scripts/build sets it for a new folder) sources of a target are compiled eight at a time, as most
# of the time goes to headers. The core stays out: what a function's clone for newer processors inlines may be rounded
# differently, so no answer shall depend on a kernel's neighbours.
if(CMAKE_UNITY_BUILD)
  set_target_properties(rgbd_recognition_core PROPERTIES UNITY_BUILD OFF)
endif()
