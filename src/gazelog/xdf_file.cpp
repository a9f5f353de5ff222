// SPDX-License-Identifier: Apache-2.0
#include "gazelog/xdf_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gazetrace {
namespace {

constexpr std::string_view kBoundary = "\x43\xA5\x46\xDC\xCB\xF5\x41\x0F\xB3\x0E\xD5\x46\x73\x83\xCB\xE4";
enum : std::uint16_t { stream_header = 2, samples = 3, clock_offset = 4 };

// Reads little-endian values from the front; every read returns whether there were enough bytes.
class Bytes {
 public:
  explicit Bytes(std::string_view rest) : rest_(rest) {}

  template <class Value>
  bool take(Value& value) {
    if (rest_.size() < sizeof(Value)) {
      return false;
    }
    value = little_endian<Value>(rest_.data());
    rest_.remove_prefix(sizeof(Value));
    return true;
  }
  // A byte with the value 1, 4 or 8, followed by a number of that many bytes.
  bool take_length(std::uint64_t& length) {
    std::uint8_t size = 0;
    std::string_view digits;
    if (!take(size) || (size != 1 && size != 4 && size != 8) || !take_text(size, digits)) {
      return false;
    }
    length = 0;
    for (std::size_t i = size; i-- > 0;) {
      length = length << 8U | static_cast<unsigned char>(digits[i]);
    }
    return true;
  }
  bool take_text(std::uint64_t length, std::string_view& text) {
    if (length > rest_.size()) {
      return false;
    }
    text = rest_.substr(0, static_cast<std::size_t>(length));
    rest_.remove_prefix(static_cast<std::size_t>(length));
    return true;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

template <class Value>
bool take_as_double(Bytes& bytes, double& number) {
  Value value{};
  const bool good = bytes.take(value);
  number = static_cast<double>(value);
  return good;
}

bool take_value(Bytes& bytes, const std::string& format, double& value) {
  using Take = bool (*)(Bytes&, double&);
  static constexpr std::array<std::pair<std::string_view, Take>, 6> kFormats{{{"float32", take_as_double<float>},
                                                                              {"double64", take_as_double<double>},
                                                                              {"int8", take_as_double<std::int8_t>},
                                                                              {"int16", take_as_double<std::int16_t>},
                                                                              {"int32", take_as_double<std::int32_t>},
                                                                              {"int64", take_as_double<std::int64_t>}}};
  for (const auto& [name, take] : kFormats) {
    if (format == name) {
      return take(bytes, value);
    }
  }
  return false;
}

bool read_samples(Bytes& bytes, XdfStream& stream) {
  std::uint64_t count = 0;
  if (!bytes.take_length(count)) {
    return false;
  }
  const bool is_text = stream.channel_format == "string";
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint8_t stamp_bytes = 0;
    if (!bytes.take(stamp_bytes)) {
      return false;
    }
    // Without a stamp it is the last stamp plus one period.
    double time = stream.times_s.empty() ? 0 : stream.times_s.back();
    time += stream.nominal_rate_hz > 0 ? 1 / stream.nominal_rate_hz : 0;
    if (stamp_bytes == 8 && !bytes.take(time)) {
      return false;
    }
    const std::size_t kept = stream.values.size();
    for (std::size_t c = 0; c < stream.channels; ++c) {
      double value = 0;
      std::uint64_t length = 0;
      std::string_view text;
      const bool good = is_text ? bytes.take_length(length) && bytes.take_text(length, text)
                                : take_value(bytes, stream.channel_format, value);
      if (!good) {
        stream.values.resize(kept);
        return false;
      }
      if (!is_text) {
        stream.values.push_back(value);
      }
    }
    stream.times_s.push_back(time);
  }
  return true;
}

XdfStream& stream_of(std::vector<XdfStream>& streams, std::uint32_t id) {
  const auto found = std::find_if(streams.begin(), streams.end(), [&](const XdfStream& s) { return s.id == id; });
  if (found != streams.end()) {
    return *found;
  }
  streams.emplace_back();
  streams.back().id = id;
  return streams.back();
}

bool read_chunk(std::uint16_t tag, Bytes content, std::vector<XdfStream>& streams,
                void (*read_header)(XdfStream& stream)) {
  if (tag != stream_header && tag != samples && tag != clock_offset) {
    return true;
  }
  std::uint32_t id = 0;
  if (!content.take(id)) {
    return false;
  }
  XdfStream& stream = stream_of(streams, id);
  if (tag == stream_header) {
    // Samples that were read already are stored as the first header says. Another one is damage, and the same one again
    // says nothing new.
    if (!stream.header.empty()) {
      return stream.header == content.rest();
    }
    stream.header = content.rest();
    read_header(stream);
    return true;
  }
  if (tag == samples) {
    return !stream.header.empty() && read_samples(content, stream);
  }
  XdfClockOffset offset;
  if (!content.take(offset.time_s) || !content.take(offset.offset_s)) {
    return false;
  }
  if (std::isfinite(offset.time_s) && std::isfinite(offset.offset_s)) {
    stream.offsets.push_back(offset);
  }
  return true;
}

struct Line {
  double at = 0, offset = 0, slope = 0;
  [[nodiscard]] double value(double t) const { return offset + slope * (t - at); }
};

// Iteratively reweighted least squares, so that delayed exchanges count little (Huber, 1.345 robust deviations).
Line fit(const XdfClockOffset* begin, const XdfClockOffset* end) {
  const auto count = static_cast<std::size_t>(end - begin);
  std::vector<double> weights(count, 1.0);
  Line line;
  for (int round = 0; round < 20; ++round) {
    double w = 0;
    double t = 0;
    double o = 0;
    for (std::size_t i = 0; i < count; ++i) {
      w += weights[i];
      t += weights[i] * begin[i].time_s;
      o += weights[i] * begin[i].offset_s;
    }
    line.at = t / w;
    line.offset = o / w;
    double tt = 0;
    double to = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double dt = begin[i].time_s - line.at;
      tt += weights[i] * dt * dt;
      to += weights[i] * dt * (begin[i].offset_s - line.offset);
    }
    line.slope = tt > 0 && count > 2 ? to / tt : 0;
    std::vector<double> residuals(count);
    for (std::size_t i = 0; i < count; ++i) {
      residuals[i] = std::abs(begin[i].offset_s - line.value(begin[i].time_s));
    }
    std::vector<double> sorted = residuals;
    std::sort(sorted.begin(), sorted.end());
    const double limit = 1.345 * 1.4826 * sorted[count / 2];
    for (std::size_t i = 0; i < count; ++i) {
      weights[i] = residuals[i] > limit && limit > 0 ? limit / residuals[i] : 1.0;
    }
  }
  return line;
}

void add_offsets(const XdfStream& stream, std::vector<double>& times_s) {
  constexpr double kResetSeconds = 5;
  if (stream.offsets.empty()) {
    return;
  }
  std::size_t begin = 0;
  std::size_t done = 0;
  for (std::size_t i = 1; i <= stream.offsets.size(); ++i) {
    const bool ends = i == stream.offsets.size();
    if (!ends && std::abs(stream.offsets[i].offset_s - stream.offsets[i - 1].offset_s) < kResetSeconds &&
        stream.offsets[i].time_s >= stream.offsets[i - 1].time_s) {
      continue;
    }
    const Line line = fit(stream.offsets.data() + begin, stream.offsets.data() + i);
    // Samples up to halfway to where the next clock begins.
    const double until = ends ? 0 : 0.5 * (stream.offsets[i - 1].time_s + stream.offsets[i].time_s);
    const bool forwards = !ends && stream.offsets[i].time_s > stream.offsets[i - 1].time_s;
    double before = done < times_s.size() ? times_s[done] : 0;
    while (done < times_s.size()) {
      const double t = times_s[done];
      if (!ends && (forwards ? t > until : t < before - kResetSeconds)) {
        break;
      }
      before = t;
      times_s[done++] = t + line.value(t);
    }
    begin = i;
  }
}

void even_out(const XdfStream& stream, std::vector<double>& times_s) {
  constexpr double kBreakSeconds = 1;
  constexpr double kBreakSamples = 500;
  if (!(stream.nominal_rate_hz > 0)) {
    return;
  }
  const double gap = std::max(kBreakSeconds, kBreakSamples / stream.nominal_rate_hz);
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= times_s.size(); ++i) {
    if (i < times_s.size() && std::abs(times_s[i] - times_s[i - 1]) <= gap) {
      continue;
    }
    const auto n = static_cast<double>(i - begin);
    const double middle = 0.5 * (n - 1);
    double sum = 0;
    for (std::size_t k = begin; k < i; ++k) {
      sum += times_s[k] - times_s[begin];
    }
    const double mean = sum / n;
    double along = 0;
    for (std::size_t k = begin; k < i; ++k) {
      along += (static_cast<double>(k - begin) - middle) * (times_s[k] - times_s[begin] - mean);
    }
    const double slope = n > 1 ? along / (n * (n * n - 1) / 12) : 0;
    const double first = times_s[begin];
    for (std::size_t k = begin; k < i; ++k) {
      times_s[k] = first + mean + slope * (static_cast<double>(k - begin) - middle);
    }
    begin = i;
  }
}

}  // namespace

