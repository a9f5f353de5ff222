// SPDX-License-Identifier: Apache-2.0
#include "sweep/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <thread>

#include "core/file_lock.hpp"
#include "core/parallel.hpp"
#include "sweep/measure.hpp"
#include "sweep/scorer.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 2> kHalves{"half-1.####.exr", "half-2.####.exr"};
constexpr const char* kMean = "reference.####.exr";

std::string scrambling_folder(const std::string& directory, std::size_t scrambling) {
  return directory + fmt::format("/scrambling-{}", scrambling + 1);
}

std::string scrambling_digest(const SweepReference& reference, std::size_t scrambling) {
  return digest_settings({{"reference", reference.digest}, {"seed", std::to_string(reference.seeds[scrambling])}});
}

std::string scrambling_pattern(const std::string& directory, std::size_t scrambling) {
  return scrambling_folder(directory, scrambling) + "/frame.####.exr";
}

// `is_part`: these are some of the pictures, and other processes render the others.
void render_scrambling(PathTracer& tracer, const SweepReference& reference, const std::vector<std::int32_t>& pictures,
                       const ColorPipeline& color, const std::string& directory, std::size_t scrambling, bool is_part,
                       const SweepObserver& observer) {
  PipelineSettings settings = reference.pipeline;
  settings.is_part = is_part;
  settings.trace.seed = reference.seeds[scrambling];
  settings.output = {};
  settings.output.exr.pattern = scrambling_pattern(directory, scrambling);
  settings.output.run_name = run_name_of(settings.output.exr.pattern);
  settings.output.exr.pixels = ExrPixels::float32;
  settings.output.resume = true;
  settings.settings_digest = scrambling_digest(reference, scrambling);
  fs::create_directories(scrambling_folder(directory, scrambling));
  render_or_stop(tracer, only_frames(reference.plan, pictures), color, settings, {}, observer);
}

WrittenFile write_mean(const std::string& path, const Frame& frame, const FrameRequest& request,
                       const SweepReference& reference) {
  FrameHeader header;
  header.frame = request.frame;
  header.t_video_ns = request.t_video_ns;
  header.fps = reference.pipeline.fps;
  header.camera = request.camera;
  header.settings_digest = reference.digest;
  ExrSettings settings;
  settings.pixels = ExrPixels::float32;
  return write_frame_exr(path, frame, nullptr, header, settings, reference.pipeline.threads).file;
}

// The mean of some scramblings of a frame, summed in double precision.
ImageRgb mean_of(const std::string& directory, std::size_t first, std::size_t count, std::int32_t frame, int threads) {
  Image<Vec3d> sum;
  for (std::size_t k = first; k < first + count; ++k) {
    const ImageRgb one = read_exr_rgb(frame_file_name(scrambling_pattern(directory, k), frame));
    if (sum.empty()) {
      sum = Image<Vec3d>(one.width_px, one.height_px);
    }
    parallel_for(static_cast<std::size_t>(one.height_px), threads, [&](std::size_t row) {
      const std::size_t begin = row * static_cast<std::size_t>(one.width_px);
      for (std::size_t i = begin; i < begin + static_cast<std::size_t>(one.width_px); ++i) {
        sum.pixels[i] = sum.pixels[i] + to_double(one.pixels[i]);
      }
    });
  }
  ImageRgb mean(sum.width_px, sum.height_px);
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] = to_float(sum.pixels[i] / static_cast<double>(count));
  }
  return mean;
}

ImageRgb mean_of_two(const ImageRgb& a, const ImageRgb& b) {
  ImageRgb mean(a.width_px, a.height_px);
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] = (a.pixels[i] + b.pixels[i]) * 0.5F;
  }
  return mean;
}

// The record of a frame says that its pictures are there, and its exposure.
std::string record_path(const CertifiedReference& certified, std::int32_t frame) {
  return frame_file_name(certified.directory + "/frame.####.json", frame);
}

// The exposures of frames that are finished.
std::map<std::int32_t, double> finished_frames(const CertifiedReference& certified, const SweepReference& reference) {
  std::map<std::int32_t, double> ev;
  for (const FrameRequest& request : reference.plan.frames) {
    if (const auto kept = load_exposure(record_path(certified, request.frame), reference.digest)) {
      ev[request.frame] = *kept;
    }
  }
  return ev;
}

