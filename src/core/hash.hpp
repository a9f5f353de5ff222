// SPDX-License-Identifier: Apache-2.0
// Integer hashing: random numbers as functions of their coordinates, and content digests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gazetrace {

// Finaliser of MurmurHash3 (Appleby, public domain) with the constants of "lowbias32" (Wellons).
constexpr std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x7feb352dU;
  x ^= x >> 15U;
  x *= 0x846ca68bU;
  x ^= x >> 16U;
  return x;
}

// SplitMix64's output function (Steele et al. 2014).
constexpr std::uint64_t hash64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

constexpr std::uint64_t hash_combine(std::uint64_t a, std::uint64_t b) {
  return hash64(a ^ hash64(b));
}

// FNV-1a over bytes, two lanes finalised together: 128 bits as 32 hex digits. For digests of settings and files,
// not for security.
class Digest {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) {
      a_ = (a_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
      b_ = (b_ + static_cast<unsigned char>(c) + 1) * 0x9e3779b97f4a7c15ULL;
      b_ ^= b_ >> 29U;
    }
    size_ += bytes.size();
  }
  [[nodiscard]] std::string hex() const {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::uint64_t lane : {hash_combine(a_, size_), hash_combine(b_, size_)}) {
      for (unsigned shift = 64; shift != 0; shift -= 4) {
        text += kDigits[(lane >> (shift - 4)) & 0xFU];
      }
    }
    return text;
  }

 private:
  std::uint64_t a_ = 0xcbf29ce484222325ULL;
  std::uint64_t b_ = 0x2545f4914f6cdd1dULL;
  std::uint64_t size_ = 0;
};

}  // namespace gazetrace
