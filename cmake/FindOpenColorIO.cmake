# SPDX-License-Identifier: Apache-2.0
# Debian's OpenColorIO comes with a pkg-config file only. Defines OpenColorIO::OpenColorIO.
find_package(OpenColorIO CONFIG QUIET)
if(TARGET OpenColorIO::OpenColorIO)  # also where another package asked before
  set(OpenColorIO_FOUND TRUE)
else()
  find_path(OpenColorIO_INCLUDE_DIR OpenColorIO/OpenColorIO.h)
  find_library(OpenColorIO_LIBRARY OpenColorIO)
  if(OpenColorIO_INCLUDE_DIR AND EXISTS "${OpenColorIO_INCLUDE_DIR}/OpenColorIO/OpenColorABI.h")
    file(STRINGS "${OpenColorIO_INCLUDE_DIR}/OpenColorIO/OpenColorABI.h" version_line
         REGEX "define OCIO_VERSION_FULL_STR|define OCIO_VERSION ")
    string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" OpenColorIO_VERSION "${version_line}")
  endif()
  include(FindPackageHandleStandardArgs)
  find_package_handle_standard_args(OpenColorIO
    REQUIRED_VARS OpenColorIO_LIBRARY OpenColorIO_INCLUDE_DIR VERSION_VAR OpenColorIO_VERSION)
  if(OpenColorIO_FOUND)
    add_library(OpenColorIO::OpenColorIO UNKNOWN IMPORTED)
    set_target_properties(OpenColorIO::OpenColorIO PROPERTIES
      IMPORTED_LOCATION "${OpenColorIO_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${OpenColorIO_INCLUDE_DIR}")
  endif()
endif()
