// SPDX-License-Identifier: Apache-2.0
// The only file that includes OpenEXR.
#include "output/exr.hpp"

#include <ImathMatrix.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <deque>
#include <filesystem>
#include <limits>
#include <mutex>
#include <new>
#include <system_error>

#include "core/exr_header.hpp"
#include "core/parallel.hpp"
#include "gazetrace/output.hpp"
#include "output/gaze_text.hpp"
#include "output/written_file.hpp"

namespace gazetrace {
namespace {

struct Compression {
  const char* name;
  Imf::Compression value;
};
constexpr std::array<Compression, 10> kCompressions{{{"none", Imf::NO_COMPRESSION},
                                                     {"rle", Imf::RLE_COMPRESSION},
                                                     {"zips", Imf::ZIPS_COMPRESSION},
                                                     {"zip", Imf::ZIP_COMPRESSION},
                                                     {"piz", Imf::PIZ_COMPRESSION},
                                                     {"pxr24", Imf::PXR24_COMPRESSION},
                                                     {"b44", Imf::B44_COMPRESSION},
                                                     {"b44a", Imf::B44A_COMPRESSION},
                                                     {"dwaa", Imf::DWAA_COMPRESSION},
                                                     {"dwab", Imf::DWAB_COMPRESSION}}};

Imf::Compression compression_by_name(const std::string& name) {
  for (const Compression& compression : kCompressions) {
    if (name == compression.name) {
      return compression.value;
    }
  }
  throw Error(ErrorKind::usage, "", unknown_name_message("EXR compression", name, exr_compression_names()));
}

// Collects a whole file in memory. OpenEXR's own file stream loses the error where its last buffer meets a full disk,
// so write_bytes_atomically writes the bytes.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}
  void write(const char* data, int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (at_ + size > bytes_.size()) {
      bytes_.resize(at_ + size);
    }
    std::memcpy(&bytes_[at_], data, size);
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return std::as_bytes(std::span(bytes_)); }

 private:
  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

// OpenEXR has one pool of worker threads for the process; it is only ever enlarged here.
void want_exr_threads(int threads) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (threads > 1 && Imf::globalThreadCount() < threads) {
    Imf::setGlobalThreadCount(threads);
  }
}

// The channels of one picture, and the buffers that they are written from.
class ExrPicture {
 public:
  ExrPicture(int width_px, int height_px, int threads)
      : header_(width_px, height_px), width_px_(width_px), height_px_(height_px), threads_(threads) {}

  Imf::Header& header() { return header_; }
  [[nodiscard]] std::uint64_t clamped() const { return clamped_; }

  void add_float(const std::string& name, const ImageGray& image) {
    insert(name, Imf::FLOAT, reinterpret_cast<const char*>(image.pixels.data()), sizeof(float));
  }
  void add_constant(const std::string& name, float value) {
    const ImageGray& image = constants_.emplace_back(width_px_, height_px_, value);
    add_float(name, image);
  }
  void add_float_rgb(const std::array<std::string, 3>& names, const ImageRgb& image) {
    for (std::size_t c = 0; c < 3; ++c) {
      insert(names[c], Imf::FLOAT, reinterpret_cast<const char*>(image.pixels.data()) + c * sizeof(float),
             sizeof(Vec3f));
    }
  }
  void add_half_rgb(const std::array<std::string, 3>& names, const ImageRgb& image) {
    constexpr std::size_t kRun = 16384;
    const float* values = &image.pixels.data()->x;
    const std::size_t count = image.pixels.size() * 3;
    std::vector<half>& halves = halves_.emplace_back(count);
    std::atomic<std::uint64_t> clamped{0};
    parallel_for((count + kRun - 1) / kRun, threads_, [&](std::size_t run) {
      const std::size_t end = std::min(count, (run + 1) * kRun);
      std::uint64_t here = 0;
      for (std::size_t i = run * kRun; i < end; ++i) {
        const float limited = std::clamp(values[i], -static_cast<float>(HALF_MAX), static_cast<float>(HALF_MAX));
        here += limited != values[i] ? 1U : 0U;
        halves[i] = half(limited);
      }
      clamped += here;
    });
    clamped_ += clamped;
    for (std::size_t c = 0; c < 3; ++c) {
      insert(names[c], Imf::HALF, reinterpret_cast<const char*>(&halves[c]), 3 * sizeof(half));
    }
  }

  WrittenFile write(const std::string& path, std::int32_t frame) {
    want_exr_threads(threads_);
    MemoryStream stream(path);
    try {
      Imf::OutputFile file(stream, header_, threads_ > 1 ? threads_ : 0);
      file.setFrameBuffer(buffer_);
      file.writePixels(height_px_);
    } catch (const std::exception& e) {
      throw Error(ErrorKind::runtime, path, std::string("cannot encode the EXR: ") + e.what());
    }
    return write_frame_file(path, frame, stream.bytes());
  }

