// SPDX-License-Identifier: Apache-2.0
#include "color/baked_view.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

// The axis of the grid: the bits of the float x + kOffset are a piecewise linear logarithm that costs one addition. Its
// bends are at powers of two, where the grid has points, so that it is linear between any two grid points.
constexpr float kOffset = 0x1p-6F;
constexpr float kMaxInput = 0x1p6F - kOffset;
constexpr int kOctaves = 12;
constexpr int kStepsPerOctave = 6;
constexpr int kCells = kOctaves * kStepsPerOctave;
constexpr int kPoints = kCells + 1;
constexpr float kBitsPerStep = 8388608.0F / kStepsPerOctave;

float to_axis(float x) {
  const std::int32_t bits = std::bit_cast<std::int32_t>(x + kOffset) - std::bit_cast<std::int32_t>(kOffset);
  return static_cast<float>(bits) * (1.0F / kBitsPerStep);
}

// The inverse of the axis at point `i` of a grid with `steps` points per octave.
float from_axis(int i, int steps) {
  const int octave = i / steps;
  const double mantissa = 1.0 + static_cast<double>(i % steps) / steps;
  return static_cast<float>(std::ldexp(mantissa, octave) * static_cast<double>(kOffset)) - kOffset;
}

using Int4 = std::int32_t __attribute__((vector_size(16)));

}  // namespace

BakedView::BakedView(const OcioView& exact, int threads) : exact_(exact) {
  // Every second point of the fine grid is a point of the table; at the others its error is measured.
  constexpr int kFine = 2 * kCells + 1;
  constexpr std::size_t kRow = kFine;
  std::array<float, kRow> axis{};
  for (int i = 0; i < kFine; ++i) {
    axis[static_cast<std::size_t>(i)] = from_axis(i, 2 * kStepsPerOctave);
  }
  std::vector<float> fine(kRow * kRow * kRow * 3);
  parallel_for(kRow, threads, [&](std::size_t b) {
    float* plane = &fine[b * kRow * kRow * 3];
    float* out = plane;
    for (std::size_t g = 0; g < kRow; ++g) {
      for (std::size_t r = 0; r < kRow; ++r, out += 3) {
        out[0] = axis[r];
        out[1] = axis[g];
        out[2] = axis[b];
      }
    }
    exact_.apply_float(plane, kRow * kRow);
    for (std::size_t i = 0; i < kRow * kRow * 3; ++i) {
      plane[i] = std::clamp(plane[i], 0.0F, 1.0F) * 255.0F;
    }
  });
  const auto at = [&](int r, int g, int b) {
    return &fine[((static_cast<std::size_t>(b) * kRow + static_cast<std::size_t>(g)) * kRow +
                  static_cast<std::size_t>(r)) *
                 3];
  };

  table_.resize(static_cast<std::size_t>(kPoints) * kPoints * kPoints);
  std::vector<std::size_t> exact_cells(kPoints);
  parallel_for(kPoints, threads, [&](std::size_t plane) {
    const int b = static_cast<int>(plane);
    Entry* entry = &table_[plane * kPoints * kPoints];
    for (int g = 0; g < kPoints; ++g) {
      for (int r = 0; r < kPoints; ++r, ++entry) {
        const float* value = at(2 * r, 2 * g, 2 * b);
        bool use_exact = false;
        if (r < kCells && g < kCells && b < kCells) {
          // At a half-way point the tetrahedral interpolation is the mean of two corners: those that differ in exactly
          // the axes in which the point lies half-way.
          for (int point = 0; point < 27 && !use_exact; ++point) {
            const std::array<int, 3> p{point % 3, point / 3 % 3, point / 9};
            const float* truth = at(2 * r + p[0], 2 * g + p[1], 2 * b + p[2]);
            const float* low = at(2 * r + p[0] / 2 * 2, 2 * g + p[1] / 2 * 2, 2 * b + p[2] / 2 * 2);
            const float* high = at(2 * r + (p[0] + 1) / 2 * 2, 2 * g + (p[1] + 1) / 2 * 2, 2 * b + (p[2] + 1) / 2 * 2);
            for (int c = 0; c < 3; ++c) {
              const double error = std::abs(0.5 * (static_cast<double>(low[c]) + static_cast<double>(high[c])) -
                                            static_cast<double>(truth[c]));
              use_exact = use_exact || !(error <= kTolerance);
            }
          }
        }
        exact_cells[plane] += use_exact ? 1U : 0U;
        *entry = Entry{value[0], value[1], value[2], use_exact ? 1.0F : 0.0F};
      }
    }
  });
  std::size_t sum = 0;
  for (const std::size_t count : exact_cells) {
    sum += count;
  }
  exact_cell_share_ = static_cast<double>(sum) / (static_cast<double>(kCells) * kCells * kCells);
}

