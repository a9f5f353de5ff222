// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace gazetrace {

// How much a Draco stream says that it holds. The decoder makes room for these counts before it has read anything
// behind them, so that thirty bytes can ask for gigabytes.
struct DracoClaims {
  std::uint64_t faces = 0, vertices = 0;
};

// By the beginning of the stream alone, "Draco 3D Graphics Compression Bitstream Specification" version 2.2, sections
// Header, Metadata, Sequential Connectivity and EdgeBreaker Connectivity; of the versions before 2.2, as the library
// reads them. Nothing where it is cut short or no mesh.
std::optional<DracoClaims> draco_claims(std::span<const std::uint8_t> bytes);

}  // namespace gazetrace
