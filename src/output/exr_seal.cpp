// SPDX-License-Identifier: Apache-2.0
#include "output/exr_seal.hpp"

#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "core/file_digest.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr const char* kName = "gazetrace:seal";
constexpr std::size_t kSealDigits = 32;  // of digest_bytes()

// As an attribute lies in a file, by the layout of OpenEXR files: name, type, size, value.
std::string beginning_of_attribute() {
  using namespace std::string_literals;
  return kName + "\0string\0"s + static_cast<char>(kSealDigits) + "\0\0\0"s;
}

// The place of the digest; empty where there is none. Attributes stand before everything else in a file.
std::span<std::byte> place_of_seal(std::span<std::byte> bytes) {
  const std::string beginning = beginning_of_attribute();
  const auto* const text = reinterpret_cast<const char*>(bytes.data());
  const std::size_t at = std::string_view(text, bytes.size()).find(beginning);
  return at == std::string_view::npos || at + beginning.size() + kSealDigits > bytes.size()
             ? std::span<std::byte>()
             : bytes.subspan(at + beginning.size(), kSealDigits);
}

}  // namespace

void add_room_for_seal(Imf::Header& header) {
  header.insert(kName, Imf::StringAttribute(std::string(kSealDigits, '0')));
}

void seal_exr(std::span<std::byte> file_bytes) {
  if (const std::span<std::byte> place = place_of_seal(file_bytes); !place.empty()) {
    const std::string digest = digest_bytes(file_bytes);
    std::memcpy(place.data(), digest.data(), kSealDigits);
  }
}

bool has_whole_seal(const std::string& path) {
  try {
    std::string bytes = read_file_bytes(path);
    const std::span<std::byte> place = place_of_seal(std::as_writable_bytes(std::span(bytes)));
    if (place.empty()) {
      return false;
    }
    std::array<char, kSealDigits> stated{};
    std::memcpy(stated.data(), place.data(), kSealDigits);
    std::fill(place.begin(), place.end(), std::byte{'0'});
    return digest_bytes(std::as_bytes(std::span(bytes))) == std::string_view(stated.data(), kSealDigits);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace gazetrace
