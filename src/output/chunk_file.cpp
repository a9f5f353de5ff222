// SPDX-License-Identifier: Apache-2.0
// The division of a sequence among tasks, as the first of them wrote it down.
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/json_problem.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

using Json = nlohmann::ordered_json;

std::string chunk_file_text(const ChunkFile& file) {
  return Json{{"digest", file.digest}, {"frames", file.frames}, {"chunks", file.chunks}, {"samples", file.samples}}
             .dump(2) +
         "\n";
}

ChunkFile read_chunk_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, path, "cannot be opened");
  }
  try {
    const Json json = Json::parse(file);
    ChunkFile chunks;
    json.at("digest").get_to(chunks.digest);
    json.at("frames").get_to(chunks.frames);
    json.at("chunks").get_to(chunks.chunks);
    json.at("samples").get_to(chunks.samples);
    return chunks;
  } catch (const Json::exception& e) {
    throw Error(ErrorKind::input, path,
                "says of no chunks which frames they have: " + bounded(json_problem(e.what()), 200),
                "remove it: the next task writes it again");
  }
}

}  // namespace gazetrace
