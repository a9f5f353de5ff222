// SPDX-License-Identifier: Apache-2.0
// Turns real-valued rates into whole counts: budgets and unbiased rounding.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace {

// The rate n at which sum_k min(n weight_k, most_spp pixels_k) equals `samples`, where no site may have more than
// `most_spp` samples per pixel; found by bisection to the last bit. Error(usage) for more samples than that allows.
double rate_of_budget(const SamplingMap& map, const std::vector<double>& weights, double samples, double most_spp);

// Rounds the expectation of every site, min(rate weight, most_spp pixels), to a whole count and adds up the totals.
// This is systematic sampling (Madow 1949): with f_k the fractional parts and u uniform in [0, 1), a site is rounded up
// where u + f_1 + ... + f_k passes a whole number. The sums are kept in integer steps of 2^-40, so that whole rates
// remain exactly what they are. Sites are taken in their order, except that each group of four has a random order of
// its own: along a plain Z-curve a rate of 1/2 would round up every other column.
void set_whole_counts(SamplingMap& map, const std::vector<double>& weights, double rate, double most_spp,
                      std::uint64_t seed, std::int32_t frame);

}  // namespace gazetrace
