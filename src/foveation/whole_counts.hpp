// SPDX-License-Identifier: Apache-2.0
// From real-valued rates to whole counts: budgets and unbiased rounding.
#pragma once

#include <cstdint>
#include <vector>

#include "gazetrace/foveation.hpp"

namespace gazetrace {

// The rate n at which sum_k min(n weight_k, most_spp pixels_k) is `samples`; every site has at most `most_spp` samples
// a pixel. By bisection to the last bit. Error(usage) for more samples than that allows.
double rate_of_budget(const SamplingMap& map, const std::vector<double>& weights, double samples, double most_spp);

// Gives every site the whole count that its expectation, min(rate weight, most_spp pixels), is rounded to, and adds up
// the totals. Systematic sampling (Madow 1949): with f_k the fractional parts and u uniform in [0, 1), a site is
// rounded up where u + f_1 + ... + f_k passes a whole number. The sums are integers of 2^-40, so that whole rates give
// exactly themselves wherever they stand. Sites take part in their order, but each four in a random order of their own:
// in a plain Z-curve a rate of 1/2 would round up every other column.
void set_whole_counts(SamplingMap& map, const std::vector<double>& weights, double rate, double most_spp,
                      std::uint64_t seed, std::int32_t frame);

}  // namespace gazetrace
