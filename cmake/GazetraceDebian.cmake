# SPDX-License-Identifier: Apache-2.0
# The Debian package: everything that is installed, and the Python package for the system's own Python, where it is built
# (preset package).
set(GAZETRACE_DIST_PACKAGES "" CACHE STRING "Folder of Python packages, below the prefix, where the package is installed; empty: it is not")

set(python_depends "python3 (>= 3.11)")  # reports and imports
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "")
if(TARGET gazetrace_python AND GAZETRACE_DIST_PACKAGES)
  # A module fits one version of Python.
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" python_version "${GAZETRACE_PYTHON_VERSION}")
  math(EXPR next_minor "${CMAKE_MATCH_2} + 1")
  set(python_depends "python3 (>= ${python_version}), python3 (<< ${CMAKE_MATCH_1}.${next_minor}), python3-numpy")
  install(TARGETS gazetrace_python LIBRARY DESTINATION ${GAZETRACE_DIST_PACKAGES}/gazetrace)
  install(FILES ${PROJECT_BINARY_DIR}/python/gazetrace/_build.py DESTINATION ${GAZETRACE_DIST_PACKAGES}/gazetrace)
  install(DIRECTORY python/gazetrace DESTINATION ${GAZETRACE_DIST_PACKAGES} PATTERN __pycache__ EXCLUDE)
  # Reports and add-on lie in folders of their own, where any Python and any Blender can take them from.
  foreach(package python/gazetrace_report blender/gazetrace_blender)
    cmake_path(GET package FILENAME name)
    file(RELATIVE_PATH place /${GAZETRACE_DIST_PACKAGES} /${CMAKE_INSTALL_DATADIR}/gazetrace/${package})
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/links)
    file(CREATE_LINK ${place} ${PROJECT_BINARY_DIR}/links/${name} SYMBOLIC)
    install(FILES ${PROJECT_BINARY_DIR}/links/${name} DESTINATION ${GAZETRACE_DIST_PACKAGES})
  endforeach()
  list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/postinst ${CMAKE_CURRENT_LIST_DIR}/debian/prerm)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/debian/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
  # Under the name by which Debian's tools look for it.
  execute_process(COMMAND gzip -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz)
  install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR})
endif()

# What the program needs is found in its libraries; whoever builds against the library needs theirs as well.
file(STRINGS cmake/debian-packages.txt packages REGEX "-dev$")
list(FILTER packages EXCLUDE REGEX "gtest|gmock|benchmark|cli11")
list(JOIN packages ", " packages)
set(CPACK_GENERATOR DEB)
# Debian wants an address, and the developers have none in common: a domain of RFC 2606 that is nobody's.
set(CPACK_PACKAGE_CONTACT "The gazetrace developers <noreply@gazetrace.invalid>")
set(CPACK_PACKAGE_VENDOR gazetrace)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
  "A glTF scene, a camera path and a gaze log go in; a colour-managed image
sequence with per-frame timing comes out. The package holds the program with
its manual, the module gazetrace for Python, reports, imports of other
programs' scenes, an add-on for Blender, and the library for C++.")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "${python_depends}")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "ffmpeg, python3-jinja2, python3-matplotlib, python3-pandas")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "${packages}")
include(CPack)