// A frame between two pictures shows the earlier one. What is finished already stays.
void average_frames(const SweepReference& reference, const std::vector<std::int32_t>& pictures,
                    const ColorPipeline& color, const std::string& sweep_directory, CertifiedReference& certified) {
  const std::size_t half = reference.seeds.size() / 2;
  const int threads = reference.pipeline.threads;
  std::array<ImageRgb, 2> halves;
  certified.ev = finished_frames(certified, reference);
  for (const FrameRequest& request : reference.plan.frames) {
    const std::int32_t frame = request.frame;
    const bool is_finished = certified.ev.contains(frame);
    const bool is_new = std::find(pictures.begin(), pictures.end(), frame) != pictures.end();
    WrittenFiles files;
    const auto name_of = [&](const std::string& path) { return path.substr(sweep_directory.size() + 1); };
    for (std::size_t h = 0; h < halves.size(); ++h) {
      if (is_new) {
        halves[h] = mean_of(certified.directory, h * half, half, frame, threads);
      }
      if (!is_finished) {
        Frame picture;
        picture.radiance = halves[h];
        const std::string path = certified.half_path(static_cast<int>(h), frame);
        files[name_of(path)] = write_mean(path, picture, request, reference);
      }
    }
    if (is_finished) {
      continue;
    }
    Frame mean;
    mean.radiance = mean_of_two(halves[0], halves[1]);
    const double ev = choose_exposure_ev(mean.radiance, reference.pipeline.exposure);
    certified.ev[frame] = ev;
    FrameHeader header;
    header.frame = frame;
    header.exposure_ev = ev;
    const std::string shown = frame_file_name(certified.directory + "/reference.####.png", frame);
    files[name_of(shown)] = write_display_image(shown, color.apply(mean.radiance, ev, 8, threads), header, {});
    const std::string path = certified.mean_path(frame);
    files[name_of(path)] = write_mean(path, mean, request, reference);
    save_exposure(record_path(certified, frame), reference.digest, ev, files);
  }
}

// Of the pictures of a reference, those that frames still lack.
std::vector<std::int32_t> missing_pictures(const CertifiedReference& certified, const SweepReference& reference,
                                           const std::vector<std::int32_t>& pictures) {
  if (pictures.size() != reference.plan.frames.size()) {
    return pictures;
  }
  const std::map<std::int32_t, double> finished = finished_frames(certified, reference);
  std::vector<std::int32_t> missing = pictures;
  std::erase_if(missing, [&](std::int32_t frame) { return finished.contains(frame); });
  return missing;
}

CertifiedReference described(const SweepReference& reference, const std::string& sweep_directory) {
  CertifiedReference certified;
  certified.directory = sweep_directory + "/" + reference_folder(reference);
  certified.spp = reference.pipeline.foveation.spp.value_or(kUsualSpp) * static_cast<double>(reference.seeds.size());
  return certified;
}

void tell(const SweepObserver& observer, const std::string& line) {
  if (observer.tell) {
    observer.tell(line);
  }
}

// Of all scramblings, which are not needed after that.
void certify(const SweepReference& reference, const std::vector<std::int32_t>& pictures, const ColorPipeline& color,
             const std::string& sweep_directory, CertifiedReference& certified) {
  average_frames(reference, pictures, color, sweep_directory, certified);
  for (std::size_t k = 0; k < reference.seeds.size(); ++k) {
    fs::remove_all(scrambling_folder(certified.directory, k));
  }
}

struct ReferenceTask {
  PathTracer& tracer;
  const SweepReference& reference;
  const std::vector<std::int32_t>& pictures;
  const ColorPipeline& color;
  const std::string& sweep_directory;
  const SweepObserver& observer;
};

// What one process renders at a time: a picture of a scrambling.
struct ScramblingPart {
  std::size_t scrambling = 0;
  std::vector<std::int32_t> pictures;
};
std::vector<ScramblingPart> parts_of(const ReferenceTask& task) {
  std::vector<ScramblingPart> parts;
  for (std::size_t k = 0; k < task.reference.seeds.size(); ++k) {
    for (const std::int32_t picture : task.pictures) {
      parts.push_back({k, {picture}});
    }
  }
  return parts;
}

