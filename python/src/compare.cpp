// SPDX-License-Identifier: Apache-2.0
// The metrics, over pictures in memory or in files.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bind.hpp"
#include "frame.hpp"
#include "gazetrace/compare_job.hpp"
#include "gazetrace/job_schema.hpp"
#include "gazetrace/metric_options.hpp"
#include "gazetrace/recorded_run.hpp"
#include "options.hpp"

namespace gazetrace::python {
namespace {

py::object number_or_none(const std::optional<double>& value) {
  return value ? py::object(py::float_(*value)) : py::object(py::none());
}

py::dict scores_dict(const Scores& scores) {
  py::dict one;
  one["metric"] = scores.metric;
  one["value"] = number_or_none(scores.value);
  one["weighted"] = number_or_none(scores.weighted);
  py::dict bands;
  for (std::size_t i = 0; i < scores.bands.size(); ++i) {
    bands[py::str(eccentricity_band_name(i))] = number_or_none(scores.bands[i]);
  }
  py::dict regions;
  for (std::size_t i = 0; i < scores.regions.size(); ++i) {
    regions[kRetinalRegionNames[i]] = number_or_none(scores.regions[i]);
  }
  one["bands"] = bands;
  one["regions"] = regions;
  return one;
}

struct ComparisonInputs {
  std::vector<std::string> metrics;
  OptionTexts options;  // of metric_schema(), without the metrics
  std::optional<PlanarView> view;
  double frames_per_second = 0;
  bool want_maps = false;
  int threads = 0;
};

// What of the settings follows from other settings, as in the program's comparison.
ComparisonSettings settings_of(const ComparisonInputs& inputs) {
  MetricChoice choice;
  assign_options(choice, metric_schema(), inputs.options);
  ComparisonSettings settings = choice.settings;
  settings.metrics = inputs.metrics;
  settings.view = inputs.view;
  settings.frames_per_second = inputs.frames_per_second;
  settings.want_maps = inputs.want_maps;
  settings.metric.peak_cd_m2 = settings.photometry.peak_cd_m2;
  settings.original_border = !choice.correct_border;
  check_comparison(settings);
  complete_settings(settings, inputs.threads);
  return settings;
}

std::shared_ptr<ColorPipeline> color_pipeline(const std::string& display, const std::string& view,
                                              const OptionTexts& config) {
  ColorSettings settings;
  assign_options(settings, color_config_schema(), config);
  settings.display = display;
  settings.view = view;
  return std::make_shared<ColorPipeline>(settings);
}

// A picture of a comparison, with whatever is known about it.
struct Picture {
  MetricPicture picture;
  bool is_linear = true;
  FrameFacts facts;
};
using PicturePtr = std::shared_ptr<Picture>;

class PictureComparison {
 public:
  PictureComparison(ComparisonSettings settings, std::shared_ptr<ColorPipeline> color, bool shows_light)
      : settings_(std::move(settings)), color_(std::move(color)), shows_light_(shows_light) {}

  // Both through one view, with one exposure in stops.
  FrameScores add(std::int32_t frame, const Picture& reference, const Picture& test, double exposure_ev,
                  std::optional<Vec2d> gaze_px, GazeClass gaze_class) {
    FramePair pair{frame, complete(reference, exposure_ev), complete(test, exposure_ev), gaze_px, gaze_class};
    if (!comparison_) {
      fix_flip_exposures(settings_, pair.reference.light);
      comparison_.emplace(settings_, pair.reference.code.width_px, pair.reference.code.height_px);
    }
    return comparison_->add(pair);
  }
  [[nodiscard]] std::vector<SequenceScores> summary() const {
    return comparison_ ? comparison_->summary() : std::vector<SequenceScores>();
  }

 private:
  [[nodiscard]] MetricPicture complete(const Picture& one, double exposure_ev) const {
    MetricPicture picture = one.picture;
    const double peak = settings_.photometry.peak_cd_m2;
    const int threads = settings_.metric.threads;
    if (shows_light_) {
      picture.code = pq_codes(one.is_linear ? picture.light : picture.code, peak, threads);
      picture.light = emitted(picture.code, DisplayResponse::pq, peak, threads);
    } else if (one.is_linear) {
      picture.code = viewed(picture.light, *color_, exposure_ev, threads);
    } else {
      picture.light = emitted(picture.code, settings_.metric.response, peak, threads);
    }
    return picture;
  }

