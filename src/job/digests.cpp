// SPDX-License-Identifier: Apache-2.0
// The digests that tell whether a finished frame is still the one that is wanted.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "gazetrace/input_digest.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/version.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

std::string ocio_file(const JobSettings& job) {
  if (!job.color.config.empty()) {
    return job.color.config;
  }
  const char* variable = std::getenv("OCIO");
  return variable == nullptr ? std::string() : variable;
}

std::vector<std::string> existing(const std::vector<std::string>& paths) {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const std::string& path : paths) {
    if (!path.empty() && fs::is_regular_file(path, ignored)) {
      found.push_back(path);
    }
  }
  return found;
}

// What no option says: a program sets it.
void add_density_of_program(const JobSettings& job, std::vector<std::pair<std::string, std::string>>& parts) {
  const auto* density = std::get_if<DensitySampling>(&job.foveation.sampling);
  const DensitySampling usual;
  if (density == nullptr) {
    return;
  }
  if (density->full_rate_spp != usual.full_rate_spp || density->least_density != usual.least_density) {
    parts.emplace_back("rates of the density", fmt::format("{} {}", density->full_rate_spp, density->least_density));
  }
  std::string points;
  for (const Vec2d& point : density->curve.path.empty() ? density->curve.points : std::vector<Vec2d>()) {
    points += fmt::format("{} {}\n", point.x, point.y);
  }
  if (!points.empty()) {
    parts.emplace_back("curve of the density", points);
  }
}

std::string curve_file(const JobSettings& job) {
  const auto* density = std::get_if<DensitySampling>(&job.foveation.sampling);
  return density == nullptr ? std::string() : density->curve.path;
}

}  // namespace

std::vector<std::string> job_files(const JobSettings& job) {
  const fs::path camera_path(job.camera_path);
  // COLMAP keeps the lenses in a file beside that of its pictures.
  const fs::path lenses = camera_path.filename() == "images.txt" ? camera_path.parent_path() / "cameras.txt" : "";
  std::vector<std::string> files = existing({job.environment, job.camera_path, lenses.string(), job.gaze.path,
                                             job.screen.name, job.recording_screen, ocio_file(job), curve_file(job)});
  if (!job.scene.empty()) {
    const std::vector<std::string> scene = scene_files(job.scene, job.allow_outside);
    files.insert(files.end(), scene.begin(), scene.end());
  }
  const std::vector<std::string> densities = density_picture_files(job.foveation);
  files.insert(files.end(), densities.begin(), densities.end());
  return files;
}

std::map<std::string, std::string> digest_job_files(const JobSettings& job) {
  return digest_files(job_files(job), job.threads);
}

std::string digest_job(const JobSettings& job, const std::map<std::string, std::string>& files,
                       const JobSchema& schema) {
  std::vector<std::pair<std::string, std::string>> parts{{"version", kVersion}};
  const auto digest_of = [&](const std::string& path) {
    const auto found = files.find(path);
    return found == files.end() ? std::string("missing") : found->second;
  };
  for (const OptionOf<JobSettings>& option : schema.options()) {
    const std::vector<std::string> values = option.values(job);
    const std::string text = values.empty() ? std::string() : fmt::format("{}", fmt::join(values, "\n"));
    if (option.decides == Decides::file && files.contains(text)) {
      parts.emplace_back(option.name, digest_of(text));
    } else if (option.decides != Decides::nothing) {
      parts.emplace_back(option.name, text);
    }
  }
  for (const std::string& path :
       job.scene.empty() ? std::vector<std::string>() : scene_files(job.scene, job.allow_outside)) {
    parts.emplace_back("scene file", digest_of(path));
  }
  // Of a sequence all files count, whatever frames are wanted: the parts of a run have one digest.
  for (const std::string& path : density_picture_files(job.foveation)) {
    parts.emplace_back("density map " + fs::path(path).filename().string(), digest_of(path));
  }
  add_density_of_program(job, parts);
  parts.emplace_back("ocio file", existing({ocio_file(job)}).empty() ? ocio_file(job) : digest_of(ocio_file(job)));
  return digest_settings(parts);
}

}  // namespace gazetrace
