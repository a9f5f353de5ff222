// SPDX-License-Identifier: Apache-2.0
// Images of the library as NumPy arrays, and back.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace::python {

namespace py = pybind11;

static_assert(sizeof(Vec3f) == 3 * sizeof(float) && std::is_standard_layout_v<Vec3f>);
static_assert(sizeof(Vec2f) == 2 * sizeof(float) && std::is_standard_layout_v<Vec2f>);

// pybind11 takes the memory as writable, whatever it is.
inline py::array read_only(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

// The image's own memory as an array of the shape (height, width) or, for colours and vectors, (height, width, 3 or 2).
// `owner` is what keeps that memory alive; the array refers to it.
template <class T>
py::array array_over(const Image<T>& image, const py::object& owner) {
  const auto height = static_cast<py::ssize_t>(image.height_px);
  const auto width = static_cast<py::ssize_t>(image.width_px);
  if constexpr (std::is_same_v<T, Vec3f>) {
    return py::array(py::dtype::of<float>(), {height, width, py::ssize_t{3}}, {}, image.pixels.data(), owner);
  } else if constexpr (std::is_same_v<T, Vec2f>) {
    return py::array(py::dtype::of<float>(), {height, width, py::ssize_t{2}}, {}, image.pixels.data(), owner);
  } else {
    return py::array(py::dtype::of<T>(), {height, width}, {}, image.pixels.data(), owner);
  }
}

// A picture that the library goes on using.
template <class T>
py::array view_of(const Image<T>& image, const py::object& owner) {
  return read_only(array_over(image, owner));
}

// An array that takes over an image which nobody else needs, so that it may be written to.
template <class T>
py::array given_away(Image<T> image) {
  auto kept = std::make_unique<Image<T>>(std::move(image));
  const Image<T>& pixels = *kept;
  const py::capsule owner(kept.release(), [](void* held) { delete static_cast<Image<T>*>(held); });
  return array_over(pixels, owner);
}

// One member of every element of a vector, as an array over the vector's own memory.
template <class T, class S>
py::array column_of(const std::vector<S>& rows, T S::*member, const py::object& owner) {
  const auto count = static_cast<py::ssize_t>(rows.size());
  if (rows.empty()) {
    return py::array(py::dtype::of<T>(), std::vector<py::ssize_t>{0});
  }
  return read_only(
      py::array(py::dtype::of<T>(), {count}, {static_cast<py::ssize_t>(sizeof(S))}, &(rows.front().*member), owner));
}

// Numbers of any kind become 32-bit floats.
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

// Error(usage) that names the picture where the array has another shape.
inline ImageRgb rgb_of(const Floats& array, const std::string& what) {
  if (array.ndim() != 3 || array.shape(2) != 3) {
    throw Error(ErrorKind::usage, what, "is not an array of the shape (height, width, 3)");
  }
  ImageRgb image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  std::copy_n(array.data(), array.size(), reinterpret_cast<float*>(image.pixels.data()));
  return image;
}

}  // namespace gazetrace::python
