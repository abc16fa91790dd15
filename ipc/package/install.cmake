# Installs the libraries, the program, a CMake package and a pkg-config file.
include(CMakePackageConfigHelpers)

install(TARGETS splinecast splinecast_static EXPORT splinecast-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY core/include/ ipc/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TARGET splinecast_program)
  install(TARGETS splinecast_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/splinecast)
install(EXPORT splinecast-targets NAMESPACE splinecast:: DESTINATION ${package_dir})
include(ipc/package/eigen.cmake)
configure_package_config_file(ipc/package/splinecast-config.cmake.in splinecast-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(splinecast-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/splinecast-config.cmake
              ${PROJECT_BINARY_DIR}/splinecast-config-version.cmake
        DESTINATION ${package_dir})

# Relative, so that the files may be installed anywhere: cmake --install BUILD --prefix PREFIX.
file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(ipc/package/splinecast.pc.in splinecast.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/splinecast.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
