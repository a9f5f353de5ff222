// SPDX-License-Identifier: Apache-2.0
// LSL's XDF: the stream of type Gaze (Eyetracker, EyeTracking). Channels are told by their labels and, where given, by
// the XDF gaze metadata (type ScreenX, DirectionX, eye left or right, unit); files without labels are refused, for
// conventions differ. Times are doubles in the file itself.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <pugixml.hpp>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/recordings.hpp"
#include "gazelog/units.hpp"
#include "gazelog/xdf_file.hpp"

namespace gazetrace {
namespace {

struct Channel {
  std::string label, unit, type;
  Eye eye = Eye::cyclopean;
  bool is_in_camera = false;  // a place on the picture of a camera on the head
};

struct GazeChannels {
  Eye eye = Eye::cyclopean;
  std::array<std::optional<std::size_t>, 3> at;  // x, y or x, y, z
  std::optional<std::size_t> confidence, pupil;
  bool is_direction = false, is_scene_camera = false, is_point = false;
};

pugi::xml_document header_of(const XdfStream& stream) {
  pugi::xml_document xml;
  xml.load_buffer(stream.header.data(), stream.header.size());
  return xml;
}

void read_header(XdfStream& stream) {
  const pugi::xml_document xml = header_of(stream);
  const pugi::xml_node info = xml.child("info");
  const unsigned channels = info.child("channel_count").text().as_uint();
  stream.channels = channels < 100'000 ? channels : 0;
  stream.channel_format = info.child("channel_format").text().as_string();
  const double rate = number_from(trim(info.child("nominal_srate").text().as_string())).value_or(0);
  stream.nominal_rate_hz = rate > 0 && rate < 1e6 ? rate : 0;
}

std::vector<Channel> channels_of(const XdfStream& stream, const std::string& path) {
  const pugi::xml_document xml = header_of(stream);
  std::vector<Channel> channels;
  for (const pugi::xml_node node : xml.child("info").child("desc").child("channels").children("channel")) {
    Channel channel{node.child("label").text().as_string(), node.child("unit").text().as_string(),
                    letters_and_digits(node.child("type").text().as_string())};
    const std::string eye = to_lower(node.child("eye").text().as_string());
    const std::string label = to_lower(channel.label);
    const auto says = [&](std::string_view side) { return eye == side || label.find(side) != std::string::npos; };
    // Pupil Labs' relays call the scene camera's picture the world.
    const std::string space = to_lower(node.child("coordinate_system").text().as_string());
    channel.is_in_camera = space.find("world") != std::string::npos || space.find("scene") != std::string::npos;
    channel.eye = says("left") ? Eye::left : says("right") ? Eye::right : Eye::cyclopean;
    channels.push_back(std::move(channel));
  }
  if (channels.size() > stream.channels) {
    throw Error(ErrorKind::input, path,
                fmt::format("its header names {} channels and counts {}", channels.size(), stream.channels));
  }
  return channels;
}

bool is_gaze(const XdfStream& stream) {
  const pugi::xml_document xml = header_of(stream);
  const std::string type = letters_and_digits(xml.child("info").child("type").text().as_string());
  return type == "gaze" || type == "eyetracker" || type == "eyetracking";
}

std::string core_of(std::string_view label) {
  std::string core = letters_and_digits(label);
  for (const std::string_view side : {"left", "right", "eye", "both"}) {
    if (const std::size_t at = core.find(side); at != std::string::npos) {
      core.erase(at, side.size());
    }
  }
  return core;
}

constexpr std::size_t kNoRole = 5;
// 0 x, 1 y, 2 z; 3 confidence, 4 pupil.
struct Role {
  std::size_t index = kNoRole;
  bool is_direction = false, is_scene_camera = false, is_point = false;

