// SPDX-License-Identifier: Apache-2.0
#include "foveation_gain/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/parallel.hpp"
#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/metrics.hpp"
#include "support/sampling_models.hpp"

namespace gazetrace::gain {
namespace {

// As the program's own frames have it: an arm is what `gazetrace render` makes with its seed.
constexpr std::int32_t kFirstFrame = 1;
constexpr double kNoDifferenceJod = 10;

ColorSettings plain_view() {
  ColorSettings settings;
  settings.view = "sRGB";
  return settings;
}

// The display is one of the frame's own pixels: only its size by its distance matters.
FovVideoVdpSettings vdp_settings(const PlanarView& view) {
  FovVideoVdpSettings settings;
  settings.geometry = {view.width_px, view.height_px, view.step_x * view.width_px, view.step_y * view.height_px, 1};
  return settings;
}

ImageRgb mean_of(const std::vector<std::string>& files, std::size_t begin, std::size_t end, const PlanarView& view) {
  ImageRgb sum(view.width_px, view.height_px);
  std::vector<Vec3d> exact(sum.pixels.size());
  for (std::size_t f = begin; f < end; ++f) {
    const ImageRgb part = read_compared_picture(files[f]).picture.light;
    if (part.width_px != view.width_px || part.height_px != view.height_px) {
      throw Error(ErrorKind::input, files[f], "is not of the frame's size, or not of linear light",
                  "give OpenEXR files and their --size");
    }
    for (std::size_t i = 0; i < exact.size(); ++i) {
      exact[i] += to_double(part.pixels[i]);
    }
  }
  for (std::size_t i = 0; i < exact.size(); ++i) {
    sum.pixels[i] = to_float(exact[i] / static_cast<double>(end - begin));
  }
  return sum;
}

ImageRgb mean_of(const ImageRgb& a, const ImageRgb& b) {
  ImageRgb out = a;
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    out.pixels[i] = (a.pixels[i] + b.pixels[i]) * 0.5F;
  }
  return out;
}

}  // namespace

double Traced::spp() const {
  double samples = 0;
  double pixels = 0;
  for (const Shot& shot : frames) {
    samples += static_cast<double>(shot.sparse.stats.samples);
    pixels += static_cast<double>(shot.map.width_px) * shot.map.height_px;
  }
  return samples / pixels;
}

Renderer::Renderer(PathTracer& tracer, const Camera& camera, const benchmark::FrameSize& size, int clip_frames)
    : tracer_(tracer),
      camera_(camera),
      view_(view_of_display(display_by_name("paper"), {}, size.width_px, size.height_px)),
      clip_frames_(clip_frames) {}

Traced Renderer::trace(const FoveationSettings& settings, const std::optional<Gaze>& gaze, int seed,
                       bool surfaces) const {
  std::optional<Vec3d> direction;
  if (gaze) {
    direction = view_.direction(gaze->at.x * view_.width_px, gaze->at.y * view_.height_px);
  }
  MapContext context;
  context.seed = static_cast<std::uint64_t>(seed);
  TraceSettings trace;
  trace.seed = context.seed;
  trace.surfaces = surfaces;
  Traced traced;
  for (std::int32_t frame = kFirstFrame; frame < kFirstFrame + clip_frames_; ++frame) {
    context.frame = frame;
    Shot shot;
    const Stopwatch plan;
    shot.map = make_sampling_map(settings, view_, direction, context);
    traced.plan_ms += plan.elapsed_ms() / clip_frames_;
    const Stopwatch rays;
    shot.sparse = tracer_.at_rest().trace(camera_, frame, shot.map, trace);
    traced.trace_ms += rays.elapsed_ms() / clip_frames_;
    traced.frames.push_back(std::move(shot));
  }
  return traced;
}

