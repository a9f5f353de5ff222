// SPDX-License-Identifier: Apache-2.0
// The history in a file: a line of text that says what it is, then every number as it stands in memory, then a digest.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <type_traits>
#include <vector>

#include "core/hash.hpp"
#include "gazetrace/pipeline.hpp"
#include "output/atomic_file.hpp"

namespace gazetrace {
namespace {

constexpr char kMagic[] = "gazetrace history 1, ";
constexpr std::size_t kDigestLength = 32;
constexpr std::uint32_t kByteOrder = 0x01020304;

// Writes and reads go through the same list of fields, `each_field`, so that they cannot differ.
class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(T));
  }
  template <class T>
  void operator()(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    (*this)(static_cast<std::uint64_t>(values.size()));
    const auto* from = reinterpret_cast<const std::byte*>(values.data());
    bytes.insert(bytes.end(), from, from + values.size() * sizeof(T));
  }
  template <class T>
  void operator()(const Image<T>& image) {
    (*this)(image.width_px);
    (*this)(image.height_px);
    (*this)(image.pixels);
  }

  std::vector<std::byte> bytes;
};

class Reader {
 public:
  Reader(const std::string& path, const std::byte* begin, const std::byte* end) : path_(path), at_(begin), end_(end) {}

  template <class T>
  void operator()(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    take(&value, sizeof(T));
  }
  template <class T>
  void operator()(std::vector<T>& values) {
    std::uint64_t count = 0;
    (*this)(count);
    if (count > static_cast<std::uint64_t>(end_ - at_) / sizeof(T)) {
      fail();
    }
    values.resize(count);
    take(values.data(), values.size() * sizeof(T));
  }
  template <class T>
  void operator()(Image<T>& image) {
    (*this)(image.width_px);
    (*this)(image.height_px);
    (*this)(image.pixels);
    if (image.width_px < 0 || image.height_px < 0 ||
        image.pixels.size() != static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px)) {
      fail();
    }
  }
  [[nodiscard]] bool at_end() const { return at_ == end_; }
  [[noreturn]] void fail() const {
    throw Error(ErrorKind::input, path_, "the checkpoint is damaged", "render from the beginning, or with --preroll");
  }

 private:
  void take(void* to, std::size_t size) {
    if (size > static_cast<std::size_t>(end_ - at_)) {
      fail();
    }
    if (size > 0) {
      std::memcpy(to, at_, size);
    }
    at_ += size;
  }

  const std::string& path_;
  const std::byte* at_;
  const std::byte* end_;
};

template <class History, class Visit>
void each_field(History& history, bool& has_camera, bool& has_ev, auto& camera, auto& ev, const Visit& visit) {
  visit(history.radiance_sum);
  visit(history.count_sum);
  visit(history.variance_weight_sum);
  visit(history.surfaces.depth_m);
  visit(history.surfaces.normal);
  visit(history.surfaces.object);
  visit(history.surfaces.footprint_px);
  visit(history.t_video_ns);
  visit(history.frames);
  visit(history.last_frame);
  visit(has_camera);
  visit(camera.pose);
  visit(camera.projection.kind);
  visit(camera.projection.yfov_rad);
  visit(camera.projection.ymag_m);
  visit(camera.projection.near_m);
  visit(camera.projection.far_m);
  visit(camera.lens);
  visit(camera.shutter_poses);
  visit(has_ev);
  visit(ev);
  visit(history.smoothed_ev_t_ns);
}

std::string digest_of(const std::byte* begin, std::size_t size) {
  Digest digest;
  digest.add({reinterpret_cast<const char*>(begin), size});
  return digest.hex();
}

void append(std::vector<std::byte>& bytes, const std::string& text) {
  const auto* from = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), from, from + text.size());
}

}  // namespace

void save_checkpoint(const std::string& path, const TemporalHistory& history, const std::string& history_digest) {
  Writer writer;
  append(writer.bytes, kMagic + history_digest + "\n");
  writer(kByteOrder);
  bool has_camera = history.camera.has_value();
  bool has_ev = history.smoothed_ev.has_value();
  const Camera camera = history.camera.value_or(Camera{});
  const double ev = history.smoothed_ev.value_or(0);
  each_field(history, has_camera, has_ev, camera, ev, [&](const auto& field) { writer(field); });
  append(writer.bytes, digest_of(writer.bytes.data(), writer.bytes.size()));
  write_bytes_atomically(path, writer.bytes);
}

TemporalHistory load_checkpoint(const std::string& path, const std::string& history_digest) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, path, "cannot be opened", "check the path of --resume-from");
  }
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t line = text.find('\n');
  if (!text.starts_with(kMagic) || line == std::string::npos) {
    throw Error(ErrorKind::input, path, "is no checkpoint of this version of gazetrace",
                "give the file that --checkpoint wrote");
  }
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  Reader reader(path, begin + line + 1, begin + text.size() - std::min(kDigestLength, text.size() - line - 1));
  if (text.size() < line + 1 + kDigestLength ||
      digest_of(begin, text.size() - kDigestLength) != text.substr(text.size() - kDigestLength)) {
    reader.fail();
  }
  const std::string made_under = text.substr(std::strlen(kMagic), line - std::strlen(kMagic));
  if (made_under != history_digest) {
    throw Error(ErrorKind::input, path, "was made under other settings or from other files",
                "render with the same options, or with --preroll");
  }
  std::uint32_t order = 0;
  reader(order);
  TemporalHistory history;
  bool has_camera = false;
  bool has_ev = false;
  Camera camera;
  double ev = 0;
  each_field(history, has_camera, has_ev, camera, ev, [&](auto& field) { reader(field); });
  if (order != kByteOrder || !reader.at_end()) {
    reader.fail();
  }
  if (has_camera) {
    history.camera = camera;
  }
  if (has_ev) {
    history.smoothed_ev = ev;
  }
  return history;
}

}  // namespace gazetrace
