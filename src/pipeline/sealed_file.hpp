// SPDX-License-Identifier: Apache-2.0
// A file of numbers. It begins with a line of text that says what it is and under which settings it was made, then
// holds every number as it is in memory, and ends with a digest of everything before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "gazetrace/image.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// What a file holds, for its first line and for messages.
struct SealedKind {
  const char* title;         // "gazetrace history 2": begins the file
  const char* name;          // "checkpoint"
  const char* wanted;        // what to give instead of a file of another kind
  const char* when_damaged;  // what to do about a damaged file
  const char* when_other_settings;
};

// Writer and reader are called with the same list of fields, so that they cannot differ.
class SealedWriter {
 public:
  SealedWriter(const SealedKind& kind, const std::string& digest);

  template <class T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(&value, sizeof(T));
  }
  template <class T>
  void operator()(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    (*this)(static_cast<std::uint64_t>(values.size()));
    add(values.data(), values.size() * sizeof(T));
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint64_t>(text.size()));
    add(text.data(), text.size());
  }
  template <class T>
  void operator()(const Image<T>& image) {
    (*this)(image.width_px);
    (*this)(image.height_px);
    (*this)(image.pixels);
  }
  // The file appears under its name only when it is complete. Error(runtime) where it cannot be written. Its frame is
  // left to the caller.
  WrittenFile save(const std::string& path);

 private:
  void add(const void* from, std::size_t size);

  std::vector<std::byte> bytes_;
};

class SealedReader {
 public:
  // Error(input) for a file that cannot be opened, is of another kind, is damaged or was made under other settings.
  SealedReader(const SealedKind& kind, std::string path, const std::string& digest);

  template <class T>
  void operator()(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    take(&value, sizeof(T));
  }
  void operator()(bool& value) {  // of which only two values may be in memory
    std::uint8_t byte = 0;
    (*this)(byte);
    if (byte > 1) {
      fail();
    }
    value = byte == 1;
  }
  template <class T>
  void operator()(std::vector<T>& values) {
    std::uint64_t count = 0;
    (*this)(count);
    if (count > left() / sizeof(T)) {
      fail();
    }
    values.resize(count);
    take(values.data(), values.size() * sizeof(T));
  }
  void operator()(std::string& text) {
    std::vector<char> letters;
    (*this)(letters);
    text.assign(letters.begin(), letters.end());
  }
  template <class T>
  void operator()(Image<T>& image) {
    (*this)(image.width_px);
    (*this)(image.height_px);
    (*this)(image.pixels);
    if (image.width_px < 0 || image.height_px < 0 ||
        image.pixels.size() != static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px)) {
      fail();
    }
  }
  // Error(input) unless everything was read.
  void finish() const;
  [[noreturn]] void fail() const;  // the file is damaged

 private:
  [[nodiscard]] std::size_t left() const { return end_ - at_; }
  void take(void* to, std::size_t size);

  SealedKind kind_;
  std::string path_;
  std::string bytes_;
  std::size_t at_ = 0, end_ = 0;
};

// The settings' digest in the first line of a file; empty where there is no file, one of another kind, or one that is
// cut within this line.
std::string read_sealed_digest(const SealedKind& kind, const std::string& path);

// Whether the file is as it was written, whatever it holds. Error(input) where it cannot be read.
bool is_sealed(const std::string& path);

}  // namespace gazetrace