Picture Renderer::filtered(const Traced& traced, const std::string& filter) {
  const Reconstruction reconstruction({filter});
  const std::optional<GuideSettings> wanted = reconstruction.guide_settings({});
  if (wanted && !guides_) {
    const Stopwatch watch;
    guides_ = tracer_.at_rest().guides(camera_, view_.width_px, view_.height_px, *wanted);
    guides_ms_ = watch.elapsed_ms();
  }
  Picture picture;
  picture.guides_ms = wanted ? guides_ms_ : 0;
  const double share = 1.0 / static_cast<double>(traced.frames.size());
  picture.light = ImageRgb(view_.width_px, view_.height_px);
  for (const auto& [map, sparse] : traced.frames) {
    const Stopwatch watch;
    const Frame frame = reconstruction.frame(sparse, map, wanted ? &*guides_ : nullptr);
    picture.reconstruct_ms += watch.elapsed_ms() / clip_frames_;
    for (std::size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
      picture.light.pixels[i] += static_cast<float>(share) * frame.radiance.pixels[i];
    }
  }
  return picture;
}

FoveationSettings model_settings(const std::string& model, double spp) {
  FoveationSettings settings = model_relative_to_fovea(model);
  settings.spp = spp;
  return settings;
}

FoveationSettings uniform_settings(double spp) {
  FoveationSettings settings;
  settings.sampling = UniformSampling{};
  settings.spp = spp;
  return settings;
}

FoveationSettings blocks_settings(double spp) {
  FoveationSettings settings;
  settings.sampling = a_curve({{0, 0.5}, {180, 0.5}});  // where the density is 1, a block is a pixel
  settings.spp = spp;
  return settings;
}

FoveationSettings paper_settings() {
  return {};
}

ImageRgb enlarged(const ImageRgb& image, int width_px, int height_px) {
  ImageRgb out(width_px, height_px);
  const auto place = [](int i, int from, int to) {  // the left one of two pixels, and the right one's weight
    const double x = std::clamp((i + 0.5) * from / to - 0.5, 0.0, from - 1.0);
    const int left = std::min(static_cast<int>(x), std::max(from - 2, 0));
    return std::pair{left, static_cast<float>(x - left)};
  };
  parallel_for(static_cast<std::size_t>(height_px), 0, [&](std::size_t row) {
    const auto [top, down] = place(static_cast<int>(row), image.height_px, height_px);
    const int bottom = std::min(top + 1, image.height_px - 1);
    for (int x = 0; x < width_px; ++x) {
      const auto [left, across] = place(x, image.width_px, width_px);
      const int right = std::min(left + 1, image.width_px - 1);
      out(x, static_cast<int>(row)) = (image(left, top) * (1 - across) + image(right, top) * across) * (1 - down) +
                                      (image(left, bottom) * (1 - across) + image(right, bottom) * across) * down;
    }
  });
  return out;
}

Judge::Judge(const std::vector<std::string>& files, const PlanarView& view, std::optional<double> ev,
             const std::vector<Gaze>& gazes, const std::vector<std::string>& metrics)
    : metrics_(metrics),
      view_(view),
      color_(plain_view()),
      gazes_(gazes),
      vdp_(vdp_settings(view), view.width_px, view.height_px) {
  if (files.size() < 2 || files.size() % 2 != 0) {
    throw Error(ErrorKind::usage, "--reference", "an even number of files is needed", "give at least 4 scramblings");
  }
  halves_[0] = mean_of(files, 0, files.size() / 2, view);
  halves_[1] = mean_of(files, files.size() / 2, files.size(), view);
  ImageRgb reference = mean_of(halves_[0], halves_[1]);
  ExposureSettings automatic;
  automatic.mode = ExposureMode::log_average;
  // Rounded, so that a better reference leaves it as it is.
  ev_ = ev ? *ev : std::round(10 * choose_exposure_ev(reference, automatic)) / 10;
  color_.prepare(view.width_px, view.height_px, 8);
  reference_ = shown(std::move(reference));
  reference_luminance_ = display_luminance(reference_.code, {});
  for (const Gaze& gaze : gazes_) {
    bands_.push_back(eccentricity_bands(view, {gaze.at.x * view.width_px, gaze.at.y * view.height_px}, {}, 0));
  }
}

MetricPicture Judge::shown(ImageRgb light) const {
  MetricPicture picture;
  picture.code = viewed(light, color_, ev_);
  picture.light = std::move(light);
  return picture;
}