  ComparisonSettings settings_;
  std::shared_ptr<ColorPipeline> color_;
  bool shows_light_;
  std::optional<Comparison> comparison_;
};

GazeClass gaze_class_named(const std::string& name) {
  std::vector<std::string> known;
  for (const GazeClass one : kGazeClasses) {
    known.emplace_back(to_string(one));
    if (known.back() == name) {
      return one;
    }
  }
  throw Error(ErrorKind::usage, "`gaze_class`", unknown_name_message("class", name, known));
}

py::dict frame_dict(const FrameScores& scores) {
  py::dict one;
  one["frame"] = scores.frame;
  one["gaze_class"] = std::string(to_string(scores.gaze_class));
  py::list list;
  py::dict maps;
  for (std::size_t i = 0; i < scores.scores.size(); ++i) {
    list.append(scores_dict(scores.scores[i]));
    if (i < scores.maps.size() && !scores.maps[i].empty()) {
      maps[py::str(scores.scores[i].metric)] = given_away(scores.maps[i]);
    }
  }
  one["scores"] = list;
  one["maps"] = maps;
  return one;
}

py::dict sequence_dict(const SequenceScores& sequence) {
  py::dict one;
  one["gaze_class"] = sequence.gaze_class;
  one["frames"] = sequence.frames;
  py::list list;
  for (std::size_t i = 0; i < sequence.scores.size(); ++i) {
    py::dict scores = scores_dict(sequence.scores[i]);
    scores["scored_frames"] = sequence.scored_frames[i];
    scores["quantiles"] = sequence.quantiles[i];
    scores["worst_frame"] =
        sequence.worst_frame[i] ? py::object(py::int_(*sequence.worst_frame[i])) : py::object(py::none());
    list.append(scores);
  }
  one["scores"] = list;
  return one;
}

PicturePtr picture_of_array(const Floats& array, bool is_linear, const std::string& what) {
  auto picture = std::make_shared<Picture>();
  picture->is_linear = is_linear;
  (is_linear ? picture->picture.light : picture->picture.code) = rgb_of(array, what);
  return picture;
}

PicturePtr picture_of_file(const std::string& path) {
  ComparedPicture read = read_compared_picture(path);
  return std::make_shared<Picture>(Picture{std::move(read.picture), read.is_linear, std::move(read.facts)});
}

// What the run of a pattern's pictures knew beside them.
struct Run {
  RecordedRun recorded;

