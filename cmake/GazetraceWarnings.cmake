# SPDX-License-Identifier: Apache-2.0
# Warnings, sanitizers and numeric flags of our own targets. Never exported: a consumer keeps its own.
add_library(gazetrace_flags INTERFACE)
target_compile_features(gazetrace_flags INTERFACE cxx_std_20)
target_compile_options(gazetrace_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Wold-style-cast
  -Woverloaded-virtual -Wcast-align
  # The same bits from every kernel variant and instruction set: no fused multiply-add unless written,
  # and sqrt inline instead of a call that sets errno.
  -ffp-contract=off -fno-math-errno)
# GCC 12 at -O3 takes std::string's own copying for overlapping, overlong or uninitialised memory. These warnings stay
# on at -O2, which is how the presets compile everything but inner loops.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(gazetrace_flags INTERFACE "$<$<CONFIG:Release>:-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-array-bounds;-Wno-maybe-uninitialized>")
endif()
# GCC collects its own garbage from 128 MB on: from 400 MB on it takes an eighth less of the time (unity_job_1 8.9 -> 7.9
# CPU s) and a fifth more memory, 570 MB.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(gazetrace_flags INTERFACE --param=ggc-min-heapsize=400000)
endif()
if(GAZETRACE_WERROR)
  target_compile_options(gazetrace_flags INTERFACE -Werror)
endif()
if(GAZETRACE_MARCH)
  target_compile_options(gazetrace_flags INTERFACE -march=${GAZETRACE_MARCH})
endif()
if(GAZETRACE_SANITIZE)
  target_compile_options(gazetrace_flags INTERFACE
    -fsanitize=${GAZETRACE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(gazetrace_flags INTERFACE -fsanitize=${GAZETRACE_SANITIZE})
  # The checks of every pointer that is followed cost a fifth of the compiler's time, and the address sanitizer stops at
  # null pointers and at objects that are too small by itself.
  if(GAZETRACE_SANITIZE MATCHES "undefined")
    target_compile_options(gazetrace_flags INTERFACE -fno-sanitize=null,vptr,alignment,object-size)
  endif()
endif()
# A program loads the libraries that it calls, and no others.
target_link_options(gazetrace_flags INTERFACE LINKER:--as-needed)