bool Judge::wants(Metric metric) const {
  return std::find(metrics_.begin(), metrics_.end(), kMetricNames.at(static_cast<std::size_t>(metric))) !=
         metrics_.end();
}

double Judge::pixels_per_degree() const {
  return kRadPerDeg / view_.step_x;
}

ScoreMaps Judge::maps_of(const MetricPicture& reference, const ImageRgb& light) const {
  MetricSettings settings;
  settings.pixels_per_degree = pixels_per_degree();
  settings.relmse_epsilon *= std::exp2(-2 * ev_);  // of light at the exposure
  const MetricPicture test = shown(light);
  ScoreMaps maps;
  if (wants(Metric::relmse)) {
    maps.relmse = measure("relmse", reference, test, settings).values;
  }
  if (wants(Metric::flip)) {
    maps.flip = measure("flip", reference, test, settings).values;
  }
  if (wants(Metric::jod)) {
    maps.luminance_cd_m2 = display_luminance(test.code, {});
  }
  return maps;
}

ScoreMaps Judge::maps_of(const ImageRgb& light) const {
  return maps_of(reference_, light);
}

void Judge::score(const ScoreMaps& maps, const ImageGray& reference_cd_m2, std::size_t gaze, Row& row) {
  const Vec2d at = gazes_[gaze].at;
  row.gaze = gazes_[gaze].name;
  row.u = at.x;
  row.v = at.y;
  const auto binned = [&](const ImageGray& map) {
    const BandSums sums = sum_by_band(bands_[gaze], map, 0, 0);
    ByColumn means = kNothing;
    double sum = 0;
    double pixels = 0;
    for (std::size_t b = 0; b < sums.bands.size(); ++b) {
      const BandSum& band = sums.bands.at(b);
      const double share = band.pixels / static_cast<double>(map.pixels.size());
      row.share.at(1 + b) = share;
      means.at(1 + b) = band.pixels > 0 ? band.sum / band.pixels : means.at(1 + b);
      sum += band.sum;
      pixels += band.pixels;
    }
    row.share[0] = 1;
    means[0] = sum / pixels;
    return means;
  };
  if (!maps.relmse.empty()) {
    row.score.at(static_cast<std::size_t>(Metric::relmse)) = binned(maps.relmse);
  }
  if (!maps.flip.empty()) {
    row.score.at(static_cast<std::size_t>(Metric::flip)) = binned(maps.flip);
  }
  if (!maps.luminance_cd_m2.empty()) {
    const FovVideoVdpFrame frame =
        vdp_.add(reference_cd_m2, maps.luminance_cd_m2, Vec2d{at.x * view_.width_px, at.y * view_.height_px}, true);
    ByColumn jod = binned(frame.map);
    for (double& value : jod) {
      value = kNoDifferenceJod - value;
    }
    jod[0] = fovvideovdp_jod(frame.q);
    row.score.at(static_cast<std::size_t>(Metric::jod)) = jod;
  }
}

std::vector<Row> Judge::floor() {
  const MetricPicture first = shown(halves_[0]);
  const ImageGray first_luminance = display_luminance(first.code, {});
  const ScoreMaps halves = maps_of(first, halves_[1]);
  ScoreMaps own = maps_of(halves_[0]);
  own.flip = {};
  own.luminance_cd_m2 = {};
  std::vector<Row> rows;
  for (std::size_t g = 0; g < gazes_.size(); ++g) {
    Row row;
    row.kind = "floor";
    row.arm = "halves";
    row.filter = "none";
    score(halves, first_luminance, g, row);
    rows.push_back(row);
    if (wants(Metric::relmse)) {
      row.arm = "own";
      row.score = {kNothing, kNothing, kNothing};
      score(own, reference_luminance_, g, row);
      rows.push_back(row);
    }
  }
  return rows;
}

double Judge::mean_ratio(const ImageRgb& light) const {
  const auto total = [](const ImageRgb& image) {
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0, [](double sum, const Vec3f& c) {
      return sum + static_cast<double>(c.x) + static_cast<double>(c.y) + static_cast<double>(c.z);
    });
  };
  return total(light) / total(reference_.light);
}

}  // namespace gazetrace::gain
