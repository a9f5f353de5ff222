// SPDX-License-Identifier: Apache-2.0
// The files of a scene, and digests of their contents.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace gazetrace {

// The scene file, then the buffers and then the images that it names and that exist, each once. Error(input) when the
// scene file is missing, and where it names files outside of its data set (SceneReadOptions::allow_outside).
std::vector<std::string> scene_files(const std::string& path, bool allow_outside = false);
// Content hash of each file. Error(input) for one that cannot be read.
std::map<std::string, std::string> digest_files(const std::vector<std::string>& paths, int threads = 0);

}  // namespace gazetrace
