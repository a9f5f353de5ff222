// SPDX-License-Identifier: Apache-2.0
// For test programs that read damaged pictures; to be included in one source file of each.
#pragma once

#ifdef __SANITIZE_ADDRESS__
// OpenImageIO 2.4 loses the text of its own message when a PNG ends early.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libOpenImageIO";
}
#endif
