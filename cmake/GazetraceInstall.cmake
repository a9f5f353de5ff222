# SPDX-License-Identifier: Apache-2.0
# Installs program, library, headers and a package that find_package(gazetrace) reads.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/gazetrace)

install(TARGETS gazetrace EXPORT gazetraceTargets)
if(TARGET gazetrace_cli)
  install(TARGETS gazetrace_cli)
endif()
install(DIRECTORY include/gazetrace DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(FILES ${PROJECT_BINARY_DIR}/include/gazetrace/version.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gazetrace)
install(EXPORT gazetraceTargets NAMESPACE gazetrace:: DESTINATION ${package_dir})

configure_package_config_file(cmake/gazetraceConfig.cmake.in ${PROJECT_BINARY_DIR}/gazetraceConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gazetraceConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gazetraceConfig.cmake ${PROJECT_BINARY_DIR}/gazetraceConfigVersion.cmake
  cmake/FindOpenColorIO.cmake cmake/GazetraceFindDependencies.cmake DESTINATION ${package_dir})
