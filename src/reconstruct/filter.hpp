// SPDX-License-Identifier: Apache-2.0
// What a reconstruction filter is: it states what it needs, and goes from the values of the sites to every pixel.
#pragma once

#include <cstddef>

#include "gazetrace/foveation.hpp"
#include "gazetrace/reconstruct.hpp"
#include "reconstruct/site_values.hpp"

namespace gazetrace {

struct FilterInput {
  const SparseFrame& sparse;
  const SiteValues& values;
  const SamplingMap& map;
  const Guides* guides;  // of the map's size where the filter needs them
  int threads;
};

struct FilterDefinition {
  ReconstructionNeeds needs = {};  // reconstruct.cpp checks that they are met
  // Whether the halves of a map's samples must be independent; empty: always.
  bool (*needs_independent_halves)(const SamplingMap& map) = nullptr;
  Frame (*frame)(const FilterInput& input);
};

// One definition `filter_<name>` per line of filters.def.
#define FILTER(name, description) extern const FilterDefinition filter_##name;
#include "reconstruct/filters.def"
#undef FILTER

// A frame of the map's size; guide images only where `guides` is set.
Frame make_frame(const SamplingMap& map, bool guides);

// Gives every pixel of a site the site's own values. Filters use it for the pixels of 1x1 sites that they do not
// change, so that these have the same bits whichever filter is used.
void paint_site(Frame& frame, const SamplingMap& map, const SiteValues& values, std::size_t site);

}  // namespace gazetrace
