// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gazetrace {

// From now on large blocks that were freed stay with the program. Otherwise each image of a frame comes from the system
// page by page, cleared, and goes back to it: at 4K that was a good part of the time of accumulation
// (tests/benchmarks/book/sequences.md). For commands that make frame after frame: what they load later leaves its freed
// blocks with the program too, until somebody gives them back. Does nothing where the C library is not glibc.
void keep_freed_memory();

}  // namespace gazetrace
