// SPDX-License-Identifier: Apache-2.0
// What a run wrote: digests of its files, and the journal that keeps them until the record is complete.
#include "output/written_file.hpp"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "core/atomic_file.hpp"
#include "core/file_digest.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

template <class T>
bool take_number(std::string_view& line, T& number) {
  const auto [end, problem] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (problem != std::errc() || end == line.data() + line.size() || *end != ' ') {
    return false;
  }
  line.remove_prefix(static_cast<std::size_t>(end - line.data()) + 1);
  return true;
}

}  // namespace

WrittenFile write_frame_file(const std::string& path, std::int32_t frame, std::span<const std::byte> bytes) {
  write_bytes_atomically(path, bytes);
  return {frame, bytes.size(), digest_bytes(bytes)};
}

std::string name_in_record(const std::string& directory, const std::string& path) {
  const std::string name = fs::path(path).lexically_relative(directory.empty() ? "." : directory).string();
  return name.empty() ? fs::absolute(path).lexically_normal().string() : name;
}

std::string path_in_record(const std::string& directory, const std::string& name) {
  return (fs::path(directory) / name).lexically_normal().string();
}

std::string file_journal_name(const std::string& record_path) {
  return record_path.substr(0, record_path.rfind(".json")) + ".files";
}

WrittenFiles read_file_journal(const std::string& path) {
  WrittenFiles files;
  std::ifstream journal(path, std::ios::binary);
  for (std::string text; std::getline(journal, text) && !journal.eof();) {
    constexpr std::size_t kDigest = 32;
    std::string_view line(text);
    WrittenFile file;
    if (take_number(line, file.frame) && take_number(line, file.bytes) && line.size() > kDigest + 1 &&
        line[kDigest] == ' ') {
      file.digest = line.substr(0, kDigest);
      files[std::string(line.substr(kDigest + 1))] = std::move(file);
    }
  }
  return files;
}

}  // namespace gazetrace
