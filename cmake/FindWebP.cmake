# SPDX-License-Identifier: Apache-2.0
# Debian's WebP comes with pkg-config files only. Defines WebP::webp, WebP::webpdemux and WebP::libwebpmux, for the wheel's
# OpenImageIO.
find_path(WebP_INCLUDE_DIR webp/mux.h)
set(needed WebP_INCLUDE_DIR)
foreach(name webp webpdemux webpmux)
  find_library(WebP_${name}_LIBRARY ${name})
  list(APPEND needed WebP_${name}_LIBRARY)
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(WebP REQUIRED_VARS ${needed})
foreach(target webp webpdemux libwebpmux)
  string(REGEX REPLACE "^lib" "" name ${target})
  if(WebP_FOUND AND NOT TARGET WebP::${target})
    add_library(WebP::${target} UNKNOWN IMPORTED)
    set_target_properties(WebP::${target} PROPERTIES
      IMPORTED_LOCATION "${WebP_${name}_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${WebP_INCLUDE_DIR}")
  endif()
endforeach()
