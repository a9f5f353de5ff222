// SPDX-License-Identifier: Apache-2.0
#include "frame.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bind.hpp"
#include "gazetrace/cryptomatte.hpp"
#include "gazetrace/light_groups.hpp"

namespace gazetrace::python {
namespace {

using FramePtr = std::shared_ptr<GivenFrame>;

template <class Choose>
py::object part(const FramePtr& frame, Choose choose) {
  const auto& image = choose(*frame);
  return image.empty() ? py::object(py::none()) : view_of(image, py::cast(frame));
}

// A layer of FrameLayers by the name of its AOV; None where it was not asked for.
py::object layer(const FramePtr& held, const std::string& name) {
  const FrameLayers& layers = held->rendered.layers;
  const auto image = [&](const auto& one) {
    return one.empty() ? py::object(py::none()) : py::object(view_of(one, py::cast(held)));
  };
  const std::vector<std::string>& groups = light_group_names();
  const auto group = static_cast<std::size_t>(std::find(groups.begin(), groups.end(), name) - groups.begin());
  if (group < layers.light.size()) {
    return image(layers.light[group]);
  }
  return name == "forward"    ? image(layers.motion.forward_px)
         : name == "backward" ? image(layers.motion.backward_px)
         : name == "position" ? image(layers.motion.position_m)
                              : py::object(py::none());
}

const MatteTable* matte_table_of(const GivenFrame& frame, const std::string& name, std::size_t& index) {
  const FrameLayers& layers = frame.rendered.layers;
  for (index = 0; layers.tables && index < layers.tables->size(); ++index) {
    if ((*layers.tables)[index].layer == name) {
      return &(*layers.tables)[index];
    }
  }
  throw Error(ErrorKind::usage, "", "the frame has no mattes '" + name + "'", "give `aov` " + name);
}

// How much of each pixel the thing of a name covers.
py::array matte(const GivenFrame& frame, const std::string& layer_name, const std::string& name) {
  std::size_t index = 0;
  matte_table_of(frame, layer_name, index);
  const Coverage& coverage = frame.rendered.layers.mattes[index];
  const std::uint32_t id = cryptomatte_id(name);
  ImageGray image(frame.request.width_px, frame.request.height_px);
  for (std::size_t rank = 0; rank < coverage.id.size(); ++rank) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      if (std::bit_cast<std::uint32_t>(coverage.id[rank].pixels[i]) == id) {
        image.pixels[i] = coverage.share[rank].pixels[i];
      }
    }
  }
  return given_away(std::move(image));
}

// A picture with 8 or 16 bits that takes over the bytes of the library's.
py::array display_picture(const GivenFrame& frame, int bits) {
  auto image = std::make_unique<DisplayImage>();
  {
    const py::gil_scoped_release release;
    *image = frame.color->apply(frame.rendered.frame.radiance, frame.rendered.exposure_ev, bits, frame.threads);
  }
  const DisplayImage& picture = *image;
  const py::capsule owner(image.release(), [](void* held) { delete static_cast<DisplayImage*>(held); });
  const py::dtype type = bits == 16 ? py::dtype::of<std::uint16_t>() : py::dtype::of<std::uint8_t>();
  return py::array(type, {picture.height_px, picture.width_px, 3}, {}, picture.bytes.data(), owner);
}

py::object eccentricity(const GivenFrame& frame) {
  if (!frame.request.gaze_direction_true) {
    return py::none();
  }
  ImageGray image;
  {
    const py::gil_scoped_release release;
    image = eccentricity_image(frame.request.view, *frame.request.gaze_direction_true);
  }
  return given_away(std::move(image));
}

std::string request_json(const GivenFrame& frame) {
  FramePlan plan;
  plan.frames.push_back(frame.request);
  return plan_as_json(plan);
}

void bind_map(py::module_& module) {
  py::class_<HeldMap>(module, "SamplingMap")
      .def_property_readonly("width", [](const HeldMap& held) { return held.map->width_px; })
      .def_property_readonly("height", [](const HeldMap& held) { return held.map->height_px; })
      .def_property_readonly("samples", [](const HeldMap& held) { return held.map->samples(); })
      .def_property_readonly(
          "region", [](const py::object& self) { return view_of(self.cast<const HeldMap&>().map->region, self); })
      .def_property_readonly("regions",
                             [](const HeldMap& held) {
                               py::list regions;
                               for (const MapRegion& region : held.map->regions) {
                                 py::dict one;
                                 one["name"] = region.name;
                                 one["block_px"] = region.block_px;
                                 one["pixels"] = region.pixels;
                                 one["sites"] = region.sites;
                                 one["samples"] = region.samples;
                                 one["nominal_samples"] = region.nominal_samples;
                                 regions.append(one);
                               }
                               return regions;
                             })
      .def("samples_per_pixel",
           [](const HeldMap& held) {
             ImageGray image;
             {
               const py::gil_scoped_release release;
               image = samples_per_pixel(*held.map);
             }
             return given_away(std::move(image));
           })
      .def("sites", [](const py::object& self) {
        const std::vector<Site>& sites = self.cast<const HeldMap&>().map->sites;
        py::dict columns;
        columns["block_x"] = column_of(sites, &Site::block_x, self);
        columns["block_y"] = column_of(sites, &Site::block_y, self);
        columns["samples"] = column_of(sites, &Site::samples, self);
        columns["pixels"] = column_of(sites, &Site::pixels, self);
        columns["region"] = column_of(sites, &Site::region, self);
        return columns;
      });
}

}  // namespace

