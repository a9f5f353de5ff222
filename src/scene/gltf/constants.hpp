// SPDX-License-Identifier: Apache-2.0
// Numbers that glTF takes from OpenGL: component types of accessors and modes of primitives (glTF 2.0, sections 3.6.2.2
// and 5.24.4).
#pragma once

namespace gazetrace {

inline constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125;
// Below are points and lines; the mode of fans is 6.
inline constexpr int kTriangles = 4, kTriangleStrip = 5;

// The most that a material or a lamp may shine, see Material::emission.
inline constexpr float kMostLight = 1e30F;

}  // namespace gazetrace