 private:
  void insert(const std::string& name, Imf::PixelType type, const char* first, std::size_t stride) {
    header_.channels().insert(name, Imf::Channel(type));
    // OpenEXR only reads through this pointer, although its type is char*.
    buffer_.insert(name,
                   Imf::Slice(type, const_cast<char*>(first), stride, stride * static_cast<std::size_t>(width_px_)));
  }

  Imf::Header header_;
  Imf::FrameBuffer buffer_;
  std::deque<std::vector<half>> halves_;  // a deque, since the buffers must not move
  std::deque<ImageGray> constants_;
  int width_px_, height_px_, threads_;
  std::uint64_t clamped_ = 0;
};

void add_text(Imf::Header& header, const std::string& name, const std::string& value) {
  header.insert("gazetrace:" + name, Imf::StringAttribute(value));
}

void add_color_space(Imf::Header& header) {
  Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec.709 with D65
  header.insert("colorSpace", Imf::StringAttribute("lin_rec709"));
}

// From world space to the camera space of the EXR standard, which is left-handed with +z forward. Imath multiplies row
// vectors: p M.
Imath::M44d world_to_camera(const CameraPose& pose) {
  const Vec3d right = rotate(pose.orientation, {1, 0, 0});
  const Vec3d up = rotate(pose.orientation, {0, 1, 0});
  const Vec3d forward = rotate(pose.orientation, {0, 0, -1});
  const Vec3d& p = pose.position_m;
  return {right.x,        up.x,        forward.x,        0,  //
          right.y,        up.y,        forward.y,        0,  //
          right.z,        up.z,        forward.z,        0,  //
          -dot(right, p), -dot(up, p), -dot(forward, p), 1};
}

// From that camera space to NDC, with (0, 0) at the top left and (1, 1) at the bottom right. Depth, which the standard
// leaves open, is 0 at the near plane.
Imath::M44d camera_to_ndc(const Projection& projection, double aspect) {
  const double near_m = projection.near_m > 0 ? projection.near_m : 1e-3;
  if (projection.kind == ProjectionKind::orthographic) {
    return {0.5 / (projection.ymag_m * aspect),
            0,
            0,
            0,  //
            0,
            -0.5 / projection.ymag_m,
            0,
            0,  //
            0,
            0,
            1,
            0,  //
            0.5,
            0.5,
            -near_m,
            1};
  }
  const double slope = std::tan(projection.yfov_rad / 2);
  return {0.5 / (slope * aspect),
          0,
          0,
          0,  //
          0,
          -0.5 / slope,
          0,
          0,  //
          0.5,
          0.5,
          1,
          1,  //
          0,
          0,
          -near_m,
          0};
}

std::string camera_text(const Camera& camera) {
  const Vec3d& p = camera.pose.position_m;
  const Quatd& q = camera.pose.orientation;
  const Projection& projection = camera.projection;
  const std::string view = projection.kind == ProjectionKind::perspective
                               ? fmt::format("perspective yfov_rad={}", projection.yfov_rad)
                               : fmt::format("orthographic ymag_m={}", projection.ymag_m);
  const std::string lens = camera.lens.radius_m > 0 ? fmt::format(" aperture_radius_m={} focus_distance_m={}",
                                                                  camera.lens.radius_m, camera.lens.focus_distance_m)
                                                    : "";
  return fmt::format("position_m={},{},{} orientation_xyzw={},{},{},{} projection={} near_m={} far_m={}{}", p.x, p.y,
                     p.z, q.x, q.y, q.z, q.w, view, projection.near_m, projection.far_m, lens);
}

std::string gaze_header(const GazeAtTime& gaze) {
  return gaze_words(gaze) + " reason=" + gaze.reason;
}

void describe(Imf::Header& header, const FrameHeader& frame, double aspect) {
  add_color_space(header);
  header.insert("software", Imf::StringAttribute(frame.software));
  if (frame.fps.numerator <= std::numeric_limits<int>::max() &&
      frame.fps.denominator <= std::numeric_limits<int>::max()) {
    Imf::addFramesPerSecond(
        header, Imf::Rational(static_cast<int>(frame.fps.numerator), static_cast<int>(frame.fps.denominator)));
  }
  const Imath::M44d to_camera = world_to_camera(frame.camera.pose);
  Imf::addWorldToCamera(header, Imath::M44f(to_camera));
  Imf::addWorldToNDC(header, Imath::M44f(to_camera * camera_to_ndc(frame.camera.projection, aspect)));
  header.insert("gazetrace:frame", Imf::IntAttribute(frame.frame));
  header.insert("gazetrace:exposure_ev", Imf::DoubleAttribute(frame.exposure_ev));
  // Stored as text, since there is no attribute type for 64-bit integers.
  add_text(header, "t_video_ns", std::to_string(frame.t_video_ns));
  add_text(header, "seed", std::to_string(frame.seed));
  add_text(header, "settings_digest", frame.settings_digest);
  if (!frame.history.empty()) {
    add_text(header, "history", frame.history);
  }
  if (frame.enhance_contrast > 0) {
    add_text(header, "enhanced", fmt::format("contrast by {}: no estimate of radiance", frame.enhance_contrast));
  }
  add_text(header, "camera", camera_text(frame.camera));
  if (frame.shutter_close_ns > frame.shutter_open_ns) {
    add_text(header, "shutter_ns", fmt::format("{},{}", frame.shutter_open_ns, frame.shutter_close_ns));
  }
  add_text(header, "gaze_render", gaze_header(frame.gaze_render));
  add_text(header, "gaze_true", gaze_header(frame.gaze_true));
  if (!frame.gaze_processing.empty()) {
    add_text(header, "gaze_processing", fmt::format("{}", fmt::join(frame.gaze_processing, "; ")));
  }
}

std::array<std::string, 3> names_of(const std::string& layer, const char* letters) {
  return {layer + '.' + letters[0], layer + '.' + letters[1], layer + '.' + letters[2]};
}

void require(const std::string& aov, bool present) {
  if (!present) {
    throw Error(ErrorKind::usage, "", "AOV '" + aov + "' was asked for, but this frame does not have it",
                "trace with guides on");
  }
}

void add_aov(ExrPicture& picture, const std::string& aov, const Frame& frame, const ImageGray* eccentricity_deg) {
  if (aov == "albedo" || aov == "normal") {
    const ImageRgb& image = aov == "albedo" ? frame.albedo : frame.normal;
    require(aov, !image.empty());
    picture.add_half_rgb(names_of(aov, aov == "albedo" ? "RGB" : "XYZ"), image);
  } else if (aov == "depth") {
    require(aov, !frame.depth_m.empty());
    picture.add_float("depth.Z", frame.depth_m);
  } else if (aov == "samples") {
    picture.add_float("samples", frame.sample_count);
  } else if (aov == "variance") {
    picture.add_float("variance", frame.variance);
  } else if (aov == "eccentricity") {
    if (eccentricity_deg != nullptr) {
      picture.add_float("eccentricity", *eccentricity_deg);
    } else {
      // A frame without gaze has no eccentricity; the channel is written all the same, so that all frames of a sequence
      // have the same channels.
      picture.add_constant("eccentricity", std::numeric_limits<float>::quiet_NaN());
    }
  } else {
    throw Error(ErrorKind::usage, "", unknown_name_message("AOV", aov, aov_names()));
  }
}

// The pixels are only the claim of a header of a few bytes. Of black pictures a byte holds up to 170 pixels where the
// compression is lossless, and up to 2700 where it is dwaa or dwab.
void check_size(const Imf::InputFile& file, const std::string& path) {
  constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 30U;
  constexpr std::uint64_t kPixelsOfAnyFile = std::uint64_t{1} << 20U;
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  const bool is_dwa =
      file.header().compression() == Imf::DWAA_COMPRESSION || file.header().compression() == Imf::DWAB_COMPRESSION;
  std::error_code ignored;
  const std::uint64_t bytes = std::filesystem::file_size(path, ignored);
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixels > kMostPixels || ignored || pixels > kPixelsOfAnyFile + (is_dwa ? 8192 : 1024) * bytes) {
    throw Error(ErrorKind::input, path,
                fmt::format("an EXR of {} x {} pixels and {} bytes cannot be used", width, height, bytes),
                pixels > kMostPixels ? "make it smaller" : "it is damaged: export it again");
  }
}

