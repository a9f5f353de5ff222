// SPDX-License-Identifier: Apache-2.0
// Display pictures as data URIs within a limit of bytes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gazetrace/report.hpp"

namespace gazetrace {

struct EmbeddedPicture {
  std::string data_uri;
  int width_px = 0, height_px = 0;  // size of the file before it was reduced
};

struct EmbeddedPictures {
  std::map<std::string, EmbeddedPicture> of_path;
  int frame_step = 1;     // every frame_step-th frame is there
  std::string statement;  // how they were reduced, in a sentence
  Warnings warnings;
};

// `paths_of_frames` holds, for each frame in the order of time, the files that show it. All of them are embedded as PNG
// if they fit; else as JPEG, then averaged over blocks of pixels in linear light, then with fewer frames.
EmbeddedPictures embed_pictures(const std::vector<std::vector<std::string>>& paths_of_frames, double max_bytes,
                                int threads);

}  // namespace gazetrace
