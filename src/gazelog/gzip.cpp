// SPDX-License-Identifier: Apache-2.0
#include "gazelog/log_file.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// Ends the stream on every way out of the function.
class Inflater {
 public:
  Inflater() : good_(inflateInit2(&stream_, 15 + 16) == Z_OK) {}  // 16: with a gzip header
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }
  [[nodiscard]] bool good() const { return good_; }
  z_stream& stream() { return stream_; }

 private:
  z_stream stream_{};
  bool good_;
};

}  // namespace

bool is_gzip(std::string_view bytes) {
  return bytes.starts_with("\x1F\x8B");
}

std::string unpack_gzip(std::string_view bytes, const std::string& path, std::uint64_t most_bytes) {
  constexpr std::size_t kFloor = std::size_t{16} << 20U;
  const std::size_t limit = std::min<std::uint64_t>(kFloor + 400 * bytes.size(), most_bytes);
  Inflater inflater;
  if (!inflater.good()) {
    throw Error(ErrorKind::runtime, path, "gzip data cannot be unpacked: no memory");
  }
  z_stream& stream = inflater.stream();
  std::string text;
  // The last four bytes state the length. With room for it nothing has to be held twice while the text grows.
  std::uint32_t stated = 0;
  if (bytes.size() >= sizeof(stated)) {
    std::memcpy(&stated, bytes.data() + bytes.size() - sizeof(stated), sizeof(stated));
  }
  constexpr std::size_t kMostRoom = std::size_t{64} << 20U;
  text.reserve(std::min<std::size_t>(stated, limit) + kMostRoom);
  std::size_t used = 0;  // bytes of the input
  for (;;) {
    const std::size_t room = std::clamp(text.size() / 2, std::size_t{65536}, kMostRoom);
    const std::size_t filled = text.size();
    text.resize(filled + room);
    const auto piece = static_cast<uInt>(std::min<std::size_t>(bytes.size() - used, std::size_t{1} << 30U));
    // zlib's interface is not const, but it does not write to its input.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + used));
    stream.avail_in = piece;
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + filled);
    stream.avail_out = static_cast<uInt>(room);
    const int status = inflate(&stream, Z_NO_FLUSH);
    used += piece - stream.avail_in;
    text.resize(filled + room - stream.avail_out);
    if (text.size() > limit) {
      throw Error(ErrorKind::input, path, fmt::format("unpacks to more than {} MiB", limit >> 20U),
                  limit == most_bytes ? "that is half of the memory that may be taken (`max-memory`)"
                                      : "no recording is packed that densely; unpack it first if it is one: gunzip");
    }
    if (status == Z_STREAM_END) {
      const std::string_view rest = bytes.substr(used);
      if (!is_gzip(rest)) {
        return text;  // anything behind the last member is padding
      }
      inflateReset(&stream);
      continue;
    }
    const bool cut = used == bytes.size() && stream.avail_out > 0;
    if (status != Z_OK || cut) {
      throw Error(ErrorKind::input, path,
                  status == Z_OK || status == Z_BUF_ERROR ? "gzip data are cut off" : "gzip data are damaged",
                  "copy the file again; gzip -t tests it");
    }
  }
}

std::string pack_gzip(std::string_view text) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw Error(ErrorKind::runtime, "", "gzip data cannot be packed: no memory");
  }
  std::string packed;
  std::size_t used = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    constexpr std::size_t kRoom = std::size_t{1} << 20U;
    const auto piece = static_cast<uInt>(std::min<std::size_t>(text.size() - used, std::size_t{1} << 30U));
    const std::size_t filled = packed.size();
    packed.resize(filled + kRoom);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data() + used));
    stream.avail_in = piece;
    stream.next_out = reinterpret_cast<Bytef*>(packed.data() + filled);
    stream.avail_out = static_cast<uInt>(kRoom);
    status = deflate(&stream, used + piece == text.size() ? Z_FINISH : Z_NO_FLUSH);
    used += piece - stream.avail_in;
    packed.resize(filled + kRoom - stream.avail_out);
  }
  deflateEnd(&stream);
  return packed;
}

}  // namespace gazetrace