// Opens an EXR and gives what `read` makes of it; what OpenEXR throws becomes Error(input).
template <class Read>
auto read_exr(const std::string& path, const Read& read) {
  if (!std::filesystem::exists(path)) {
    throw Error(ErrorKind::input, path, "there is no such file");
  }
  try {
    check_exr_header(path, path);
    Imf::InputFile file(path.c_str(), 0);
    check_size(file, path);
    return read(file);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::runtime, path, "there is no memory for the EXR", "make it smaller");
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, path, std::string("cannot read the EXR: ") + e.what());
  }
}

std::string gray_channel(const Imf::ChannelList& channels) {
  auto second = channels.begin();
  if (second != channels.end() && ++second == channels.end()) {
    return channels.begin().name();
  }
  for (const char* name : {"Y", "samples_per_pixel", "R"}) {
    if (channels.findChannel(name) != nullptr) {
      return name;
    }
  }
  return {};
}

}  // namespace

const std::vector<std::string>& exr_compression_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(kCompressions.size());
    for (const Compression& compression : kCompressions) {
      all.emplace_back(compression.name);
    }
    return all;
  }();
  return names;
}

WrittenExr write_frame_exr(const std::string& path, const Frame& frame, const ImageGray* eccentricity_deg,
                           const FrameHeader& header, const ExrSettings& settings, int threads) {
  ExrPicture picture(frame.radiance.width_px, frame.radiance.height_px, resolve_threads(threads));
  picture.header().compression() = compression_by_name(settings.compression);
  picture.header().zipCompressionLevel() = settings.zip_level;
  describe(picture.header(), header, static_cast<double>(frame.radiance.width_px) / frame.radiance.height_px);
  if (settings.pixels == ExrPixels::half) {
    picture.add_half_rgb({"R", "G", "B"}, frame.radiance);
  } else {
    picture.add_float_rgb({"R", "G", "B"}, frame.radiance);
  }
  for (const std::string& aov : settings.aovs) {
    add_aov(picture, aov, frame, eccentricity_deg);
  }
  WrittenFile file = picture.write(path, header.frame);
  return {picture.clamped(), std::move(file)};
}

