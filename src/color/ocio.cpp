// SPDX-License-Identifier: Apache-2.0
// The only file that includes OpenColorIO.
#include "color/ocio.hpp"

#include <OpenColorIO/OpenColorIO.h>

#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace ocio = OCIO_NAMESPACE;

namespace gazetrace {
namespace {

constexpr const char* kRec709Name = "Linear Rec.709";
constexpr const char* kBuiltinDisplay = "sRGB";
constexpr const char* kAcesView = "ACES SDR";

// From linear Rec.709 (D65) to ACES2065-1 (AP0 with its own white), with Bradford adaptation. Derived from the
// primaries in tests/unit/color_view_test.cpp; the public ACES configurations have the same figures.
ocio::MatrixTransformRcPtr rec709_to_aces() {
  constexpr std::array<double, 16> kMatrix{0.439632981919,
                                           0.382988698152,
                                           0.177378319929,
                                           0,  //
                                           0.089776442959,
                                           0.813439428749,
                                           0.096784128292,
                                           0,  //
                                           0.017541170383,
                                           0.111546553302,
                                           0.870912276315,
                                           0,  //
                                           0,
                                           0,
                                           0,
                                           1};
  auto matrix = ocio::MatrixTransform::Create();
  matrix->setMatrix(kMatrix.data());
  return matrix;
}

ocio::TransformRcPtr builtin(const char* style) {
  auto transform = ocio::BuiltinTransform::Create();
  transform->setStyle(style);
  return transform;
}

// The value of the half with these bits; infinities and NaN give the largest finite half of their sign.
float half_from_bits(unsigned bits) {
  const float sign = (bits & 0x8000U) != 0 ? -1.0F : 1.0F;
  const unsigned exponent = (bits >> 10U) & 31U;
  const auto mantissa = static_cast<float>(bits & 1023U);
  if (exponent == 31) {
    return sign * 65504.0F;
  }
  return exponent == 0 ? sign * std::ldexp(mantissa, -24)
                       : sign * std::ldexp(1024.0F + mantissa, static_cast<int>(exponent) - 25);
}

// Reinhard et al. 2002, eq. (3), L_d = L / (1 + L), applied to luminance with the chromaticity kept. The curve is a
// table over all halves, because OpenColorIO has no rational function; it is linear in between (relative error <
// 2^-22).
ocio::GroupTransformRcPtr reinhard() {
  auto to_xyy = ocio::FixedFunctionTransform::Create(ocio::FIXED_FUNCTION_XYZ_TO_xyY);
  auto from_xyy = ocio::FixedFunctionTransform::Create(ocio::FIXED_FUNCTION_XYZ_TO_xyY);
  from_xyy->setDirection(ocio::TRANSFORM_DIR_INVERSE);
  auto curve = ocio::Lut1DTransform::Create(65536, true);
  curve->setInterpolation(ocio::INTERP_LINEAR);
  for (unsigned bits = 0; bits < 65536; ++bits) {
    const float value = half_from_bits(bits);
    const float luminance = value > 0 ? value : 0;
    curve->setValue(bits, value, value, luminance / (1 + luminance));
  }
  auto group = ocio::GroupTransform::Create();
  group->appendTransform(builtin("UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"));
  group->appendTransform(to_xyy);
  group->appendTransform(curve);
  group->appendTransform(from_xyy);
  return group;
}

void add_view_transform(ocio::Config& config, const char* name, const ocio::ConstTransformRcPtr& from_scene) {
  auto transform = ocio::ViewTransform::Create(ocio::REFERENCE_SPACE_SCENE);
  transform->setName(name);
  transform->setTransform(from_scene, ocio::VIEWTRANSFORM_DIR_FROM_REFERENCE);
  config.addViewTransform(transform);
}

// The scene reference is ACES2065-1, the display reference CIE XYZ with a D65 white, as in the public ACES
// configurations.
ocio::ConstConfigRcPtr make_builtin_config() {
  auto config = ocio::Config::Create();
  config->setVersion(2, 1);

  auto aces = ocio::ColorSpace::Create(ocio::REFERENCE_SPACE_SCENE);
  aces->setName("ACES2065-1");
  config->addColorSpace(aces);
  auto rec709 = ocio::ColorSpace::Create(ocio::REFERENCE_SPACE_SCENE);
  rec709->setName(kRec709Name);
  rec709->setTransform(rec709_to_aces(), ocio::COLORSPACE_DIR_TO_REFERENCE);
  config->addColorSpace(rec709);
  auto raw = ocio::ColorSpace::Create(ocio::REFERENCE_SPACE_SCENE);
  raw->setName("Raw");
  raw->setIsData(true);
  config->addColorSpace(raw);
  auto srgb = ocio::ColorSpace::Create(ocio::REFERENCE_SPACE_DISPLAY);
  srgb->setName("sRGB - Display");
  srgb->setTransform(builtin("DISPLAY - CIE-XYZ-D65_to_sRGB"), ocio::COLORSPACE_DIR_FROM_REFERENCE);
  config->addColorSpace(srgb);

  config->setRole(ocio::ROLE_INTERCHANGE_SCENE, "ACES2065-1");
  config->setRole(ocio::ROLE_SCENE_LINEAR, kRec709Name);
  config->setRole(ocio::ROLE_DEFAULT, "Raw");

  add_view_transform(*config, "ACES 1.x SDR", builtin("ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0"));
  add_view_transform(*config, "Reinhard 2002", reinhard());
  add_view_transform(*config, "Plain", builtin("UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"));
  const auto add_view = [&](const char* name, const char* transform) {
    config->addDisplayView(kBuiltinDisplay, name, transform, "sRGB - Display", "", "", "");
  };
  add_view(kAcesView, "ACES 1.x SDR");
  add_view("sRGB", "Plain");
  add_view("Reinhard", "Reinhard 2002");
  config->addDisplayView(kBuiltinDisplay, "Raw", "Raw", "");
  config->validate();
  return config;
}

struct LoadedConfig {
  ocio::ConstConfigRcPtr config;
  std::string path;  // empty: built in
};

struct ConfigVersion {
  int major = 0, minor = 0;
  auto operator<=>(const ConfigVersion&) const = default;
};

// The version that a config states; none in archives, within the library, and in files that are no configs.
ConfigVersion stated_version(const std::string& path) {
  std::ifstream file(path);
  ConfigVersion version;
  for (std::string line; std::getline(file, line);) {
    if (std::sscanf(line.c_str(), "ocio_profile_version: %d.%d", &version.major, &version.minor) > 0) {
      break;
    }
  }
  return version;
}

// Why this OpenColorIO cannot read a config that a newer one can; empty where that is not so.
std::string why_too_new(const std::string& path, const std::string& place) {
  const ConfigVersion stated = stated_version(path);
  const std::string library = ocio::GetVersion();
  ConfigVersion known;
  std::sscanf(library.c_str(), "%d.%d", &known.major, &known.minor);
  const auto text = [](const ConfigVersion& v) { return std::to_string(v.major) + "." + std::to_string(v.minor); };
  return stated <= known ? std::string()
                         : place + ": the config has version " + text(stated) + ", and this program's OpenColorIO " +
                               library + " reads those up to " + text(known);
}

LoadedConfig load_config(const ColorSettings& settings, std::string& why_replaced) {
  std::string path = settings.config;
  std::string place = path;
  if (path.empty()) {
    const char* variable = std::getenv("OCIO");
    path = variable != nullptr ? variable : "";
    place = "$OCIO (" + path + ")";
  }
  if (path.empty()) {
    return {make_builtin_config(), ""};
  }
  const bool is_within_library = path.starts_with("ocio://");
#if OCIO_VERSION_HEX < 0x02020000
  if (is_within_library) {
    throw Error(
        ErrorKind::input, place,
        std::string("configs within OpenColorIO came with its version 2.2, and this is ") + OCIO_VERSION_FULL_STR,
        "download the config as a file from the OpenColorIO-Config-ACES project, or leave it out for the "
        "built-in one");
  }
#endif
  if (!is_within_library && !std::filesystem::exists(path)) {
    throw Error(ErrorKind::input, place, "no such OpenColorIO config", "give an existing file or leave it out");
  }
  if (!is_within_library) {
    why_replaced = why_too_new(path, place);
    if (!why_replaced.empty()) {
      return {make_builtin_config(), ""};
    }
  }
  try {
    auto config = ocio::Config::CreateFromFile(path.c_str());
    config->validate();
    return {config, path};
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, place, std::string("not a usable OpenColorIO config: ") + e.what(), {});
  }
}

// The config, or the built-in one in its place: then `why_replaced` is not empty.
LoadedConfig load_or_replace(const ColorSettings& settings, std::string& why_replaced) {
  try {
    return load_config(settings, why_replaced);
  } catch (const Error& error) {
    if (settings.is_needed) {
      throw;
    }
    why_replaced = error.what();
    return {make_builtin_config(), ""};
  }
}

std::vector<ViewInfo> list_views(const ocio::Config& config) {
  std::vector<ViewInfo> views;
  const std::string default_display = config.getDefaultDisplay();
  for (int d = 0; d < config.getNumDisplays(); ++d) {
    const char* display = config.getDisplay(d);
    const std::string default_view = config.getDefaultView(display);
    for (int v = 0; v < config.getNumViews(display); ++v) {
      const char* view = config.getView(display, v);
      views.push_back({display, view, default_display == display && default_view == view});
    }
  }
  return views;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  for (const std::string& candidate : names) {
    if (candidate == name) {
      return true;
    }
  }
  return false;
}

// The given name, or the default where none is given.
std::string choose(const char* what, const std::string& given, const char* fallback,
                   const std::vector<std::string>& known, const std::string& place) {
  if (given.empty()) {
    return fallback;
  }
  if (!contains(known, given)) {
    throw Error(ErrorKind::usage, place, unknown_name_message(what, given, known));
  }
  return given;
}

// OpenColorIO's syntax for looks: names with an optional + or - in front, separated by "," or ":"; alternatives are
// separated by "|".
void check_looks(const ocio::Config& config, const std::string& looks, const std::string& place) {
  std::vector<std::string> known;
  for (int i = 0; i < config.getNumLooks(); ++i) {
    known.emplace_back(config.getLookNameByIndex(i));
  }
  if (known.empty()) {
    throw Error(ErrorKind::usage, place, "unknown look '" + looks + "'; this config has none", "leave `look` out");
  }
  std::size_t begin = 0;
  while (begin <= looks.size()) {
    const std::size_t end = std::min(looks.find_first_of(",:|", begin), looks.size());
    std::string name = looks.substr(begin, end - begin);
    const std::size_t first = name.find_first_not_of(" +-");
    name = first == std::string::npos ? "" : name.substr(first, name.find_last_not_of(' ') - first + 1);
    if (!name.empty() && !contains(known, name)) {
      throw Error(ErrorKind::usage, place, unknown_name_message("look", name, known));
    }
    begin = end + 1;
  }
}

// Finds a way from linear Rec.709 into the config: returns the name of the colour space to enter by, and adds the
// matrix that leads there to `group`, where one is needed.
std::string enter_config(const LoadedConfig& loaded, const ColorSettings& settings, ocio::GroupTransform& group) {
  const ocio::Config& config = *loaded.config;
  if (!settings.input.empty()) {
    if (const auto space = config.getColorSpace(settings.input.c_str())) {
      return space->getName();
    }
    std::vector<std::string> known;
    for (int i = 0; i < config.getNumColorSpaces(); ++i) {
      known.emplace_back(config.getColorSpaceNameByIndex(i));
    }
    throw Error(ErrorKind::usage, loaded.path, unknown_name_message("input color space", settings.input, known));
  }
  if (loaded.path.empty()) {
    return kRec709Name;
  }
  if (!config.hasRole(ocio::ROLE_INTERCHANGE_SCENE)) {
    throw Error(ErrorKind::input, loaded.path,
                "the config has no role aces_interchange, so there is no way into it from linear Rec.709",
                "name its linear Rec.709 color space with `ocio-input`");
  }
  group.appendTransform(rec709_to_aces());
  return config.getColorSpace(ocio::ROLE_INTERCHANGE_SCENE)->getName();
}

// Whether a view shows numbers as they are.
bool shows_data(const ocio::Config& config, const std::string& display, const std::string& view) {
  std::string name = config.getDisplayViewColorSpaceName(display.c_str(), view.c_str());
  if (name == ocio::OCIO_VIEW_USE_DISPLAY_NAME) {  // of a view that displays share
    name = display;
  }
  const auto space = config.getColorSpace(name.c_str());
  return space && space->isData();
}

}  // namespace

