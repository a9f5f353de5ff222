// SPDX-License-Identifier: Apache-2.0
// The mean of pictures of one frame that were rendered with different seeds.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/output.hpp"

namespace gazetrace {

// What is behind a picture: of each seed the mean number of samples a pixel; 0 where the header does not say.
using SeedSamples = std::map<std::string, double>;

struct MeanStamp {
  std::int32_t frame = 0;
  std::string mean_digest;
  SeedSamples seeds;
  bool is_mean = false;
};
// Error(input) for files that are no pictures of this program, and for those that do not state what a mean needs.
MeanStamp read_mean_stamp(const std::string& path);
// Error(input) unless both are of one frame of one job, and share no seed.
void check_mean(const MeanStamp& first, const std::string& first_path, const MeanStamp& other,
                const std::string& other_path);

struct WrittenMean {
  std::string settings_digest;
  WrittenFile file;
};
// The mean of pictures for which check_mean() finds nothing, weighted by the samples of each pixel, as an EXR of 32-bit
// floats. Its header is that of the first, and states the seeds and the samples of each. Light, albedo and normals are
// means, numbers of samples add up, the variance is that of the mean; depth, positions, motion, eccentricity and
// Cryptomatte are those of the first. Error(input) for pictures of different sizes or layers, and for pixels whose
// number of samples is not stated.
WrittenMean write_mean_exr(const std::vector<std::string>& inputs, const std::string& path);

}  // namespace gazetrace