WrittenFile write_sampling_map_exr(const std::string& path, const SamplingMap& map, const ImageGray* eccentricity_deg) {
  ImageGray region(map.width_px, map.height_px);
  std::copy(map.region.pixels.begin(), map.region.pixels.end(), region.pixels.begin());
  const ImageGray density = samples_per_pixel(map);
  ExrPicture picture(map.width_px, map.height_px, 1);
  picture.header().compression() = Imf::ZIP_COMPRESSION;
  for (std::size_t i = 0; i < map.regions.size(); ++i) {
    add_text(picture.header(), fmt::format("region_{}", i), map.regions[i].name);
  }
  picture.add_float("region", region);
  picture.add_float("samples_per_pixel", density);
  if (eccentricity_deg != nullptr) {
    picture.add_float("eccentricity", *eccentricity_deg);
  }
  return picture.write(path, 0);
}

ImageRgb read_exr_rgb(const std::string& path) {
  return read_exr(path, [&](Imf::InputFile& file) {
    const Imath::Box2i window = file.header().dataWindow();
    if (file.header().channels().findChannel("R") == nullptr) {
      throw Error(ErrorKind::input, path, "the EXR has no channel R", "name an RGB picture");
    }
    ImageRgb image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
    Imf::FrameBuffer buffer;
    constexpr std::array<const char*, 3> kNames{"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
      buffer.insert(kNames[c], Imf::Slice::Make(Imf::FLOAT, &image.pixels.data()->x + c, window, sizeof(Vec3f),
                                                sizeof(Vec3f) * static_cast<std::size_t>(image.width_px)));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return image;
  });
}

ImageGray read_exr_gray(const std::string& path) {
  return read_exr(path, [&](Imf::InputFile& file) {
    const Imath::Box2i window = file.header().dataWindow();
    const std::string name = gray_channel(file.header().channels());
    if (name.empty()) {
      throw Error(ErrorKind::input, path, "the EXR has several channels, and none of them is Y, samples_per_pixel or R",
                  "write a picture of one channel");
    }
    ImageGray image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
    Imf::FrameBuffer buffer;
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, image.pixels.data(), window, sizeof(float),
                                         sizeof(float) * static_cast<std::size_t>(image.width_px)));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return image;
  });
}

std::string read_exr_text(const std::string& path, const std::string& attribute) {
  try {
    check_exr_header(path, path);
    Imf::InputFile file(path.c_str(), 0);
    const auto* text = file.header().findTypedAttribute<Imf::StringAttribute>(attribute);
    if (text == nullptr || !file.isComplete()) {
      return {};
    }
    // A truncated copy still has its table of offsets, so the last block, at the end of the file, is read.
    const char* pixels = nullptr;
    int size = 0;
    file.rawPixelData(file.header().dataWindow().max.y, pixels, size);
    return text->value();
  } catch (const std::exception&) {
    return {};
  }
}

std::optional<double> read_exr_number(const std::string& path, const std::string& attribute) {
  try {
    check_exr_header(path, path);
    Imf::InputFile file(path.c_str(), 0);
    if (const auto* number = file.header().findTypedAttribute<Imf::DoubleAttribute>(attribute)) {
      return number->value();
    }
    if (const auto* fraction = file.header().findTypedAttribute<Imf::RationalAttribute>(attribute)) {
      return static_cast<double>(fraction->value());
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return std::nullopt;
}

std::optional<std::int32_t> read_exr_integer(const std::string& path, const std::string& attribute) {
  try {
    check_exr_header(path, path);
    Imf::InputFile file(path.c_str(), 0);
    if (const auto* number = file.header().findTypedAttribute<Imf::IntAttribute>(attribute)) {
      return number->value();
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace gazetrace
