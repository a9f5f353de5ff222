// SPDX-License-Identifier: Apache-2.0
// GAZETRACE_CLONES stands before functions of the inner loops. In a portable build the compiler makes such a function
// twice, for every CPU of the architecture and for those with AVX2 and its companions, and the program chooses when it
// starts. Both give the same bits, since no multiply-add is fused. In builds for one instruction set (GAZETRACE_MARCH)
// it is empty.
#pragma once

#if defined(GAZETRACE_DISPATCH)
#define GAZETRACE_CLONES [[gnu::target_clones("default", "arch=x86-64-v3")]]
#else
#define GAZETRACE_CLONES
#endif
