// SPDX-License-Identifier: Apache-2.0
// The rows of a gaze log as its file has them. An hour at 1000 Hz with a row for each eye and one for their mean
// is 10.8 million rows, which are held beside the log that is made of them: they are packed, and give every value back
// bit by bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "gazetrace/gaze_conventions.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// A row of the file for one eye, or for a gaze that the log itself combined.
struct RawSample {
  // The stamp in nanoseconds, if its unit is the one of `RawGaze::declared.time_exponent`. Every digit down to a
  // nanosecond is kept.
  std::int64_t t_ns = 0;
  // x, y and, for directions, z, in the unit, axes and order of the file; NaN where the row has none.
  Vec3d at;
  GazeValidity validity = GazeValidity::ok;  // as the row states it for this eye
  Eye eye = Eye::cyclopean;
  float confidence = 1.0F;  // 0..1, NaN where the log has none
  float pupil = 0.0F;       // in `RawGaze::pupil_unit`, NaN where missing
  std::int64_t row = 0;     // 1-based line (binary formats: record) in the source file
};

// Rows in the order of the file. They are read by value, and appended at the end; appended rows keep their
// values, but for its validity.
class RawRows {
 public:
  class const_iterator;
  using value_type = RawSample;

  void push_back(const RawSample& row);
  void append(const RawRows& rows);
  // Keeps the rows, in their order, for which `keeps` says so.
  template <class Keeps>
  void keep_if(const Keeps& keeps) {
    RawRows kept;
    for (std::size_t i = 0; i < size(); ++i) {
      const RawSample row = (*this)[i];
      if (keeps(row)) {
        kept.push_back(row);
      }
    }
    *this = std::move(kept);
  }
  // Replaces each row by change(index, row).
  template <class Change>
  void change_each(const Change& change) {
    RawRows changed;
    for (std::size_t i = 0; i < size(); ++i) {
      changed.push_back(change(i, (*this)[i]));
    }
    *this = std::move(changed);
  }
  // Rows of one time stay in the order in which they are.
  void sort_by_time();
  void set_validity(std::size_t i, GazeValidity validity);

  [[nodiscard]] RawSample operator[](std::size_t i) const;
  [[nodiscard]] std::int64_t t_ns(std::size_t i) const;
  [[nodiscard]] Vec3d at(std::size_t i) const;
  [[nodiscard]] Eye eye(std::size_t i) const;
  [[nodiscard]] RawSample back() const { return (*this)[size() - 1]; }
  [[nodiscard]] std::size_t size() const { return blocks_.size() * kRowsOfBlock + open_.size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] const_iterator begin() const;
  [[nodiscard]] const_iterator end() const;
  // Bytes of the values themselves.
  [[nodiscard]] std::size_t packed_bytes() const;

 private:
  static constexpr std::size_t kRowsOfBlock = 4096;

  // Values of a block less its least one, in 0, 1, 2, 4 or 8 bytes each.
  class Integers {
   public:
    void pack(const std::array<std::int64_t, kRowsOfBlock>& values);
    [[nodiscard]] std::int64_t operator[](std::size_t i) const;
    [[nodiscard]] std::size_t bytes() const { return above_least_.size(); }

   private:
    std::int64_t least_ = 0;
    std::vector<std::uint8_t> above_least_;
    std::uint8_t width_ = 0;
  };
  // Numbers of a file have a few decimals: as a whole number of 32 bits over a power of ten, which a division turns
  // into the very double that the text stood for. Where that is not so, they are kept as they are.
  class Decimals {
   public:
    void pack(const std::array<double, kRowsOfBlock>& values);
    [[nodiscard]] double operator[](std::size_t i) const;
    [[nodiscard]] std::size_t bytes() const { return 4 * whole_.size() + 8 * plain_.size(); }

   private:
    double only_ = 0;  // if all of them are equal
    double power_of_ten_ = 1;
    std::vector<std::int32_t> whole_;
    std::vector<double> plain_;
  };
  class Floats {
   public:
    void pack(const std::array<float, kRowsOfBlock>& values);
    [[nodiscard]] float operator[](std::size_t i) const { return plain_.empty() ? only_ : plain_[i]; }
    [[nodiscard]] std::size_t bytes() const { return 4 * plain_.size(); }

   private:
    float only_ = 0;
    std::vector<float> plain_;
  };
  struct Block {
    Integers t_ns, row, eye;
    std::array<Decimals, 3> at;
    Floats confidence, pupil;
    GazeValidity only_validity = GazeValidity::ok;  // if the rows have the same
    std::vector<GazeValidity> validities;
  };
  static Block packed(const std::vector<RawSample>& rows);

  std::vector<Block> blocks_;
  std::vector<RawSample> open_;  // the last rows, fewer than make a block
};

class RawRows::const_iterator {
 public:
  using iterator_category = std::random_access_iterator_tag;
  using value_type = RawSample;
  using difference_type = std::ptrdiff_t;
  using reference = RawSample;
  struct pointer {
    RawSample row;
    const RawSample* operator->() const { return &row; }
  };

  const_iterator() = default;
  const_iterator(const RawRows& rows, std::size_t at) : rows_(&rows), at_(static_cast<difference_type>(at)) {}
  reference operator*() const { return (*rows_)[static_cast<std::size_t>(at_)]; }
  pointer operator->() const { return {**this}; }
  reference operator[](difference_type n) const { return *(*this + n); }
  const_iterator& operator+=(difference_type n) {
    at_ += n;
    return *this;
  }
  const_iterator& operator-=(difference_type n) { return *this += -n; }
  const_iterator& operator++() { return *this += 1; }
  const_iterator& operator--() { return *this -= 1; }
  const_iterator operator++(int) {
    const const_iterator before = *this;
    ++*this;
    return before;
  }
  const_iterator operator--(int) {
    const const_iterator before = *this;
    --*this;
    return before;
  }
  friend const_iterator operator+(const_iterator i, difference_type n) { return i += n; }
  friend const_iterator operator+(difference_type n, const_iterator i) { return i += n; }
  friend const_iterator operator-(const_iterator i, difference_type n) { return i -= n; }
  friend difference_type operator-(const const_iterator& a, const const_iterator& b) { return a.at_ - b.at_; }
  friend bool operator==(const const_iterator& a, const const_iterator& b) { return a.at_ == b.at_; }
  friend auto operator<=>(const const_iterator& a, const const_iterator& b) { return a.at_ <=> b.at_; }

 private:
  const RawRows* rows_ = nullptr;
  difference_type at_ = 0;
};

inline RawRows::const_iterator RawRows::begin() const {
  return {*this, 0};
}
inline RawRows::const_iterator RawRows::end() const {
  return {*this, size()};
}

}  // namespace gazetrace
