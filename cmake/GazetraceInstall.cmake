# SPDX-License-Identifier: Apache-2.0
# Installs program, library, headers and a package that find_package(gazetrace) reads; with the program its manual pages,
# its completion in shells, reports, imports, the add-on for Blender and the example that `gazetrace demo` shows. `cpack` makes a
# Debian package of all this, the manual and the Python package.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/gazetrace)

install(TARGETS gazetrace EXPORT gazetraceTargets)
if(TARGET gazetrace_cli)
  install(TARGETS gazetrace_cli)
  set(shell_dir ${PROJECT_BINARY_DIR}/shell)
  file(MAKE_DIRECTORY ${shell_dir})
  add_custom_command(OUTPUT ${shell_dir}/made
    COMMAND ${CMAKE_COMMAND} -E rm -rf man1 gz  # pages of commands that are gone
    COMMAND gazetrace_cli man --folder ${shell_dir}/man1
    COMMAND gazetrace_cli completion bash > ${shell_dir}/gazetrace
    COMMAND gazetrace_cli completion zsh > ${shell_dir}/_gazetrace
    COMMAND gazetrace_cli completion fish > ${shell_dir}/gazetrace.fish
    COMMAND sh -c "mkdir -p gz && for page in man1/*.1; do gzip -9nc $page > gz/\${page#man1/}.gz || exit 1; done"
    COMMAND ${CMAKE_COMMAND} -E touch ${shell_dir}/made
    WORKING_DIRECTORY ${shell_dir}
    DEPENDS gazetrace_cli VERBATIM COMMENT "Writing manual pages and completion")
  add_custom_target(gazetrace_shell ALL DEPENDS ${shell_dir}/made)
  install(DIRECTORY ${shell_dir}/gz/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${shell_dir}/gazetrace DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${shell_dir}/_gazetrace DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  install(FILES ${shell_dir}/gazetrace.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
  set(data_dir ${CMAKE_INSTALL_DATADIR}/gazetrace)
  install(PROGRAMS ${PROJECT_BINARY_DIR}/installed-bin/gazetrace-report ${PROJECT_BINARY_DIR}/installed-bin/gazetrace-gaze-report
    ${PROJECT_BINARY_DIR}/installed-bin/gazetrace-gaze-iohub ${PROJECT_BINARY_DIR}/installed-bin/gazetrace-import TYPE BIN)
  install(DIRECTORY python/gazetrace_report DESTINATION ${data_dir}/python PATTERN __pycache__ EXCLUDE)
  install(DIRECTORY blender/gazetrace_blender DESTINATION ${data_dir}/blender PATTERN __pycache__ EXCLUDE)
  install(FILES examples/example.toml examples/demo.toml DESTINATION ${data_dir}/examples)
  install(DIRECTORY scenes/courtyard DESTINATION ${data_dir}/scenes)
  install(FILES scenes/README.md DESTINATION ${data_dir}/scenes)
  install(DIRECTORY gazelogs DESTINATION ${data_dir} FILES_MATCHING PATTERN "*.csv" PATTERN "*.md" PATTERN "LICENSE*"
    PATTERN "*.json" PATTERN "*.tsv.gz")
endif()
# In the same places as in the sources, so that the pages' links lead somewhere.
install(FILES LICENSE README.md CHANGELOG.md CONTRIBUTING.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES src/CMakeLists.txt DESTINATION ${CMAKE_INSTALL_DOCDIR}/src)
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN __pycache__ EXCLUDE)
foreach(folder blender gazelogs include scenes src tests)
  file(GLOB_RECURSE pages CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${folder}/*.md)
  foreach(page IN LISTS pages)
    cmake_path(GET page PARENT_PATH place)
    install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${place})
  endforeach()
endforeach()
install(DIRECTORY include/gazetrace DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(FILES ${PROJECT_BINARY_DIR}/include/gazetrace/version.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gazetrace)
install(EXPORT gazetraceTargets NAMESPACE gazetrace:: DESTINATION ${package_dir})

configure_package_config_file(cmake/gazetraceConfig.cmake.in ${PROJECT_BINARY_DIR}/gazetraceConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gazetraceConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gazetraceConfig.cmake ${PROJECT_BINARY_DIR}/gazetraceConfigVersion.cmake
  cmake/FindOpenColorIO.cmake cmake/GazetraceFindDependencies.cmake DESTINATION ${package_dir})

if(PROJECT_IS_TOP_LEVEL)
  include(GazetraceDebian)
endif()
