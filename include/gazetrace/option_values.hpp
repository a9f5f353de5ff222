// SPDX-License-Identifier: Apache-2.0
// Conversion between text and value for every type that an option of a job can have. The text of format_value() is
// canonical: reading it gives the same value, and equal values give equal text. Settings files and digests are made of
// this text.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/temporal.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

struct DurationNs {
  std::int64_t ns = 0;
};
// "8G", "500M", "4096": powers of 1024, with or without "B" or "iB" behind.
struct ByteCount {
  std::uint64_t bytes = 0;
};
// The K-th chunk, counted from 1, of N: "2/5".
struct Chunk {
  std::uint32_t number = 1, count = 1;
};
// The axis that points up.
enum class WorldUp : std::uint8_t { y, z };

struct SizePx {
  int width = 0, height = 0;
};
// A rectangle of a frame, in its pixels from the top left.
struct FrameCrop {
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;
  friend bool operator==(const FrameCrop&, const FrameCrop&) = default;
};

struct FrameList {
  std::vector<std::int32_t> frames;  // none: "fixations", one for each of the gaze log
};
// "f/2.8" or a radius in metres; 0: a pinhole.
struct Aperture {
  double f_number = 0;  // 0: radius_m counts
  double radius_m = 0;
};

// Every parser throws Error(usage, place, ...), where place is the option or the line of a settings file.
void parse_value(std::string_view text, const std::string& place, bool& value);
void parse_value(std::string_view text, const std::string& place, int& value);
void parse_value(std::string_view text, const std::string& place, std::uint32_t& value);
void parse_value(std::string_view text, const std::string& place, std::uint64_t& value);
void parse_value(std::string_view text, const std::string& place, double& value);
void parse_value(std::string_view text, const std::string& place, std::string& value);
void parse_value(std::string_view text, const std::string& place, DurationNs& value);
void parse_value(std::string_view text, const std::string& place, ByteCount& value);
void parse_value(std::string_view text, const std::string& place, Chunk& value);
void parse_value(std::string_view text, const std::string& place, SizePx& value);
void parse_value(std::string_view text, const std::string& place, FrameList& value);
void parse_value(std::string_view text, const std::string& place, FrameRate& value);
void parse_value(std::string_view text, const std::string& place, Shutter& value);
void parse_value(std::string_view text, const std::string& place, Aperture& value);
void parse_value(std::string_view text, const std::string& place, Vec2d& value);
void parse_value(std::string_view text, const std::string& place, Vec3d& value);
void parse_value(std::string_view text, const std::string& place, FrameRect& value);
void parse_value(std::string_view text, const std::string& place, FrameCrop& value);
void parse_value(std::string_view text, const std::string& place, PixelIndex& value);
void parse_value(std::string_view text, const std::string& place, std::array<std::uint32_t, 3>& value);
void parse_value(std::string_view text, const std::string& place, std::array<int, 2>& value);
void parse_value(std::string_view text, const std::string& place, std::array<double, 2>& value);
void parse_value(std::string_view text, const std::string& place, std::vector<std::string>& value);  // a,b,c
void parse_value(std::string_view text, const std::string& place, Sampling& value);
void parse_value(std::string_view text, const std::string& place, DensitySampling& value);  // reads a curve
// "auto", "auto+0.5" or a number of stops. Sets mode and ev, and leaves the rest as it is.
void parse_value(std::string_view text, const std::string& place, ExposureSettings& value);

std::string format_value(bool value);
std::string format_value(int value);
std::string format_value(std::uint32_t value);
std::string format_value(std::uint64_t value);
std::string format_value(double value);
std::string format_value(const std::string& value);
std::string format_value(const DurationNs& value);
std::string format_value(const ByteCount& value);
std::string format_value(const Chunk& value);
std::string format_value(const SizePx& value);
std::string format_value(const FrameList& value);
std::string format_value(const FrameRate& value);
std::string format_value(const Shutter& value);
std::string format_value(const Aperture& value);
std::string format_value(const Vec2d& value);
std::string format_value(const Vec3d& value);
std::string format_value(const FrameRect& value);
std::string format_value(const FrameCrop& value);
std::string format_value(const PixelIndex& value);
std::string format_value(const std::array<std::uint32_t, 3>& value);
std::string format_value(const std::array<int, 2>& value);
std::string format_value(const std::array<double, 2>& value);
std::string format_value(const std::vector<std::string>& value);
std::string format_value(const Sampling& value);
std::string format_value(const DensitySampling& value);
std::string format_value(const ExposureSettings& value);

// The names of an enumeration's values, in the order of the help.
template <class E>
struct EnumNames;

template <class E>
using NameList = std::vector<std::pair<E, const char*>>;

#define GAZETRACE_ENUM_NAMES(Type, what_text, ...)  \
  template <>                                       \
  struct EnumNames<Type> {                          \
    static constexpr const char* kWhat = what_text; \
    static NameList<Type> values() {                \
      using E = Type;                               \
      return {__VA_ARGS__};                         \
    }                                               \
  };
GAZETRACE_ENUM_NAMES(CameraAxes, "axes", {E::gl, "gl"}, {E::cv, "cv"}, {E::unity, "unity"})
GAZETRACE_ENUM_NAMES(CameraExtrapolation, "extrapolation", {E::error, "error"}, {E::hold, "hold"})
GAZETRACE_ENUM_NAMES(PathInterpolation, "interpolation", {E::linear, "linear"}, {E::step, "step"},
                     {E::catmull_rom, "catmull-rom"})
