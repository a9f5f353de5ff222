// SPDX-License-Identifier: Apache-2.0
// All channels of an EXR with their headers.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <map>
#include <string>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// One part of a file; most files have one.
struct ExrLayers {
  Imf::Header header;
  std::map<std::string, ImageGray> channels;
};
// Error(input) for what is no EXR, and for one that is damaged.
std::vector<ExrLayers> read_exr_layers(const std::string& path);

}  // namespace gazetrace
