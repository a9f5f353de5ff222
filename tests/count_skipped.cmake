# SPDX-License-Identifier: Apache-2.0
# Run by ctest in the build folder once all tests have ended: counts those that were skipped, and prints why.
file(GLOB logs Testing/Temporary/LastTest.log*)
list(GET logs 0 log)
file(STRINGS ${log} reasons REGEX "^skipped: |is not here")
list(LENGTH reasons count)
if(count)
  list(REMOVE_DUPLICATES reasons)
  list(JOIN reasons "\n  " reasons)
  message("Skipped tests: ${count}\n  ${reasons}")
endif()