// Waits until nobody else holds the lock, or the sweep is asked to stop.
FileLock wait_for(const std::string& path, const SweepObserver& observer) {
  for (;;) {
    FileLock lock(path, FileLock::Kind::alone, false);
    if (lock.is_held()) {
      return lock;
    }
    stop_if_asked(observer);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

// First what nobody is at; then, part by part, what others were at, which they have finished or have left. Who finds
// the reference finished has nothing more to do: its scramblings are removed by then.
CertifiedReference render_with_others(const ReferenceTask& task) {
  CertifiedReference certified = described(task.reference, task.sweep_directory);
  const std::string locks = certified.directory + "/locks";
  fs::create_directories(locks);
  for (const bool waits : {false, true}) {
    for (const ScramblingPart& part : parts_of(task)) {
      const std::string path = fmt::format("{}/{}-{}", locks, part.scrambling + 1, part.pictures.front());
      const FileLock lock = waits ? wait_for(path, task.observer) : FileLock(path, FileLock::Kind::alone, false);
      if (!lock.is_held()) {
        continue;
      }
      if (const auto finished = finished_reference(task.reference, task.sweep_directory)) {
        return *finished;
      }
      tell(task.observer, fmt::format("reference {}: scrambling {} of {}, frame {}", task.reference.key,
                                      part.scrambling + 1, task.reference.seeds.size(), part.pictures.front()));
      render_scrambling(task.tracer, task.reference, part.pictures, task.color, certified.directory, part.scrambling,
                        true, task.observer);
    }
  }
  const FileLock lock = wait_for(locks + "/mean", task.observer);
  if (const auto finished = finished_reference(task.reference, task.sweep_directory)) {
    return *finished;
  }
  certify(task.reference, task.pictures, task.color, task.sweep_directory, certified);
  return certified;
}

}  // namespace

std::string CertifiedReference::half_path(int half, std::int32_t frame) const {
  return frame_file_name(directory + "/" + kHalves.at(static_cast<std::size_t>(half)), frame);
}

std::string CertifiedReference::mean_path(std::int32_t frame) const {
  return frame_file_name(directory + "/" + kMean, frame);
}

bool scene_decides_pictures(const SweepReference& reference) {
  const std::vector<FrameRequest>& frames = reference.plan.frames;
  const auto is_like_first = [&](const FrameRequest& request) {
    const Camera& a = frames.front().camera;
    const Camera& b = request.camera;
    return a.pose == b.pose && a.projection == b.projection && a.lens == b.lens && b.shutter_poses.empty();
  };
  return frames.size() > 1 && reference.pipeline.accumulate.mode == AccumulateMode::off &&
         std::all_of(frames.begin(), frames.end(), is_like_first);
}

std::vector<std::int32_t> reference_pictures(const SweepReference& reference, const Scene& scene) {
  if (scene_decides_pictures(reference) && scene.motions.empty() && scene.deformations.empty()) {
    return {reference.plan.frames.front().frame};
  }
  std::vector<std::int32_t> all;
  for (const FrameRequest& request : reference.plan.frames) {
    all.push_back(request.frame);
  }
  return all;
}

FramePlan only_frames(const FramePlan& plan, const std::vector<std::int32_t>& frames) {
  FramePlan part = plan;
  std::erase_if(part.frames, [&](const FrameRequest& request) {
    return std::find(frames.begin(), frames.end(), request.frame) == frames.end();
  });
  return part;
}

std::string reference_folder(const SweepReference& reference) {
  return "references/" + reference.key;
}

MetricPicture metric_picture(ImageRgb light, const ColorPipeline& color, double ev, int threads) {
  MetricPicture picture;
  picture.code = viewed(light, color, ev, threads);
  picture.light = std::move(light);
  return picture;
}

std::optional<CertifiedReference> finished_reference(const SweepReference& reference,
                                                     const std::string& sweep_directory) {
  CertifiedReference certified = described(reference, sweep_directory);
  certified.ev = finished_frames(certified, reference);
  return certified.ev.size() == reference.plan.frames.size() ? std::optional(certified) : std::nullopt;
}

CertifiedReference ensure_reference(PathTracer& tracer, const Scene& scene, const SweepReference& reference,
                                    const ColorPipeline& color, const std::string& sweep_directory, bool with_others,
                                    const SweepObserver& observer) {
  const std::vector<std::int32_t> pictures = reference_pictures(reference, scene);
  std::optional<CertifiedReference> certified = finished_reference(reference, sweep_directory);
  if (!certified) {
    certified = described(reference, sweep_directory);
    const std::vector<std::int32_t> missing = missing_pictures(*certified, reference, pictures);
    if (with_others) {
      const ReferenceTask task{tracer, reference, missing, color, sweep_directory, observer};
      certified = render_with_others(task);
    } else {
      for (std::size_t k = 0; k < reference.seeds.size(); ++k) {
        tell(observer, fmt::format("reference {}: scrambling {} of {}", reference.key, k + 1, reference.seeds.size()));
        render_scrambling(tracer, reference, missing, color, certified->directory, k, false, observer);
      }
      certify(reference, missing, color, sweep_directory, *certified);
    }
  }
  certified->pictures = pictures.size();
  return *certified;
}

ScoreTable ensure_floor(const CertifiedReference& reference, const ColorPipeline& color,
                        const ComparisonSettings& settings, const std::vector<ResultFrame>& frames,
                        const std::string& digest) {
  const std::string path = reference.directory + "/floor-" + digest + ".json";
  if (auto kept = load_scores(path)) {
    return *kept;
  }
  const int threads = settings.metric.threads;
  std::unique_ptr<Scorer> scorer;
  for (const ResultFrame& frame : frames) {
    const double ev = reference.ev.at(frame.index);
    const MetricPicture a = metric_picture(read_exr_rgb(reference.half_path(0, frame.index)), color, ev, threads);
    const MetricPicture b = metric_picture(read_exr_rgb(reference.half_path(1, frame.index)), color, ev, threads);
    if (!scorer) {
      // The exposures that tests are scored at: those of the first frame of the whole reference.
      ComparisonSettings fixed = settings;
      fix_flip_exposures(fixed, read_exr_rgb(reference.mean_path(frame.index)));
      scorer = std::make_unique<Scorer>(fixed, frames, a.light.width_px, a.light.height_px);
    }
    scorer->add(a, b);
  }
  ScoreTable scores = scorer ? scorer->over_scored_frames() : ScoreTable{};
  save_scores(path, scores);
  return scores;
}

}  // namespace gazetrace