  [[nodiscard]] const std::optional<DisplayGeometry>& screen() const { return recorded.resolved.plan_settings.display; }
  [[nodiscard]] const FrameRect& rect() const { return recorded.resolved.plan_settings.frame_rect; }
};
using RunPtr = std::shared_ptr<Run>;

// Where the viewer of a picture looked, in pixels, and what the eye did.
py::tuple gaze_of(const Picture& picture, const RunPtr& run) {
  std::optional<GazeAtTime> gaze = picture.facts.gaze_true;
  if (!gaze) {
    return py::make_tuple(py::none(), "no-gaze");
  }
  if (!gaze->movement && run && run->recorded.settings().gaze_at) {
    gaze->movement = EyeMovement::fixation;
  }
  const GazeClass gaze_class = gaze_class_of(*gaze);
  if (gaze_class == GazeClass::no_gaze || picture.facts.gaze_is_direction) {
    return py::make_tuple(py::none(), std::string(to_string(gaze_class)));
  }
  const ImageRgb& image = picture.is_linear ? picture.picture.light : picture.picture.code;
  const Vec2d px = gaze_in_frame(*gaze, run ? run->screen() : std::nullopt, run ? run->rect() : FrameRect{},
                                 image.width_px, image.height_px);
  return py::make_tuple(py::make_tuple(px.x, px.y), std::string(to_string(gaze_class)));
}

// Empty where the pictures lie beside no record of theirs.
RunPtr recorded_run(const std::string& pattern, const std::string& digest) {
  std::optional<RecordedRun> run = find_recorded_run(pattern, digest);
  return run ? std::make_shared<Run>(Run{std::move(*run)}) : nullptr;
}

void bind_run(py::module_& module) {
  module.def("recorded_run", &recorded_run);
  py::class_<Run, RunPtr>(module, "Run")
      .def("view",
           [](const Run& run, int width_px, int height_px) {
             return run.screen() ? std::optional(view_of_display(*run.screen(), run.rect(), width_px, height_px))
                                 : std::nullopt;
           })
      .def_property_readonly("frames_per_second",
                             [](const Run& run) {
                               const FrameRate& fps = run.recorded.settings().fps;
                               return static_cast<double>(fps.numerator) / static_cast<double>(fps.denominator);
                             })
      .def("color", [](const Run& run) { return std::make_shared<ColorPipeline>(run.recorded.settings().color); })
      .def_property_readonly("regions", [](const Run& run) {
        const RegionSampling* regions = regions_of(run.recorded.settings().foveation.sampling);
        return regions != nullptr ? std::optional(regions->eccentricities_deg) : std::nullopt;
      });
}

std::optional<PlanarView> view_of_screen(const OptionTexts& screen, int width_px, int height_px) {
  ScreenSettings settings;
  assign_options(settings, screen_schema(), screen);
  const std::optional<DisplayGeometry> display = screen_geometry(settings);
  if (!display) {
    return std::nullopt;
  }
  check_display(*display);
  return view_of_display(*display, {}, width_px, height_px);
}

// Two sequences of files, as the program compares them.
py::dict compare_files(const std::string& reference, const std::string& test, const OptionTexts& options,
                       const std::vector<std::optional<std::pair<double, double>>>& gaze, bool want_maps,
                       const py::object& on_frame) {
  CompareJob job;
  job.reference = reference;
  job.test = test;
  job.want_maps = want_maps;
  assign_options(job, compare_schema(), options);
  for (const auto& at : gaze) {
    job.gaze_in_frame.push_back(at ? std::optional(Vec2d{at->first, at->second}) : std::nullopt);
  }
  py::list frames;
  ComparedSequences compared;
  {
    const py::gil_scoped_release release;
    compared = compare(job, [&](FrameScores& scores) {
      const py::gil_scoped_acquire acquire;
      frames.append(frame_dict(scores));
      if (!on_frame.is_none()) {
        on_frame(frames[frames.size() - 1]);
      }
      if (PyErr_CheckSignals() != 0) {
        throw py::error_already_set();
      }
    });
  }
  py::list summary;
  for (const SequenceScores& sequence : compared.summary) {
    summary.append(sequence_dict(sequence));
  }
  py::dict result;
  result["frames"] = frames;
  result["summary"] = summary;
  result["conditions"] = compared.conditions;
  result["over_limits"] = compared.over_limits;
  return result;
}

}  // namespace

void bind_compare(py::module_& module) {
  module.def("metrics", [] {
    py::list list;
    for (const MetricInfo& info : comparison_metrics()) {
      py::dict one;
      one["name"] = info.name;
      one["input"] = info.input == MetricInput::light ? "light" : "code";
      one["better"] = info.better == MetricDirection::lower ? "lower" : "higher";
      one["needs_gaze"] = info.needs_gaze;
      one["description"] = info.description;
      list.append(one);
    }
    return list;
  });
  module.def("find_frames", &find_frames);
  module.def("has_frame_number", &has_frame_number);
  module.def("frame_file_name", [](const std::string& pattern, std::int32_t frame) {
    return has_frame_number(pattern) ? frame_file_name(pattern, frame) : pattern;
  });
  module.def("compare_files", &compare_files);
  module.def("view_of_screen", &view_of_screen);
  module.def("color_pipeline", &color_pipeline);
  bind_run(module);
  py::class_<ColorPipeline, std::shared_ptr<ColorPipeline>>(module, "ColorPipeline")
      .def("description", &ColorPipeline::description);
  py::class_<Picture, PicturePtr>(module, "Picture")
      .def(py::init(&picture_of_array), py::arg("array"), py::arg("is_linear"), py::arg("what"))
      .def_readonly("is_linear", &Picture::is_linear)
      .def_property_readonly("size",
                             [](const Picture& one) {
                               const ImageRgb& image = one.is_linear ? one.picture.light : one.picture.code;
                               return py::make_tuple(image.width_px, image.height_px);
                             })
      .def_property_readonly("exposure_ev", [](const Picture& one) { return one.facts.exposure_ev; })
      .def_property_readonly("frames_per_second", [](const Picture& one) { return one.facts.frames_per_second; })
      .def_property_readonly("settings_digest", [](const Picture& one) { return one.facts.settings_digest; })
      .def_property_readonly("pixels",
                             [](const py::object& self) {
                               const auto& one = self.cast<const Picture&>();
                               return view_of(one.is_linear ? one.picture.light : one.picture.code, self);
                             })
      .def("gaze", &gaze_of);
  module.def("read_picture", &picture_of_file, py::call_guard<py::gil_scoped_release>());

  py::class_<PictureComparison>(module, "Comparison")
      .def(
          py::init([](const std::vector<std::string>& metrics, const OptionTexts& options,
                      std::optional<PlanarView> view, double frames_per_second, bool want_maps,
                      std::optional<std::array<double, 2>> regions, std::shared_ptr<ColorPipeline> color, int threads) {
            MetricChoice raw;
            assign_options(raw, metric_schema(), options);
            ComparisonSettings settings = settings_of({metrics, options, view, frames_per_second, want_maps, threads});
            if (regions) {
              settings.regions.end_deg = *regions;
            }
            return std::make_unique<PictureComparison>(std::move(settings), std::move(color),
                                                       raw.settings.metric.response == DisplayResponse::linear_hdr);
          }),
          py::arg("metrics"), py::arg("options"), py::arg("view"), py::arg("frames_per_second"), py::arg("want_maps"),
          py::arg("regions"), py::arg("color"), py::arg("threads"))
      .def("add",
           [](PictureComparison& comparison, std::int32_t frame, const Picture& reference, const Picture& test,
              double exposure_ev, const std::optional<std::pair<double, double>>& gaze_px,
              const std::string& gaze_class) {
             FrameScores scores;
             {
               const py::gil_scoped_release release;
               scores = comparison.add(frame, reference, test, exposure_ev,
                                       gaze_px ? std::optional(Vec2d{gaze_px->first, gaze_px->second}) : std::nullopt,
                                       gaze_class_named(gaze_class));
             }
             return frame_dict(scores);
           })
      .def("summary", [](const PictureComparison& comparison) {
        py::list list;
        for (const SequenceScores& sequence : comparison.summary()) {
          list.append(sequence_dict(sequence));
        }
        return list;
      });
}

}  // namespace gazetrace::python
