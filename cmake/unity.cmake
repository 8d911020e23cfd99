# With CMAKE_UNITY_BUILD (scripts/build sets it for a new folder) sources of a target are compiled eight at a time, as most
# of the time goes to headers. Two targets stay out whose unnamed namespaces share names. So do the core's sources with
# functions that are cloned for newer processors: what a clone inlines may be rounded differently, and no answer shall
# depend on its neighbours.
if(CMAKE_UNITY_BUILD)
  foreach(target Freenect test_tracking)
    if(TARGET ${target})
      set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
    endif()
  endforeach()
  get_target_property(sources rgbd_recognition_core SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source ${sources})
    file(STRINGS ${source} clones REGEX RGBD_SIMD_CLONES)
    if(clones)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
endif()
