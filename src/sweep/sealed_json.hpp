// SPDX-License-Identifier: Apache-2.0
// The files in which a sweep keeps what it has finished. Each carries a digest of its own content, and names with sizes
// and digests the pictures that belong to it: nothing is taken for finished that is not as it was written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/output.hpp"
#include "gazetrace/sweep.hpp"

namespace gazetrace {

// Writes a JSON object, given as text, under its name when it is complete, and makes the folder. `files`: names
// relative to the sweep's folder, so that folders of several tasks can be taken into one.
void save_sealed(const std::string& path, const std::string& object, const WrittenFiles& files);

// The paths of all records in a sweep's folder, sorted. The files of references that are being rendered are none.
std::vector<std::string> sealed_records(const std::string& directory);
// The files that a record names. Empty where it is damaged, or not there.
std::optional<WrittenFiles> files_of_record(const std::string& path);

// Removes what is damaged of what the sweep keeps in its folder, so that it does not count as finished, and warns of
// each: records, and with them the pictures that they name and that are not as they were written. `trust_files`: the
// records alone are looked at. Where processes share the folder, only one at a time removes anything.
void drop_damaged(const std::string& directory, bool trust_files, int threads, const SweepObserver& observer);

}  // namespace gazetrace
