// SPDX-License-Identifier: Apache-2.0
// Pictures of tests that fail: what was rendered, what was expected and where they differ are left behind as EXR files,
// in the folder that the environment variable GAZETRACE_TEST_OUTPUT names, or in the system's folder for temporary
// files.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/output.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace::test {

// Suite.Test of the running test, with nothing in it that a file name cannot hold.
inline std::string name_of_this_test() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = test == nullptr ? "outside-of-tests" : std::string(test->test_suite_name()) + "." + test->name();
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

inline std::filesystem::path test_output_folder() {
  const char* asked = std::getenv("GAZETRACE_TEST_OUTPUT");
  std::filesystem::path folder = asked != nullptr && *asked != '\0'
                                     ? std::filesystem::path(asked)
                                     : std::filesystem::temp_directory_path() / "gazetrace-test-output";
  std::filesystem::create_directories(folder);
  return folder;
}

// Absolute differences of all channels. Pictures must be of one size.
inline ImageRgb error_map(const ImageRgb& picture, const ImageRgb& reference) {
  ImageRgb error(picture.width_px, picture.height_px);
  for (std::size_t i = 0; i < error.pixels.size(); ++i) {
    const Vec3f off = picture.pixels[i] - reference.pixels[i];
    error.pixels[i] = {std::fabs(off.x), std::fabs(off.y), std::fabs(off.z)};
  }
  return error;
}

// Writes the three files and says where they are, as the end of a failure's message. `label` tells several pictures of
// one test apart.
inline std::string keep_pictures(const ImageRgb& picture, const ImageRgb& reference, const std::string& label = "") {
  const std::string name = name_of_this_test() + (label.empty() ? "" : "-" + label);
  std::vector<std::pair<std::string, ImageRgb>> pictures{{"picture", picture}, {"reference", reference}};
  if (picture.width_px == reference.width_px && picture.height_px == reference.height_px) {
    pictures.emplace_back("error", error_map(picture, reference));
  }
  std::ostringstream text;
  for (auto& [what, image] : pictures) {
    Frame frame;
    frame.sample_count = ImageGray(image.width_px, image.height_px);
    frame.variance = ImageGray(image.width_px, image.height_px);
    frame.radiance = std::move(image);
    const std::string path = (test_output_folder() / (name + "-" + what + ".exr")).string();
    ExrSettings settings;
    settings.pattern = path;
    settings.pixels = ExrPixels::float32;
    write_frame_exr(path, frame, nullptr, {}, settings);
    text << "\n" << what << ": " << path;
  }
  return text.str();
}

// Bit by bit. For EXPECT_TRUE, which then prints how many pixels differ and where the pictures are.
inline testing::AssertionResult same_picture(const ImageRgb& picture, const ImageRgb& reference,
                                             const std::string& label = "") {
  if (picture == reference) {
    return testing::AssertionSuccess();
  }
  testing::AssertionResult failure = testing::AssertionFailure();
  if (picture.width_px != reference.width_px || picture.height_px != reference.height_px) {
    failure << "the pictures are of different sizes";
  } else {
    std::size_t different = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
      different += picture.pixels[i] == reference.pixels[i] ? 0 : 1;
    }
    failure << different << " of " << picture.pixels.size() << " pixels differ";
  }
  return failure << keep_pictures(picture, reference, label);
}

// Each site's mean over its pixels; black where it has no samples.
inline ImageRgb picture_of(const SparseFrame& sparse, const SamplingMap& map) {
  return Reconstruction({"none"}).frame(sparse, map, nullptr, 1).radiance;
}

// The sums of every site, bit by bit; the pictures that are left behind are their means.
inline testing::AssertionResult same_samples(const SparseFrame& traced, const SparseFrame& reference,
                                             const SamplingMap& map, const std::string& label = "") {
  if (traced.sum == reference.sum && traced.sum_square_luminance == reference.sum_square_luminance &&
      traced.count == reference.count) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "the sums of the sites differ"
                                     << keep_pictures(picture_of(traced, map), picture_of(reference, map), label);
}

}  // namespace gazetrace::test
