# SPDX-License-Identifier: Apache-2.0
# libgazetrace_pictures.so: the only file that calls OpenImageIO, as a module that the library opens when it first needs a
# picture (core/picture_module.hpp).
if(GAZETRACE_WHEEL)
  find_package(WebP REQUIRED)  # a static OpenImageIO names it, and does not find it
endif()
find_package(OpenImageIO REQUIRED)
# Debian's OpenImageIO names OpenCV's headers, which its -dev package does not bring along and nothing here needs.
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
set(oiio_existing "")
foreach(dir IN LISTS oiio_includes)
  if(EXISTS "${dir}")
    list(APPEND oiio_existing "${dir}")
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_existing}")

add_library(gazetrace_pictures MODULE core/open_image_io.cpp)
target_include_directories(gazetrace_pictures PRIVATE ${PROJECT_SOURCE_DIR}/include ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(gazetrace_pictures PRIVATE gazetrace_flags OpenImageIO::OpenImageIO)
if(GAZETRACE_WHEEL)  # whose OpenImageIO is a static library, of which the module uses a part and shows nothing
  target_link_options(gazetrace_pictures PRIVATE LINKER:--gc-sections,--exclude-libs,ALL)
endif()
set(picture_module_dir ${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR})
set_target_properties(gazetrace_pictures PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${picture_module_dir}
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
add_dependencies(gazetrace gazetrace_pictures)

# The library refuses a module that was compiled with other headers than its own.
set(build ${PROJECT_VERSION})
foreach(header core/picture_module.hpp core/image_io.hpp core/primaries.hpp)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${header})
  file(SHA256 ${CMAKE_CURRENT_SOURCE_DIR}/${header} digest)
  string(APPEND build "-${digest}")
endforeach()
set_property(SOURCE core/open_image_io.cpp core/picture_module.cpp APPEND PROPERTY
  COMPILE_DEFINITIONS GAZETRACE_PICTURE_MODULE_BUILD="${build}")
file(RELATIVE_PATH bin_to_lib /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
set_property(SOURCE core/picture_module.cpp APPEND PROPERTY COMPILE_DEFINITIONS
  GAZETRACE_LIBRARY_DIR="${CMAKE_INSTALL_FULL_LIBDIR}" GAZETRACE_LIBRARY_FOLDER="${bin_to_lib}")
# Of a program, too, whose project has the library as a part of itself and installs nothing else of it.
install(TARGETS gazetrace_pictures LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})

# Whatever links the library looks for the module where it was built or installed; program and Python package, which are
# installed with it and moved, look beside themselves and have INSTALL_RPATH. As an old kind of tag, since sanitizers open
# modules in the program's name, and the loader asks the new kind of whoever opens them only.
target_link_options(gazetrace INTERFACE
  $<BUILD_INTERFACE:$<$<NOT:$<BOOL:$<TARGET_PROPERTY:INSTALL_RPATH>>>:LINKER:--disable-new-dtags,-rpath,${picture_module_dir}>>
  $<INSTALL_INTERFACE:LINKER:-rpath,$<INSTALL_PREFIX>/${CMAKE_INSTALL_LIBDIR}>)