Vec2d gaze_in_frame(const GazeAtTime& gaze, const std::optional<DisplayGeometry>& screen, const FrameRect& rect,
                    int width_px, int height_px) {
  if (!screen || rect.width_px == 0) {
    return {gaze.u * width_px, gaze.v * height_px};
  }
  return {(gaze.u * screen->width_px - rect.x_px) / rect.width_px * width_px,
          (gaze.v * screen->height_px - rect.y_px) / rect.height_px * height_px};
}

void bind_frame(py::module_& module) {
  bind_map(module);
  py::class_<PlanarView>(module, "View")
      .def_property_readonly("width", [](const PlanarView& view) { return view.width_px; })
      .def_property_readonly("height", [](const PlanarView& view) { return view.height_px; })
      .def_property_readonly("pixels_per_degree", [](const PlanarView& view) { return 1 / (view.step_x * kDegPerRad); })
      .def("eccentricity", [](const PlanarView& view, double x_px, double y_px) {
        return given_away(eccentricity_image(view, view.direction(x_px, y_px)));
      });
  py::class_<GivenFrame, FramePtr>(module, "Frame")
      .def_property_readonly("frame", [](const GivenFrame& frame) { return frame.request.frame; })
      .def_property_readonly("t_video_ns", [](const GivenFrame& frame) { return frame.request.t_video_ns; })
      .def_property_readonly("width", [](const GivenFrame& frame) { return frame.request.width_px; })
      .def_property_readonly("height", [](const GivenFrame& frame) { return frame.request.height_px; })
      .def_property_readonly("exposure_ev", [](const GivenFrame& frame) { return frame.rendered.exposure_ev; })
      .def_property_readonly("view",
                             [](const GivenFrame& frame) {
                               return frame.is_on_screen ? py::cast(frame.request.view) : py::object(py::none());
                             })
      .def_property_readonly("gaze_px",
                             [](const GivenFrame& frame) -> py::object {
                               return frame.gaze_px ? py::object(py::make_tuple(frame.gaze_px->x, frame.gaze_px->y))
                                                    : py::object(py::none());
                             })
      .def_property_readonly("gaze_class",
                             [](const GivenFrame& frame) { return std::string(to_string(frame.gaze_class)); })
      .def_property_readonly("frames_per_second", [](const GivenFrame& frame) { return frame.frames_per_second; })
      .def_property_readonly("color", [](const GivenFrame& frame) { return frame.color; })
      .def_property_readonly("radiance",
                             [](const FramePtr& held) {
                               return part(
                                   held, [](auto& frame) -> auto& { return frame.rendered.frame.radiance; });
                             })
      .def_property_readonly("samples",
                             [](const FramePtr& held) {
                               return part(
                                   held, [](auto& frame) -> auto& { return frame.rendered.frame.sample_count; });
                             })
      .def_property_readonly("variance",
                             [](const FramePtr& held) {
                               return part(
                                   held, [](auto& frame) -> auto& { return frame.rendered.frame.variance; });
                             })
      .def_property_readonly("squared_error",
                             [](const FramePtr& held) {
                               return part(
                                   held, [](auto& frame) -> auto& { return frame.rendered.frame.squared_error; });
                             })
      .def_property_readonly("albedo",
                             [](const FramePtr& held) {
                               return part(
                                   held, [](auto& frame) -> auto& { return frame.rendered.frame.albedo; });
                             })
      .def_property_readonly("normal",
                             [](const FramePtr& held) {
                               return part(
                                   held, [](auto& frame) -> auto& { return frame.rendered.frame.normal; });
                             })
      .def_property_readonly("depth",
                             [](const FramePtr& held) {
                               return part(
                                   held, [](auto& frame) -> auto& { return frame.rendered.frame.depth_m; });
                             })
      .def_property_readonly(
          "sampling_map",
          [](const FramePtr& held) { return HeldMap{std::shared_ptr<const SamplingMap>(held, &held->rendered.map)}; })
      .def("eccentricity", &eccentricity)
      .def("layer", &layer)
      .def("matte", &matte)
      .def("manifest",
           [](const GivenFrame& frame, const std::string& name) {
             std::size_t index = 0;
             return matte_table_of(frame, name, index)->manifest;
           })
      .def("display", &display_picture, py::arg("bits") = 8)
      .def("request_json", &request_json)
      .def("timing_text", [](const GivenFrame& frame) { return timing_row_text(frame.row); });
  module.def("timing_columns", &timing_columns);
  module.def("aov_names", &aov_names);
}

}  // namespace gazetrace::python
