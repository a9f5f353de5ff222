// SPDX-License-Identifier: Apache-2.0
// Changes JSON so that it stays JSON: a file whose brackets are broken is refused at the door, and what lies behind the
// door is never met.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/gltf/file.hpp"
#include "scene/gltf/json.hpp"

namespace gazetrace {

// Makes new bytes of `size` old ones in place, at most `most`, and returns how many they are: LLVMFuzzerMutate.
using MutateBytes = std::size_t (*)(std::uint8_t* data, std::size_t size, std::size_t most);

class JsonMutator {
 public:
  JsonMutator(std::uint64_t seed, MutateBytes mutate_bytes) : random_(seed), mutate_bytes_(mutate_bytes) {}

  // One to four changes: values become extreme ones of their kind or of another, members and elements go, come twice,
  // change places or are copied from `donor` or elsewhere; and the bytes of "data:" uris are changed. Empty where the
  // text is not JSON.
  std::string operator()(std::string_view text, std::string_view donor = {});

 private:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % (n == 0 ? 1 : n)); }
  template <class Json>
  void change(Json& root, const Json& donor);
  template <class Json>
  void change_bytes(Json& uri);
  template <class Json>
  void make_extreme(Json& value);

  std::mt19937_64 random_;
  MutateBytes mutate_bytes_;
};

namespace json_mutator {
using Tree = nlohmann::json;
inline constexpr int kMostNesting = 150;
inline constexpr std::size_t kMostBytes = std::size_t{1} << 16U;

inline constexpr std::array<std::int64_t, 22> kWholes{-1,
                                                      0,
                                                      1,
                                                      2,
                                                      3,
                                                      4,
                                                      5,
                                                      6,
                                                      7,
                                                      16,
                                                      255,
                                                      256,
                                                      5121,
                                                      5125,
                                                      65535,
                                                      65536,
                                                      std::numeric_limits<std::int32_t>::max(),
                                                      std::int64_t{1} << 31U,
                                                      (std::int64_t{1} << 32U) - 1,
                                                      std::int64_t{1} << 53U,
                                                      std::numeric_limits<std::int64_t>::max(),
                                                      std::numeric_limits<std::int64_t>::min()};
inline constexpr std::array<double, 18> kNumbers{0.0,    -0.0, 0.5,   1e-3,  -1e-3,  1e-30, 1e-38, 1e-45, 1e-320,
                                                 3.4e38, 1e39, -1e39, 1e300, -1e308, 1e9,   9.2e9, 1e18,  -1e20};
inline constexpr std::array<std::uint32_t, 12> kWords{0,          1,          0xFFFFFFFF, 0x7F800000,
                                                      0xFF800000, 0x7FC00000, 0x7F7FFFFF, 0x00000001,
                                                      0x80000000, 0x3F800000, 0x4B000000, 0xDF000000};

// Every value in the tree, parents before children.
inline void collect(Tree& value, std::vector<Tree*>& all) {
  all.push_back(&value);
  if (value.is_structured()) {
    for (Tree& item : value) {
      collect(item, all);
    }
  }
}

inline std::string base64_of(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (i + k < bytes.size() ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kAlphabet[bits >> (18U - 6U * static_cast<unsigned>(k)) & 63U];
    }
  }
  return text;
}

inline std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

inline void put_word(std::string& bytes, std::uint32_t word) {
  bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

}  // namespace json_mutator

template <class Json>
void JsonMutator::make_extreme(Json& value) {
  using namespace json_mutator;
  switch (below(12)) {
    case 0:
      value = nullptr;
      return;
    case 1:
      value = below(2) == 0;
      return;
    case 2:
      value = std::string(below(3) == 0 ? 3000 : below(4), below(2) == 0 ? 'x' : '\n');
      return;
    case 3:
      value = Json::array();
      return;
    case 4:
      value = Json::object();
      return;
    case 5:
      value = std::numeric_limits<std::uint64_t>::max() - below(3);
      return;
    case 6:
    case 7:
      value = kNumbers[below(kNumbers.size())];
      return;
    default:
      value = kWholes[below(kWholes.size())];
  }
}

// Bytes of geometry, packed or not: what floats and indices may be is tried in whole words.
template <class Json>
void JsonMutator::change_bytes(Json& uri) {
  using namespace json_mutator;
  const auto text = uri.template get<std::string>();
  std::vector<std::uint8_t> bytes;
  try {
    bytes = decode_data_uri(text, "");
  } catch (const std::exception&) {
    return;
  }
  const std::string head = text.substr(0, text.find(',') + 1);
  if (below(2) == 0 && bytes.size() >= 4) {
    for (std::size_t i = 1 + below(4); i > 0; --i) {
      const std::uint32_t word = kWords[below(kWords.size())];
      std::memcpy(&bytes[below(bytes.size() / 4) * 4], &word, sizeof word);
    }
  } else {
    const std::size_t size = bytes.size();
    bytes.resize(std::min(size + 64, kMostBytes));
    bytes.resize(mutate_bytes_(bytes.data(), std::min(size, bytes.size()), bytes.size()));
  }
  uri = head + base64_of(bytes);
}