std::size_t BakedView::apply_8(const float* rgb, std::size_t count, std::uint8_t* out) const {
  constexpr std::array<std::size_t, 3> kStride{1, kPoints, static_cast<std::size_t>(kPoints) * kPoints};
  constexpr std::size_t kAll = kStride[0] + kStride[1] + kStride[2];
  // The axis with the largest fraction and the one with the smallest, indexed by the three comparisons r >= g, g >= b
  // and r >= b. Two of the eight combinations are contradictory and never occur.
  constexpr std::array<std::size_t, 8> kFirst{kStride[2], 0,          kStride[1], kStride[1],
                                              kStride[2], kStride[0], 0,          kStride[0]};
  constexpr std::array<std::size_t, 8> kLast{kStride[0], 0,          kStride[0], kStride[2],
                                             kStride[1], kStride[1], 0,          kStride[2]};
  std::vector<std::uint32_t> left;
  for (std::size_t i = 0; i < count; ++i) {
    const float* value = &rgb[3 * i];
    // The last cell includes its upper border.
    const auto axis = [](float x) { return std::min(to_axis(std::min(x, kMaxInput)), kCells - 0x1p-10F); };
    const float ar = axis(value[0]);
    const float ag = axis(value[1]);
    const float ab = axis(value[2]);
    const int ir = static_cast<int>(ar);
    const int ig = static_cast<int>(ag);
    const int ib = static_cast<int>(ab);
    const float fr = ar - static_cast<float>(ir);
    const float fg = ag - static_cast<float>(ig);
    const float fb = ab - static_cast<float>(ib);
    const Entry* base = &table_[static_cast<std::size_t>(ir) * kStride[0] + static_cast<std::size_t>(ig) * kStride[1] +
                                static_cast<std::size_t>(ib) * kStride[2]];
    // The tetrahedron's corners are reached from the lowest one along the axes in falling order of their fractions.
    // Selections take the place of six branches, which could not be predicted in a noisy picture.
    const float high = std::max(fr, std::max(fg, fb));
    const float low = std::min(fr, std::min(fg, fb));
    const float middle = std::max(std::min(fr, fg), std::min(std::max(fr, fg), fb));
    const unsigned order = (fr >= fg ? 4U : 0U) | (fg >= fb ? 2U : 0U) | (fr >= fb ? 1U : 0U);
    const std::size_t first = kFirst[order];
    const std::size_t last = kLast[order];
    const Entry mixed =
        base[0] * (1 - high) + base[first] * (high - middle) + base[kAll - last] * (middle - low) + base[kAll] * low;
    const Int4 codes = __builtin_convertvector(mixed + 0.5F, Int4);
    out[3 * i] = static_cast<std::uint8_t>(codes[0]);
    out[3 * i + 1] = static_cast<std::uint8_t>(codes[1]);
    out[3 * i + 2] = static_cast<std::uint8_t>(codes[2]);
    const bool outside = value[0] > kMaxInput || value[1] > kMaxInput || value[2] > kMaxInput;
    if (outside || base[0][3] != 0) {
      left.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (!left.empty()) {
    std::vector<float> values;
    values.reserve(3 * left.size());
    for (const std::uint32_t i : left) {
      values.insert(values.end(), &rgb[3 * std::size_t{i}], &rgb[3 * std::size_t{i}] + 3);
    }
    std::vector<std::uint8_t> codes(3 * left.size());
    exact_.apply_8(values.data(), left.size(), codes.data());
    for (std::size_t k = 0; k < left.size(); ++k) {
      std::copy_n(&codes[3 * k], 3, &out[3 * std::size_t{left[k]}]);
    }
  }
  return left.size();
}

}  // namespace gazetrace