GAZETRACE_ENUM_NAMES(GazeTransfer, "gaze transfer", {E::fraction, "fraction"}, {E::angle, "angle"})
GAZETRACE_ENUM_NAMES(RotationOrder, "rotation order", {E::xyz, "xyz"}, {E::xzy, "xzy"}, {E::yxz, "yxz"},
                     {E::yzx, "yzx"}, {E::zxy, "zxy"}, {E::zyx, "zyx"})
GAZETRACE_ENUM_NAMES(WorldUp, "up axis", {E::y, "y"}, {E::z, "z"})
GAZETRACE_ENUM_NAMES(TimeUnit, "time unit", {E::automatic, "auto"}, {E::ns, "ns"}, {E::us, "us"}, {E::ms, "ms"},
                     {E::s, "s"})
GAZETRACE_ENUM_NAMES(PositionUnit, "gaze unit", {E::automatic, "auto"}, {E::fraction, "fraction"}, {E::px, "px"},
                     {E::mm, "mm"}, {E::cm, "cm"}, {E::deg, "deg"}, {E::unit_vector, "unit-vector"}, {E::norm, "norm"},
                     {E::height, "height"}, {E::rad, "rad"})
GAZETRACE_ENUM_NAMES(PositionOrigin, "gaze origin", {E::automatic, "auto"}, {E::top_left, "top-left"},
                     {E::bottom_left, "bottom-left"}, {E::center, "center"})
GAZETRACE_ENUM_NAMES(GazeInterpolation, "gaze mode", {E::hold, "hold"}, {E::nearest, "nearest"}, {E::linear, "linear"})
GAZETRACE_ENUM_NAMES(NoGazePolicy, "policy for missing gaze", {E::hold, "hold"}, {E::center, "center"},
                     {E::uniform, "uniform"}, {E::error, "error"})
GAZETRACE_ENUM_NAMES(GazeAxes, "gaze axes", {E::automatic, "auto"}, {E::gl, "gl"}, {E::unity, "unity"},
                     {E::sranipal, "sranipal"}, {E::cv, "cv"}, {E::unreal, "unreal"})
GAZETRACE_ENUM_NAMES(EyeChoice, "eye", {E::automatic, "auto"}, {E::left, "left"}, {E::right, "right"},
                     {E::mean, "mean"})
GAZETRACE_ENUM_NAMES(GazeFrame, "gaze frame", {E::automatic, "auto"}, {E::head, "head"},
                     {E::scene_camera, "scene-camera"}, {E::world, "world"})
GAZETRACE_ENUM_NAMES(Eye, "eye", {E::left, "left"}, {E::right, "right"})
GAZETRACE_ENUM_NAMES(GazeDevice, "device", {E::desktop, "desktop"}, {E::head_mounted, "head-mounted"})
GAZETRACE_ENUM_NAMES(UnorderedPolicy, "policy for unordered stamps", {E::error, "error"}, {E::sort, "sort"},
                     {E::pairs, "pairs"}, {E::unwrap, "unwrap"})
GAZETRACE_ENUM_NAMES(DiffuseModel, "diffuse model", {E::burley, "burley"}, {E::lambert, "lambert"}, {E::matte, "matte"})
GAZETRACE_ENUM_NAMES(LightSampling, "light sampling", {E::mis, "mis"}, {E::light_only, "light"}, {E::bsdf_only, "bsdf"})
GAZETRACE_ENUM_NAMES(PixelFilter, "pixel filter", {E::box, "box"}, {E::blackman_harris, "blackman-harris"})
GAZETRACE_ENUM_NAMES(AccumulateMode, "accumulation", {E::automatic, "auto"}, {E::off, "off"}, {E::window, "window"})
GAZETRACE_ENUM_NAMES(ExrPixels, "EXR pixel type", {E::half, "half"}, {E::float32, "float"})
GAZETRACE_ENUM_NAMES(ExrSpace, "colour space of an EXR", {E::rec709, "Rec.709"}, {E::acescg, "ACEScg"},
                     {E::aces2065_1, "ACES2065-1"})
GAZETRACE_ENUM_NAMES(ExrParts, "parts of an EXR", {E::single, "single"}, {E::multi, "multi"})
#undef GAZETRACE_ENUM_NAMES

template <class E>
std::vector<std::string> enum_names() {
  std::vector<std::string> names;
  for (const auto& [value, name] : EnumNames<E>::values()) {
    names.emplace_back(name);
  }
  return names;
}

// "a|b|c", for the help.
template <class E>
std::string choices() {
  std::string text;
  for (const std::string& name : enum_names<E>()) {
    text += (text.empty() ? "" : "|") + name;
  }
  return text;
}

template <class E>
requires std::is_enum_v<E>
void parse_value(std::string_view text, const std::string& place, E& value) {
  for (const auto& [candidate, name] : EnumNames<E>::values()) {
    if (text == name) {
      value = candidate;
      return;
    }
  }
  throw Error(ErrorKind::usage, place, unknown_name_message(EnumNames<E>::kWhat, text, enum_names<E>()));
}

template <class E>
requires std::is_enum_v<E> std::string format_value(E value) {
  for (const auto& [candidate, name] : EnumNames<E>::values()) {
    if (value == candidate) {
      return name;
    }
  }
  return {};
}

}  // namespace gazetrace
