// SPDX-License-Identifier: Apache-2.0
// Sums of samples in a sealed file.
#include "pipeline/sample_sums_file.hpp"

#include <string>

#include "gazetrace/sample_parts.hpp"
#include "pipeline/sealed_file.hpp"

namespace gazetrace {
namespace {

constexpr SealedKind kSums{"gazetrace samples 1", "file of samples", "give the folder that `sample-range` wrote into",
                           "render this part again", "render this part again with the others' settings"};

}  // namespace

WrittenFile save_samples(const std::string& path, const SampleSums& sums, const std::string& settings_digest) {
  SealedWriter writer(kSums, settings_digest);
  writer(sums.sites);
  writer(sums.guides);
  return writer.save(path);
}

SampleSums load_samples(const std::string& path, const std::string& settings_digest) {
  SealedReader reader(kSums, path, settings_digest);
  SampleSums sums;
  reader(sums.sites);
  reader(sums.guides);
  reader.finish();
  if (!sums.guides.empty() && sums.guides.size() != sums.sites.size()) {
    reader.fail();
  }
  return sums;
}

std::string read_samples_digest(const std::string& path) {
  return read_sealed_digest(kSums, path);
}

}  // namespace gazetrace
