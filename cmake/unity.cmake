# With CMAKE_UNITY_BUILD (scripts/build sets it for a new folder) sources of a target are compiled eight at a time, as most
# of the time goes to headers. Unnamed namespaces then meet; targets stay out in which many have the same names. For the
# core there is a second reason: what a function's clone for newer processors inlines may be rounded differently, so no
# answer shall depend on a kernel's neighbours. simulate: Appearance is two types, the simulation's and verification's.
foreach(target rgbd_recognition_core simulate Freenect test_tracking)
  if(TARGET ${target})
    set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
  endif()
endforeach()
