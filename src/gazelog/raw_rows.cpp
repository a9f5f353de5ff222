// SPDX-License-Identifier: Apache-2.0
#include "core/nan.hpp"
#include "gazetrace/gaze_raw_rows.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace gazetrace {
namespace {

constexpr std::int32_t kNoNumber = std::numeric_limits<std::int32_t>::min();  // stands for NaN

std::uint8_t bytes_for(std::uint64_t most) {
  return most == 0 ? 0 : most <= 0xFF ? 1 : most <= 0xFFFF ? 2 : most <= 0xFFFFFFFF ? 4 : 8;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Whether every value is a whole number over this power of ten; of those that were looked at, `whole` holds the number.
template <class Values>
bool fits(const Values& values, double power_of_ten, std::vector<std::int32_t>& whole) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (same_bits(values[i], kNan)) {
      whole[i] = kNoNumber;
      continue;
    }
    const double scaled = values[i] * power_of_ten;
    if (!(std::abs(scaled) < kMost)) {
      return false;
    }
    whole[i] = static_cast<std::int32_t>(std::lround(scaled));
    if (!same_bits(static_cast<double>(whole[i]) / power_of_ten, values[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace

void RawRows::Integers::pack(const std::array<std::int64_t, kRowsOfBlock>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  least_ = *least;
  // The difference of any two fits into 64 bits without a sign.
  const auto above = [&](std::int64_t value) {
    return static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(least_);
  };
  width_ = bytes_for(above(*most));
  above_least_.resize(values.size() * width_ + sizeof(std::uint64_t));  // whole words are read
  for (std::size_t i = 0; i < values.size() && width_ > 0; ++i) {
    const std::uint64_t value = above(values[i]);
    std::memcpy(above_least_.data() + i * width_, &value, width_);
  }
}

std::int64_t RawRows::Integers::operator[](std::size_t i) const {
  static_assert(std::endian::native == std::endian::little);
  std::uint64_t above = 0;
  std::memcpy(&above, above_least_.data() + i * width_, sizeof(above));
  above &= width_ == 0 ? 0 : ~std::uint64_t{0} >> (8U * (sizeof(above) - width_));
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(least_) + above);
}

void RawRows::Decimals::pack(const std::array<double, kRowsOfBlock>& values) {
  only_ = values.front();
  if (std::all_of(values.begin(), values.end(), [&](double value) { return same_bits(value, only_); })) {
    return;
  }
  constexpr double kMostPower = 1e9;  // a double divided by a power of ten up to 1e22 is rounded but once
  whole_.resize(values.size());
  for (power_of_ten_ = 1; power_of_ten_ <= kMostPower; power_of_ten_ *= 10) {
    if (fits(values, power_of_ten_, whole_)) {
      return;
    }
  }
  whole_ = {};
  plain_.assign(values.begin(), values.end());
}

double RawRows::Decimals::operator[](std::size_t i) const {
  if (!whole_.empty()) {
    return whole_[i] == kNoNumber ? std::numeric_limits<double>::quiet_NaN()
                                  : static_cast<double>(whole_[i]) / power_of_ten_;
  }
  return plain_.empty() ? only_ : plain_[i];
}

void RawRows::Floats::pack(const std::array<float, kRowsOfBlock>& values) {
  only_ = values.front();
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  if (!std::all_of(values.begin(), values.end(), [&](float value) { return bits(value) == bits(only_); })) {
    plain_.assign(values.begin(), values.end());
  }
}

RawRows::Block RawRows::packed(const std::vector<RawSample>& rows) {
  Block block;
  const auto pack = [&](auto& column, const auto& value_of) {
    std::array<std::decay_t<decltype(value_of(rows.front()))>, kRowsOfBlock> values;
    std::transform(rows.begin(), rows.end(), values.begin(), value_of);
    column.pack(values);
  };
  pack(block.t_ns, [](const RawSample& row) { return row.t_ns; });
  pack(block.row, [](const RawSample& row) { return row.row; });
  pack(block.eye, [](const RawSample& row) { return static_cast<std::int64_t>(row.eye); });
  pack(block.at[0], [](const RawSample& row) { return row.at.x; });
  pack(block.at[1], [](const RawSample& row) { return row.at.y; });
  pack(block.at[2], [](const RawSample& row) { return row.at.z; });
  pack(block.confidence, [](const RawSample& row) { return row.confidence; });
  pack(block.pupil, [](const RawSample& row) { return row.pupil; });
  block.only_validity = rows.front().validity;
  if (std::any_of(rows.begin(), rows.end(),
                  [&](const RawSample& row) { return row.validity != block.only_validity; })) {
    block.validities.resize(rows.size());
    std::transform(rows.begin(), rows.end(), block.validities.begin(),
                   [](const RawSample& row) { return row.validity; });
  }
  return block;
}

void RawRows::push_back(const RawSample& row) {
  open_.push_back(row);
  if (open_.size() == kRowsOfBlock) {
    blocks_.push_back(packed(open_));
    open_.clear();
  }
}

void RawRows::append(const RawRows& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    push_back(rows[i]);
  }
}

void RawRows::sort_by_time() {
  std::vector<RawSample> rows(begin(), end());
  std::stable_sort(rows.begin(), rows.end(), [](const RawSample& a, const RawSample& b) { return a.t_ns < b.t_ns; });
  *this = {};
  for (const RawSample& row : rows) {
    push_back(row);
  }
}

void RawRows::set_validity(std::size_t i, GazeValidity validity) {
  const std::size_t first_open = blocks_.size() * kRowsOfBlock;
  if (i >= first_open) {
    open_[i - first_open].validity = validity;
    return;
  }
  Block& block = blocks_[i / kRowsOfBlock];
  if (block.validities.empty()) {
    block.validities.assign(kRowsOfBlock, block.only_validity);
  }
  block.validities[i % kRowsOfBlock] = validity;
}

RawSample RawRows::operator[](std::size_t i) const {
  const std::size_t b = i / kRowsOfBlock;
  const std::size_t k = i % kRowsOfBlock;
  if (b == blocks_.size()) {
    return open_[k];
  }
  const Block& block = blocks_[b];
  return {block.t_ns[k],
          {block.at[0][k], block.at[1][k], block.at[2][k]},
          block.validities.empty() ? block.only_validity : block.validities[k],
          static_cast<Eye>(block.eye[k]),
          block.confidence[k],
          block.pupil[k],
          block.row[k]};
}

std::int64_t RawRows::t_ns(std::size_t i) const {
  const std::size_t b = i / kRowsOfBlock;
  return b == blocks_.size() ? open_[i % kRowsOfBlock].t_ns : blocks_[b].t_ns[i % kRowsOfBlock];
}

Vec3d RawRows::at(std::size_t i) const {
  const std::size_t b = i / kRowsOfBlock;
  const std::size_t k = i % kRowsOfBlock;
  return b == blocks_.size() ? open_[k].at : Vec3d{blocks_[b].at[0][k], blocks_[b].at[1][k], blocks_[b].at[2][k]};
}

Eye RawRows::eye(std::size_t i) const {
  const std::size_t b = i / kRowsOfBlock;
  return b == blocks_.size() ? open_[i % kRowsOfBlock].eye : static_cast<Eye>(blocks_[b].eye[i % kRowsOfBlock]);
}

std::size_t RawRows::packed_bytes() const {
  std::size_t bytes = open_.size() * sizeof(RawSample);
  for (const Block& block : blocks_) {
    bytes += block.t_ns.bytes() + block.row.bytes() + block.eye.bytes() + block.validities.size() +
             block.confidence.bytes() + block.pupil.bytes();
    for (const Decimals& column : block.at) {
      bytes += column.bytes();
    }
  }
  return bytes;
}

}  // namespace gazetrace