  // Places and directions, or places of two pictures, are never mixed in one gaze.
  [[nodiscard]] bool goes_with(const GazeChannels& gaze) const {
    const bool is_first = !gaze.at[0] && !gaze.at[1] && !gaze.at[2];
    return is_first ||
           (is_direction == gaze.is_direction && is_scene_camera == gaze.is_scene_camera && is_point == gaze.is_point);
  }
};

Role role_of(const Channel& channel) {
  const std::string core = core_of(channel.label);
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string axis(kAxes[i]);
    if (core == "gazepoint3d" + axis) {
      return Role{i, true, false, true};
    }
    if (channel.type == "direction" + axis || core == "direction" + axis || core == "gazedirection" + axis ||
        core == "d" + axis) {
      return Role{i, true, false};
    }
    if (i == 2) {
      break;
    }
    if (core == "normpos" + axis) {
      return Role{i, false, true};
    }
    for (const std::string_view stem : {"screen", "gaze", "", "gazepoint", "gazepointondisplayarea", "por", "pos"}) {
      if (channel.type == "screen" + axis || core == std::string(stem) + axis) {
        return Role{i, false, channel.is_in_camera};
      }
    }
  }
  if (core == "confidence" || channel.type == "confidence") {
    return Role{3, false, false};
  }
  if (core == "pupil" || core == "pupilsize" || core == "pupildiameter" || core == "diameter") {
    return Role{4, false, false};
  }
  return {};
}

std::vector<GazeChannels> find_gazes(const std::vector<Channel>& channels, const GazeReadOptions& options,
                                     const std::string& path) {
  std::array<GazeChannels, 3> by_eye;
  // Of Pupil Capture's gaze, directions where the user asks for them.
  const bool has_picture = std::any_of(channels.begin(), channels.end(),
                                       [](const Channel& channel) { return role_of(channel).is_scene_camera; });
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Channel channel = channels[c];
    GazeChannels& gaze = by_eye[static_cast<std::size_t>(channel.eye)];
    gaze.eye = channel.eye;
    Role role = role_of(channel);
    if (has_picture && options.columns.x.empty() &&
        (options.frame == GazeFrame::head ? role.is_scene_camera : role.is_point)) {
      role = {};
    }
    for (const auto& [declared, axis] :
         {std::pair(&options.columns.x, 0U), std::pair(&options.columns.y, 1U), std::pair(&options.columns.z, 2U)}) {
      if (!declared->empty()) {
        if (*declared == channel.label) {
          role = Role{axis, !options.columns.z.empty(), channel.is_in_camera && options.columns.z.empty()};
        } else if (role.index == axis) {
          role = {};
        }
      }
    }
    if (role.index < 3 && !gaze.at[role.index] && role.goes_with(gaze)) {
      gaze.at[role.index] = c;
      gaze.is_direction = role.is_direction;
      gaze.is_scene_camera = role.is_scene_camera;
      gaze.is_point = role.is_point;
    } else if (role.index == 3) {
      gaze.confidence = c;
    } else if (role.index == 4) {
      gaze.pupil = c;
    }
  }
  std::vector<GazeChannels> gazes;
  for (const Eye eye : {Eye::cyclopean, Eye::left, Eye::right}) {
    const GazeChannels& gaze = by_eye[static_cast<std::size_t>(eye)];
    if (gaze.at[0] && gaze.at[1] && (!gaze.is_direction || gaze.at[2]) &&
        (gazes.empty() || gazes.front().is_direction == gaze.is_direction)) {
      gazes.push_back(gaze);
    }
  }
  if (gazes.empty()) {
    std::string labels;
    for (const Channel& channel : channels) {
      labels += (labels.empty() ? "" : ", ") + channel.label;
    }
    throw Error(ErrorKind::input, path,
                labels.empty() ? "the gaze stream's channels have no labels"
                               : fmt::format("no channels of gaze x and y among: {}", labels.substr(0, 300)),
                "name them with `x-column` and `y-column`");
  }
  return gazes;
}

// Those with samples, in the order of the file.
std::vector<const XdfStream*> gaze_streams(const std::vector<XdfStream>& streams, const std::string& path) {
  std::vector<const XdfStream*> found;
  for (const XdfStream& stream : streams) {
    if (is_gaze(stream) && stream.channel_format != "string" && (!stream.times_s.empty() || found.empty())) {
      found.push_back(&stream);
    }
  }
  if (found.size() > 1 && found.front()->times_s.empty()) {
    found.erase(found.begin());
  }
  if (found.empty()) {
    throw Error(ErrorKind::input, path,
                fmt::format("none of its {} streams is of type Gaze, Eyetracker or EyeTracking", streams.size()));
  }
  return found;
}

// One gaze out of the values of a sample, one for each channel.
RawSample sample_of(const double* values, const GazeChannels& gaze, std::int64_t t_ns, std::int64_t row) {
  RawSample sample = missing_row(t_ns, row, gaze.eye);
  const auto value = [&](const std::optional<std::size_t>& c) { return c ? values[*c] : kNan; };
  if (gaze.is_direction) {
    sample.at = {value(gaze.at[0]), value(gaze.at[1]), value(gaze.at[2])};
    sample.validity = is_finite(sample.at) ? GazeValidity::ok : GazeValidity::lost;
  } else if (const double x = value(gaze.at[0]), y = value(gaze.at[1]); std::isfinite(x) && std::isfinite(y)) {
    sample.at.x = x;
    sample.at.y = y;
    sample.validity = GazeValidity::ok;
  }
  sample.confidence = static_cast<float>(value(gaze.confidence));
  sample.pupil = static_cast<float>(value(gaze.pupil));
  return sample;
}

