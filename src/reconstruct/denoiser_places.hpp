// SPDX-License-Identifier: Apache-2.0
// Where Open Image Denoise may lie on this machine.
#pragma once

#include <string>
#include <vector>

namespace gazetrace {

inline constexpr const char* kDenoiserFile = "libOpenImageDenoise.so.2";

// In the order in which they are tried: its name alone, by which the system's loader finds it, and then files that
// exist: beside the program, in the virtual environment that cmake/denoiser.sh makes in a build folder, beside the
// Python package, in the `pyoidn` of the Pythons of PATH, of /usr/local and of the user, and Blender's.
std::vector<std::string> places_of_denoiser();

}  // namespace gazetrace