struct OcioView::Impl {
  std::vector<ViewInfo> views;
  Warnings warnings;
  std::string description;
  bool is_builtin_aces = false;
  ocio::ConstCPUProcessorRcPtr to_8, to_16, to_float;
};

OcioView::OcioView(const ColorSettings& given) : impl_(std::make_unique<Impl>()) {
  std::string why_replaced;
  const LoadedConfig loaded = load_or_replace(given, why_replaced);
  // The names of another config mean nothing to the built-in one.
  const ColorSettings settings = why_replaced.empty() ? given : ColorSettings{};
  if (!why_replaced.empty()) {
    impl_->warnings.push_back(
        why_replaced + (given.is_needed ? "; pictures have the built-in view instead" : "; no picture needs it"));
  }
  const ocio::Config& config = *loaded.config;
  const std::string place = loaded.path.empty() ? "built-in color config" : loaded.path;
  impl_->views = list_views(config);
  if (impl_->views.empty()) {
    throw Error(ErrorKind::input, place, "the config has no display with a view", {});
  }

  std::vector<std::string> displays;
  for (int i = 0; i < config.getNumDisplays(); ++i) {
    displays.emplace_back(config.getDisplay(i));
  }
  const std::string display = choose("display", settings.display, config.getDefaultDisplay(), displays, place);
  std::vector<std::string> views;
  for (int i = 0; i < config.getNumViews(display.c_str()); ++i) {
    views.emplace_back(config.getView(display.c_str(), i));
  }
  const std::string view =
      choose("view", settings.view, config.getDefaultView(display.c_str()), views, place + ", display " + display);

  auto group = ocio::GroupTransform::Create();
  const bool is_data = shows_data(config, display, view);
  const std::string source = is_data && settings.input.empty() ? "" : enter_config(loaded, settings, *group);
  if (!settings.look.empty()) {
    check_looks(config, settings.look, place);
  }
  if (is_data && !settings.look.empty()) {
    throw Error(ErrorKind::usage, place, "view '" + view + "' shows the picture's own numbers, which no look changes",
                "leave `look` out, or choose another view");
  }
  auto display_view = ocio::DisplayViewTransform::Create();
  display_view->setSrc(source.c_str());
  display_view->setDisplay(display.c_str());
  display_view->setView(view.c_str());
  if (!settings.look.empty()) {
    auto look = ocio::LookTransform::Create();
    look->setSrc(source.c_str());
    look->setDst(source.c_str());
    look->setLooks(settings.look.c_str());
    group->appendTransform(look);
    display_view->setLooksBypass(true);
  }
  if (!is_data) {
    group->appendTransform(display_view);
  }

  try {
    const auto processor = config.getProcessor(group);
    const auto optimized = [&](ocio::BitDepth depth) {
      return processor->getOptimizedCPUProcessor(ocio::BIT_DEPTH_F32, depth, ocio::OPTIMIZATION_VERY_GOOD);
    };
    impl_->to_8 = optimized(ocio::BIT_DEPTH_UINT8);
    impl_->to_16 = optimized(ocio::BIT_DEPTH_UINT16);
    impl_->to_float = optimized(ocio::BIT_DEPTH_F32);
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, place,
                "view '" + view + "' of display '" + display + "' cannot be built: " + e.what(), {});
  }
  impl_->is_builtin_aces = loaded.path.empty() && view == kAcesView;
  impl_->description = (loaded.path.empty() ? "built-in" : loaded.path) + ": display " + display + ", view " + view +
                       (settings.look.empty() ? "" : ", look " + settings.look);
}