// Samples are numbered through the streams, from `first_row` on.
void read_samples(RawGaze& raw, const XdfStream& stream, const std::vector<GazeChannels>& gazes, double least,
                  std::int64_t first_row, const std::string& path) {
  const std::vector<double> times_s = synchronized_times_s(stream);
  if (stream.values.size() / stream.channels != times_s.size()) {
    throw Error(ErrorKind::input, path,
                fmt::format("its gaze stream has {} values for {} samples of {} channels", stream.values.size(),
                            times_s.size(), stream.channels),
                "record or export it again");
  }
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const double* const values = stream.values.data() + i * stream.channels;
    const double t_ns = times_s[i] * 1e9;
    if (!(std::abs(t_ns) < 9e18)) {
      throw Error(ErrorKind::input, path, fmt::format("time {} s of sample {} is no time", times_s[i], i + 1));
    }
    for (const GazeChannels& gaze : gazes) {
      RawSample sample = sample_of(values, gaze, std::llround(t_ns), first_row + static_cast<std::int64_t>(i));
      if (sample.confidence < least && is_usable(sample.validity)) {
        sample.validity = sample.confidence > 0 ? GazeValidity::low_confidence : GazeValidity::lost;
      }
      raw.rows.push_back(sample);
    }
  }
}

// Declares how the rows are meant, of which `gaze` is the first kind.
void declare_gaze(RawGaze& raw, const GazeChannels& gaze, const std::vector<Channel>& channels,
                  const GazeReadOptions& options, const std::string& path) {
  const std::string columns = channels[*gaze.at[0]].label + ", " + channels[*gaze.at[1]].label;
  if (gaze.is_direction) {
    const bool is_declared = options.columns.axes != GazeAxes::automatic;
    raw.are_points = gaze.is_point;
    declare_directions(raw, {columns, Evidence::header}, gaze.is_point ? GazeAxes::cv : GazeAxes::gl,
                       gaze.is_point || is_declared ? Evidence::format : Evidence::statistics, path);
    return;
  }
  PlaceSpace space{PositionUnit::fraction,
                   gaze.is_scene_camera ? PositionOrigin::bottom_left : PositionOrigin::top_left, Evidence::header,
                   columns};
  if (const auto unit = position_unit_from(channels[*gaze.at[0]].unit)) {
    space.unit = *unit;
    space.origin = *unit == PositionUnit::deg  ? PositionOrigin::center
                   : *unit == PositionUnit::px ? PositionOrigin::top_left
                                               : space.origin;
    if (gaze.is_scene_camera && *unit == PositionUnit::px) {
      guess_picture_size(raw);
    }
  } else if (!gaze.is_scene_camera) {
    space.unit = PositionUnit::automatic;
    space.origin = PositionOrigin::automatic;
    raw.directions_grow_up = options.columns.origin != PositionOrigin::top_left;  // that origin is a guess, too
    raw.is_own_table = true;
  }
  declare_places(raw, space, path);
}

}  // namespace

double sniff_gaze_xdf(const GazeFile& file) {
  return file.text.starts_with("XDF:") ? 0.99 : 0.0;
}

RawGaze read_gaze_xdf(const GazeFile& file, const GazeReadOptions& options) {
  RawGaze raw = raw_of(file, "LSL");
  const std::vector<XdfStream> streams = read_xdf(file.text, file.path, raw.damages, read_header);
  const std::vector<const XdfStream*> all = gaze_streams(streams, file.path);
  const XdfStream& stream = *all.front();
  const std::vector<Channel> channels = channels_of(stream, file.path);
  const std::vector<GazeChannels> gazes = find_gazes(channels, options, file.path);
  const GazeChannels& first = gazes.front();
  if (first.is_scene_camera) {
    raw.way_out = "stream gaze on a surface, or look at it with `frame` scene-camera";
  }
  raw.kind = first.is_direction      ? GazeKind::direction
             : first.is_scene_camera ? GazeKind::scene_camera
                                     : GazeKind::screen;
  raw.nominal_rate_hz = stream.nominal_rate_hz;
  raw.declared.time_exponent = {9, Evidence::format, "doubles in the file, on the recorder's clock"};
  const double least = least_confidence(options, first.is_scene_camera || first.is_point ? 0.6 : 1e-9);
  std::int64_t first_row = 1;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const XdfStream* const one = all[i];
    if (all.size() > 1) {
      begin_recording(raw, fmt::format("stream {}", i + 1), first_row);
    }
    read_samples(raw, *one, one == &stream ? gazes : find_gazes(channels_of(*one, file.path), options, file.path),
                 least, first_row, file.path);
    first_row += static_cast<std::int64_t>(one->times_s.size());
  }
  declare_gaze(raw, first, channels, options, file.path);
  return raw;
}

}  // namespace gazetrace
