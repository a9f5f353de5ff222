# SPDX-License-Identifier: Apache-2.0
# GAZETRACE_DISPATCH: whether inner loops are compiled for several instruction sets and chosen from when the program
# starts. In portable builds, where compiler and C library know how (gcc and glibc on x86-64). Never with sanitizers:
# the choice is made before they are ready.
include(CheckCXXSourceCompiles)
set(GAZETRACE_DISPATCH OFF)
if(NOT GAZETRACE_MARCH AND NOT GAZETRACE_SANITIZE)
  check_cxx_source_compiles([=[
    template <int kStep>
    struct Loop {
      [[gnu::target_clones("default", "arch=x86-64-v3")]] static int run(int i);
    };
    template <int kStep>
    int Loop<kStep>::run(int i) {
      return i + kStep;
    }
    int main(int argc, char**) { return Loop<1>::run(argc) + Loop<2>::run(argc); }
    ]=] GAZETRACE_HAS_TARGET_CLONES)
  set(GAZETRACE_DISPATCH ${GAZETRACE_HAS_TARGET_CLONES})
endif()