OcioView::~OcioView() = default;

const std::vector<ViewInfo>& OcioView::views() const {
  return impl_->views;
}
const Warnings& OcioView::warnings() const {
  return impl_->warnings;
}
const std::string& OcioView::description() const {
  return impl_->description;
}
bool OcioView::is_builtin_aces() const {
  return impl_->is_builtin_aces;
}

namespace {

void apply(const ocio::ConstCPUProcessorRcPtr& processor, float* rgb, std::size_t count, void* out,
           ocio::BitDepth depth) {
  const ocio::PackedImageDesc source(rgb, static_cast<long>(count), 1, ocio::CHANNEL_ORDERING_RGB, ocio::BIT_DEPTH_F32,
                                     ocio::AutoStride, ocio::AutoStride, ocio::AutoStride);
  ocio::PackedImageDesc target(out, static_cast<long>(count), 1, ocio::CHANNEL_ORDERING_RGB, depth, ocio::AutoStride,
                               ocio::AutoStride, ocio::AutoStride);
  processor->apply(source, target);
}

}  // namespace

void OcioView::apply_8(float* rgb, std::size_t count, std::uint8_t* out) const {
  apply(impl_->to_8, rgb, count, out, ocio::BIT_DEPTH_UINT8);
}
void OcioView::apply_16(float* rgb, std::size_t count, std::uint16_t* out) const {
  apply(impl_->to_16, rgb, count, out, ocio::BIT_DEPTH_UINT16);
}
void OcioView::apply_float(float* rgb, std::size_t count) const {
  apply(impl_->to_float, rgb, count, rgb, ocio::BIT_DEPTH_F32);
}

}  // namespace gazetrace
