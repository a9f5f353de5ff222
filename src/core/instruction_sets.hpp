// SPDX-License-Identifier: Apache-2.0
// GAZETRACE_CLONES before a function of the inner loops: in a portable build the compiler makes it twice, for every CPU
// of the architecture and for those with AVX2 and its companions, and the program takes the better one when it starts.
// Both give the same bits: no multiply-add is fused. Builds for one instruction set (GAZETRACE_MARCH) have nothing to
// choose.
#pragma once

#if defined(GAZETRACE_DISPATCH)
#define GAZETRACE_CLONES [[gnu::target_clones("default", "arch=x86-64-v3")]]
#else
#define GAZETRACE_CLONES
#endif
