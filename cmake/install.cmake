# Two components, and Debian packages: the program; and the library for other programs, by find_package(castray) or
# pkg-config.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # tests need not be built before packages are
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

if(TARGET castray_cli)
  install(TARGETS castray_cli COMPONENT program)
  install(FILES scenes/castray.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/castray COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/castray.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/castray.bash RENAME castray
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/castray.zsh RENAME _castray
    DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/castray.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    COMPONENT program)
endif()

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/castray)
install(TARGETS castray EXPORT castray-targets COMPONENT library INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/castray DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
install(EXPORT castray-targets NAMESPACE castray:: DESTINATION ${package} COMPONENT library)
write_basic_package_version_file(castray-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/castray-config.cmake ${PROJECT_BINARY_DIR}/castray-config-version.cmake DESTINATION ${package}
  COMPONENT library)
file(RELATIVE_PATH CASTRAY_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)  # to the prefix, wherever it is moved
configure_file(cmake/castray.pc.in castray.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/castray.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/castray RENAME copyright COMPONENT program)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libcastray-dev RENAME copyright COMPONENT library)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "the castray authors")
set(CPACK_PACKAGE_CONTACT "the castray authors <castray@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "path tracer for triangle scenes on the CPU")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL library)
if(TARGET castray_cli)
  list(APPEND CPACK_COMPONENTS_ALL program)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME castray)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libcastray-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "g++, libfmt-dev, libgomp1, libopenexr-dev, libpng-dev, libstb-dev, libtinygltf-dev")
include(CPack)