std::vector<XdfStream> read_xdf(std::string_view bytes, const std::string& path, Warnings& damages,
                                void (*read_header)(XdfStream& stream)) {
  std::vector<XdfStream> streams;
  std::string_view rest = bytes.substr(std::min<std::size_t>(4, bytes.size()));  // "XDF:"
  std::size_t damaged = 0;
  while (!rest.empty()) {
    Bytes at(rest);
    std::uint64_t length = 0;
    std::uint16_t tag = 0;
    std::string_view content;
    const bool whole = at.take_length(length) && length >= 2 && at.take(tag) && at.take_text(length - 2, content);
    if (whole && tag >= 1 && tag <= 6) {
      damaged += read_chunk(tag, Bytes(content), streams, read_header) ? 0 : 1;
      rest = at.rest();
      continue;
    }
    ++damaged;
    const std::size_t boundary = rest.find(kBoundary);
    if (boundary == std::string_view::npos) {
      break;
    }
    rest.remove_prefix(boundary + kBoundary.size());
  }
  if (damaged > 0) {
    damages.push_back(fmt::format("{}: {} damaged or cut off {}; the readable part is used", path, damaged,
                                  damaged == 1 ? "chunk" : "chunks"));
  }
  return streams;
}

std::vector<double> synchronized_times_s(const XdfStream& stream) {
  std::vector<double> times_s = stream.times_s;
  add_offsets(stream, times_s);
  even_out(stream, times_s);
  return times_s;
}

}  // namespace gazetrace
