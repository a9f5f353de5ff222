// SPDX-License-Identifier: Apache-2.0
// The history in a sealed file.
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>

#include "gazetrace/checkpoint.hpp"
#include "gazetrace/error.hpp"
#include "pipeline/sealed_file.hpp"

namespace gazetrace {
namespace {

constexpr SealedKind kCheckpoint{"gazetrace history 3", "checkpoint", "give the file that `checkpoint` wrote",
                                 "render from the beginning, or with `preroll`",
                                 "render with the same options, or with `preroll`"};

template <class History, class Visit>
void each_field(History& history, bool& has_ev, auto& ev, const Visit& visit) {
  visit(history.passed);
  visit(has_ev);
  visit(ev);
  visit(history.smoothed_ev_t_ns);
}

}  // namespace

void save_checkpoint(const std::string& path, const TemporalHistory& history, const std::string& settings_digest) {
  SealedWriter writer(kCheckpoint, settings_digest);
  bool has_ev = history.smoothed_ev.has_value();
  const double ev = history.smoothed_ev.value_or(0);
  each_field(history, has_ev, ev, [&](const auto& field) { writer(field); });
  writer.save(path);
}

void check_checkpoint_target(const std::string& path, const std::string& settings_digest, bool goes_on) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) {
    return;
  }
  const std::string digest = read_sealed_digest(kCheckpoint, path);
  if (digest == settings_digest) {
    return;
  }
  // Damage may have changed the digest itself, and what a fault has left of a checkpoint is no reason to stop.
  if (!digest.empty() && is_sealed(path)) {
    throw Error(ErrorKind::input, path, "is a checkpoint that was made under other settings",
                "give another name, or `overwrite` to replace it");
  }
  if (!goes_on) {
    throw Error(ErrorKind::input, path, "is no whole checkpoint, and would be replaced by one",
                "give another name, or `overwrite` to replace it");
  }
}

TemporalHistory load_checkpoint(const std::string& path, const std::string& settings_digest) {
  SealedReader reader(kCheckpoint, path, settings_digest);
  TemporalHistory history;
  bool has_ev = false;
  double ev = 0;
  each_field(history, has_ev, ev, [&](auto& field) { reader(field); });
  reader.finish();
  if (has_ev) {
    history.smoothed_ev = ev;
  }
  return history;
}

}  // namespace gazetrace
