// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/animation.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "gazetrace/error.hpp"
#include "scene/gltf/accessor.hpp"

namespace gazetrace {
namespace {

// From the first key to the last there must be less than the 9.2e9 s that int64 nanoseconds reach.
constexpr double kMaxTimeS = 4.6e9;

std::string animation_place(const GltfDocument& document, std::size_t animation, int sampler) {
  return document.path + ": animations[" + std::to_string(animation) + "].samplers[" + std::to_string(sampler) + "]";
}

std::vector<std::int64_t> read_times(const GltfDocument& document, int accessor, const std::string& place) {
  std::vector<std::int64_t> times_ns;
  for (const float time_s : read_floats(document, accessor, 1, place)) {
    if (std::abs(static_cast<double>(time_s)) > kMaxTimeS) {
      throw Error(ErrorKind::input, place, "a key time of " + std::to_string(time_s) + " s is out of range");
    }
    times_ns.push_back(std::llround(static_cast<double>(time_s) * 1e9));
    // Two keys of one time are a jump from one value to the other.
    if (times_ns.size() > 1 && times_ns.back() < times_ns[times_ns.size() - 2]) {
      throw Error(ErrorKind::input, place,
                  "key " + std::to_string(times_ns.size() - 1) + " is before the one in front of it",
                  "export the file again");
    }
  }
  return times_ns;
}

KeyInterpolation read_interpolation(const GltfAnimation::Sampler& sampler, const std::string& place) {
  if (sampler.interpolation == "STEP") {
    return KeyInterpolation::step;
  }
  if (sampler.interpolation == "CUBICSPLINE") {
    return KeyInterpolation::cubic_spline;
  }
  if (sampler.interpolation != "LINEAR") {
    throw Error(ErrorKind::input, place, "interpolation '" + sampler.interpolation + "' does not exist",
                "use STEP, LINEAR or CUBICSPLINE");
  }
  return KeyInterpolation::linear;
}

// The times and numbers of all keyframes. Each has `width` values of `components` numbers, or three times as many for
// splines.
struct RawTrack {
  KeyInterpolation interpolation = KeyInterpolation::linear;
  std::vector<std::int64_t> times_ns;
  std::vector<float> values;
};

RawTrack read_raw_track(const GltfDocument& document, std::size_t animation, int sampler_index, int components,
                        std::size_t width, Warnings& warnings) {
  const auto& sampler = document.animations[animation].samplers[static_cast<std::size_t>(sampler_index)];
  const std::string place = animation_place(document, animation, sampler_index);
  RawTrack track;
  track.interpolation = read_interpolation(sampler, place);
  track.times_ns = read_times(document, sampler.input, place + ".input");
  const auto same = std::adjacent_find(track.times_ns.begin(), track.times_ns.end());
  if (same != track.times_ns.end()) {
    warnings.push_back(place + ".input: key " + std::to_string(same - track.times_ns.begin() + 1) +
                       " has the time of the one before it; its target jumps there");
  }
  track.values = read_floats(document, sampler.output, components, place + ".output");
  const std::size_t a_key = (track.interpolation == KeyInterpolation::cubic_spline ? 3 : 1) * width;
  const std::size_t given = track.values.size() / static_cast<std::size_t>(components);
  if (given != track.times_ns.size() * a_key) {
    throw Error(ErrorKind::input, place + ".output",
                std::to_string(given) + " values for " + std::to_string(track.times_ns.size()) + " keys, " +
                    std::to_string(track.times_ns.size() * a_key) + " are needed",
                "export the file again");
  }
  return track;
}

KeyTrack read_track(const GltfDocument& document, std::size_t animation, int sampler, int components,
                    Warnings& warnings) {
  RawTrack raw = read_raw_track(document, animation, sampler, components, 1, warnings);
  KeyTrack track{raw.interpolation, std::move(raw.times_ns), {}};
  const auto width = static_cast<std::size_t>(components);
  for (std::size_t i = 0; i < raw.values.size(); i += width) {
    const float* v = &raw.values[i];
    track.values.push_back({v[0], v[1], v[2], components == 4 ? v[3] : 0.0});
  }
  return track;
}

bool moves_nodes(const std::string& path) {
  return path == "translation" || path == "rotation" || path == "scale";
}

AnimatedNode rest_of(const GltfNode& node) {
  AnimatedNode result;
  result.has_matrix = node.has_matrix;
  result.matrix = node.matrix;
  result.translation = node.translation;
  result.rotation = node.rotation;
  result.scale = node.scale;
  return result;
}

bool moves_any(const GltfAnimation::Channel& channel, const std::vector<int>& chain) {
  return moves_nodes(channel.path) && std::find(chain.begin(), chain.end(), channel.node) != chain.end();
}

// The first animation with such a channel. A second animation is an alternative, so the two are not combined.
template <class Wanted>
std::optional<std::size_t> first_animation(const GltfDocument& document, const Wanted& wanted, const std::string& what,
                                           Warnings& warnings) {
  std::optional<std::size_t> chosen;
  for (std::size_t a = 0; a < document.animations.size(); ++a) {
    const auto& channels = document.animations[a].channels;
    const bool moves = std::any_of(channels.begin(), channels.end(), wanted);
    if (moves && chosen) {
      warnings.push_back(what + " is moved by several animations; '" + animation_name(document, *chosen) +
                         "' is used, '" + animation_name(document, a) + "' is not");
    } else if (moves) {
      chosen = a;
    }
  }
  return chosen;
}

void add_tracks(const GltfDocument& document, std::size_t animation, const std::vector<int>& chain,
                std::vector<AnimatedNode>& nodes, Warnings& warnings) {
  for (const GltfAnimation::Channel& channel : document.animations[animation].channels) {
    const auto at = std::find(chain.begin(), chain.end(), channel.node);
    if (at == chain.end() || !moves_nodes(channel.path)) {
      continue;
    }
    AnimatedNode& node = nodes[static_cast<std::size_t>(at - chain.begin())];
    if (node.has_matrix) {
      warnings.push_back("nodes[" + std::to_string(channel.node) +
                         "] is animated and has a matrix, which glTF forbids; it stays at rest");
    } else if (channel.path == "translation") {
      node.translation_track = read_track(document, animation, channel.sampler, 3, warnings);
    } else if (channel.path == "rotation") {
      node.rotation_track = read_track(document, animation, channel.sampler, 4, warnings);
    } else {
      node.scale_track = read_track(document, animation, channel.sampler, 3, warnings);
    }
  }
}

}  // namespace

std::string animation_name(const GltfDocument& document, std::size_t index) {
  const std::string& name = document.animations[index].name;
  return name.empty() ? "#" + std::to_string(index) : name;
}

std::vector<int> chain_to(int node, const std::vector<int>& parents) {
  std::vector<int> chain;
  for (int at = node; at >= 0; at = parents[static_cast<std::size_t>(at)]) {
    chain.push_back(at);
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

std::int64_t last_key_ns(const std::vector<AnimatedNode>& nodes) {
  std::int64_t last = 0;
  for (const AnimatedNode& node : nodes) {
    for (const auto* track : {&node.translation_track, &node.rotation_track, &node.scale_track}) {
      last = *track ? std::max(last, (*track)->times_ns.back()) : last;
    }
  }
  return last;
}

std::vector<AnimatedNode> animated_chain(const GltfDocument& document, const std::vector<int>& chain,
                                         const std::string& what, Warnings& warnings) {
  std::vector<AnimatedNode> nodes;
  for (const int index : chain) {
    nodes.push_back(rest_of(document.nodes[static_cast<std::size_t>(index)]));
  }
  const auto moves = [&](const GltfAnimation::Channel& channel) { return moves_any(channel, chain); };
  if (const auto animation = first_animation(document, moves, what, warnings)) {
    add_tracks(document, *animation, chain, nodes, warnings);
  }
  return nodes;
}

std::optional<WeightTrack> animated_weights(const GltfDocument& document, int node, std::size_t targets,
                                            const std::string& what, Warnings& warnings) {
  const auto weighs = [&](const GltfAnimation::Channel& channel) {
    return channel.node == node && channel.path == "weights";
  };
  const auto animation = first_animation(document, weighs, "the shape of " + what, warnings);
  if (!animation) {
    return std::nullopt;
  }
  const auto& channels = document.animations[*animation].channels;
  const int sampler = std::find_if(channels.begin(), channels.end(), weighs)->sampler;
  RawTrack raw = read_raw_track(document, *animation, sampler, 1, targets, warnings);
  return WeightTrack{raw.interpolation, targets, std::move(raw.times_ns), {raw.values.begin(), raw.values.end()}};
}

void keep_animation(GltfDocument& document, const std::string& name) {
  std::vector<std::string> names;
  std::optional<std::size_t> chosen;
  for (std::size_t a = 0; a < document.animations.size(); ++a) {
    names.push_back(animation_name(document, a));
    if (!chosen && document.animations[a].name == name) {
      chosen = a;
    }
  }
  for (std::size_t a = 0; a < names.size() && !chosen; ++a) {
    if (std::to_string(a) == name || "#" + std::to_string(a) == name) {
      chosen = a;
    }
  }
  if (!chosen) {
    throw Error(
        ErrorKind::usage, "`animation`",
        names.empty() ? "'" + name + "': the scene has no animations" : unknown_name_message("animation", name, names));
  }
  for (std::size_t a = 0; a < document.animations.size(); ++a) {
    if (a != *chosen) {
      document.animations[a].channels.clear();
    }
  }
}

std::vector<char> moved_nodes(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                              const std::vector<int>& parents) {
  std::vector<char> moved(document.nodes.size(), 0);
  for (const GltfAnimation& animation : document.animations) {
    for (const GltfAnimation::Channel& channel : animation.channels) {
      if (channel.node >= 0 && moves_nodes(channel.path)) {
        moved[static_cast<std::size_t>(channel.node)] = 1;
      }
    }
  }
  for (const WorldNode& world : nodes) {  // parents before children
    const int parent = parents[static_cast<std::size_t>(world.node)];
    if (parent >= 0 && moved[static_cast<std::size_t>(parent)] != 0) {
      moved[static_cast<std::size_t>(world.node)] = 1;
    }
  }
  return moved;
}

void list_unshown_motion(const GltfDocument& document, const std::vector<WorldNode>& nodes,
                         const std::vector<int>& parents, std::vector<std::string>& ignored, Warnings& warnings) {
  const std::vector<char> moved = moved_nodes(document, nodes, parents);
  const auto lights = std::count_if(nodes.begin(), nodes.end(), [&](const WorldNode& world) {
    const auto node = static_cast<std::size_t>(world.node);
    return document.nodes[node].light >= 0 && moved[node] != 0;
  });
  if (lights > 0) {
    ignored.push_back("animation of " + std::to_string(lights) + " punctual lights");
    warnings.push_back("animations move " + std::to_string(lights) + " punctual lights, which are shown at rest");
  }
}

}  // namespace gazetrace
