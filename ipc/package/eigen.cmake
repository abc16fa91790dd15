# The component `eigen`: targets for users of splinecast/eigen.hpp, which add Eigen to a library. They
# compile nothing. Their export is a file of its own, so that the package finds Eigen only for users
# who request the component.
foreach(library splinecast splinecast_static)
  string(REPLACE splinecast splinecast_eigen target ${library})
  string(REPLACE splinecast_ "" name ${target})
  add_library(${target} INTERFACE)
  target_link_libraries(${target} INTERFACE ${library} Eigen3::Eigen)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  add_library(splinecast::${name} ALIAS ${target})
  install(TARGETS ${target} EXPORT splinecast-eigen-targets)
endforeach()
install(EXPORT splinecast-eigen-targets NAMESPACE splinecast:: DESTINATION ${package_dir})