template <class Json>
void JsonMutator::change(Json& root, const Json& donor) {
  using namespace json_mutator;
  std::vector<Json*> all;
  collect(root, all);
  Json& value = *all[below(all.size())];
  const auto any = [&](bool (*wanted)(const Json&)) -> Json* {
    std::vector<Json*> some;
    std::copy_if(all.begin(), all.end(), std::back_inserter(some), [&](const Json* one) { return wanted(*one); });
    return some.empty() ? nullptr : some[below(some.size())];
  };
  switch (below(14)) {
    case 0:
    case 1:
    case 2:
      if (Json* const number = any([](const Json& one) { return one.is_number(); })) {
        // Most indices and counts are small, and one beside the right one leads further than a huge one.
        if (number->is_number_integer() && below(3) == 0) {
          *number = number->template get<std::int64_t>() / 2 + static_cast<std::int64_t>(below(5)) - 2;
        } else if (number->is_number_integer() && below(2) == 0) {
          *number = kWholes[below(kWholes.size())];
        } else {
          *number = kNumbers[below(kNumbers.size())];
        }
      }
      return;
    case 3:
      make_extreme(value);
      return;
    case 4:
    case 5:
      if (Json* const uri = any([](const Json& one) {
            return one.is_string() && one.template get_ref<const std::string&>().starts_with("data:");
          })) {
        change_bytes(*uri);
      }
      return;
    case 6:
      if (Json* const object = any([](const Json& one) { return one.is_object() && !one.empty(); })) {
        object->erase(std::next(object->begin(), static_cast<std::ptrdiff_t>(below(object->size()))).key());
      }
      return;
    case 7:
      if (Json* const array = any([](const Json& one) { return one.is_array() && !one.empty(); })) {
        array->erase(below(array->size()));
      }
      return;
    case 8:
      if (Json* const array = any([](const Json& one) { return one.is_array() && !one.empty(); })) {
        const Json copy = (*array)[below(array->size())];
        for (std::size_t times = below(8) == 0 ? 200 : 1; times > 0; --times) {
          array->push_back(copy);
        }
      }
      return;
    case 9: {  // a copy of another place's value
      Json copy = *all[below(all.size())];
      value = std::move(copy);
      return;
    }
    case 10: {  // a number of elsewhere: an index into something else
      const Json* const from = any([](const Json& one) { return one.is_number(); });
      Json* const to = any([](const Json& one) { return one.is_number(); });
      if (from != nullptr && to != nullptr) {
        const Json copy = *from;
        *to = copy;
      }
      return;
    }
    case 11:
      if (Json* const text = any([](const Json& one) { return one.is_string(); })) {
        const Json* const from = any([](const Json& one) { return one.is_string(); });
        const Json copy = *from;
        *text = copy;
      }
      return;
    case 12: {  // a member of another object
      Json* const to = any([](const Json& one) { return one.is_object(); });
      const Json* const from = any([](const Json& one) { return one.is_object() && !one.empty(); });
      if (to != nullptr && from != nullptr) {
        const auto member = std::next(from->begin(), static_cast<std::ptrdiff_t>(below(from->size())));
        const std::string key = member.key();
        const Json copy = *member;
        (*to)[key] = copy;
      }
      return;
    }
    default:
      if (donor.is_object() && root.is_object() && !donor.empty()) {
        const auto member = std::next(donor.begin(), static_cast<std::ptrdiff_t>(below(donor.size())));
        root[member.key()] = *member;
      }
      return;
  }
}

inline std::string JsonMutator::operator()(std::string_view text, std::string_view donor) {
  using namespace json_mutator;
  const auto parse = [](std::string_view json) {
    return is_nested_too_deep(json, kMostNesting) ? Tree(Tree::value_t::discarded) : Tree::parse(json, nullptr, false);
  };
  Tree root = parse(text);
  if (root.is_discarded()) {
    return {};
  }
  const Tree other = donor.empty() ? Tree() : parse(donor);
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    change(root, other);
  }
  return root.dump(-1, ' ', false, Tree::error_handler_t::replace);
}

// The same for .glb files: of their JSON, their bytes, or both; lengths are set right again, mostly.
inline std::string mutate_glb(std::string_view glb, JsonMutator& mutate, std::uint64_t seed, MutateBytes mutate_bytes) {
  using namespace json_mutator;
  constexpr std::size_t kHeads = 20;
  if (glb.size() < kHeads) {
    return {};
  }
  const std::size_t length = std::min<std::size_t>(word_at(glb, 12), glb.size() - kHeads);
  std::string json(glb.substr(kHeads, length));
  std::string rest(glb.substr(kHeads + length));
  std::string bin = rest.size() >= 8 ? rest.substr(8) : "";
  if (seed % 3 != 0) {
    if (std::string changed = mutate(json); !changed.empty()) {
      json = std::move(changed);
    }
  }
  if (seed % 3 != 1 && !bin.empty()) {
    const std::size_t size = bin.size();
    bin.resize(size + 64);
    bin.resize(mutate_bytes(reinterpret_cast<std::uint8_t*>(bin.data()), size, bin.size()));
  }
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string file("glTF");
  put_word(file, 2);
  put_word(file, static_cast<std::uint32_t>(kHeads + json.size() + 8 + bin.size() + (seed % 50 == 0 ? 1 : 0)));
  put_word(file, static_cast<std::uint32_t>(json.size() + (seed % 51 == 0 ? 4 : 0)));
  put_word(file, 0x4E4F534A);
  file += json;
  put_word(file, static_cast<std::uint32_t>(bin.size()));
  put_word(file, 0x004E4942);
  return file + bin;
}

}  // namespace gazetrace
