// SPDX-License-Identifier: Apache-2.0
#include "output/history_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace gazetrace {
namespace {

using Frames = std::vector<std::int32_t>;

Frames found_by(const RunPart& part) {
  const std::string& list = part.record.history.frames;
  return list.empty() ? Frames() : parse_frame_list(list);
}

std::string in_words(const Frames& passed) {
  return passed.empty() ? "without history" : "with the history of frames " + format_frame_list(passed);
}

void check_link(const RunPart& part, std::int32_t frame, const Frames& found, const Frames& wanted,
                Warnings& warnings) {
  if (found == wanted) {
    return;
  }
  const std::string problem =
      fmt::format("frame {} was made {}, in one run it would have been {}", frame, in_words(found), in_words(wanted));
  const bool is_end_of_it =
      !found.empty() && found.size() < wanted.size() && std::equal(found.rbegin(), found.rend(), wanted.rbegin());
  if (!is_end_of_it) {
    throw Error(ErrorKind::input, part.timing_path, problem,
                fmt::format("render this part again with `resume-from` and a checkpoint made after frame {}, or with "
                            "`preroll`",
                            wanted.back()));
  }
  warnings.push_back(fmt::format("{}: {}; there may be a visible seam", part.timing_path, problem));
}

}  // namespace

void check_histories(const FrameOwners& frames, Warnings& warnings) {
  const auto first = std::find_if(frames.begin(), frames.end(), [](const auto& at) { return at.second != nullptr; });
  if (first == frames.end()) {
    return;
  }
  std::map<const RunPart*, Frames> passed;  // the frames in each part's history so far
  Frames all = found_by(*first->second);    // those in the history of a single run that begins as the first part did
  const RunPart* before = first->second;
  for (const auto& [frame, part] : frames) {
    if (part != nullptr) {
      const auto [own, is_new] = passed.try_emplace(part);
      if (is_new) {
        own->second = found_by(*part);
      }
      if (part != before) {
        check_link(*part, frame, own->second, all, warnings);
      }
      own->second.push_back(frame);
    }
    all.push_back(frame);
    before = part;
  }
}

}  // namespace gazetrace
