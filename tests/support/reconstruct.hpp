// SPDX-License-Identifier: Apache-2.0
// A filter by its name, in one call.
#pragma once

#include <string>

#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

inline Frame reconstruct(const SparseFrame& sparse, const SamplingMap& map, const std::string& filter, int threads = 0,
                         const Guides* guides = nullptr) {
  return Reconstruction({filter}).frame(sparse, map, guides, threads);
}

}  // namespace gazetrace
