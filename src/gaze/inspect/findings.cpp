// SPDX-License-Identifier: Apache-2.0
// From measurements to what is wrong, the evidence for it, and the option that mends it. A finding that rests on
// statistics alone is a suspicion. Where nothing in the log speaks for or against, the answer is undecided.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "gaze/inspect/inspect.hpp"
#include "gazelog/recordings.hpp"
#include "gazelog/stamps.hpp"

namespace gazetrace {
namespace {

double percent_of(std::size_t n, std::size_t all) {
  return 100 * static_cast<double>(n) / static_cast<double>(std::max<std::size_t>(1, all));
}

class Doctor {
 public:
  Doctor(const GazeLog& log, const GazeUnderInspection* whole, const GazeInspectOptions& options,
         GazeInspection& report)
      : log_(log), whole_(whole), options_(options), report_(report) {
    // Of a long log every n-th sample, where it is usable.
    const auto usable = std::count_if(log.samples.begin(), log.samples.end(),
                                      [](const GazeSample& sample) { return is_usable(sample.validity); });
    const bool is_long = static_cast<std::size_t>(usable) > kMostLookedAt;
    const std::size_t stride = is_long ? log.samples.size() / kMostLookedAt + 1 : 1;
    for (std::size_t i = 0; i < log.samples.size(); i += stride) {
      if (is_usable(log.samples[i].validity)) {
        usable_.push_back(&log.samples[i]);
      }
    }
  }

  void examine() {
    faults_of_reading();
    find_faults_of_time(log_, whole_, report_);
    const bool unit_is_wrong = doubts_of_reading();
    recurring_place();
    mark_in_one_axis();
    if (!examine_axes(log_, unit_is_wrong, report_)) {
      swapped_by_extent();
    }
    rest();
    verdict();
  }

 private:
  static constexpr std::size_t kMostLookedAt = 200'000;

  template <class... Texts>
  void add(Texts&&... texts) {
    add_finding(report_, std::forward<Texts>(texts)...);
  }
  [[nodiscard]] bool has_finding(std::initializer_list<std::string_view> codes) const {
    return gazetrace::has_finding(report_, codes);
  }
  // What the file would be if its numbers were interpreted under other conventions, in a few words.
  template <class Change>
  [[nodiscard]] std::string read_otherwise(const Change& change) const {
    if (whole_ == nullptr) {
      return {};
    }
    Conventions other = whole_->conventions;
    change(other);
    try {
      return fmt::format("; as read, {}; read so, {}", state_of(log_), state_of(interpret(whole_->raw, other)));
    } catch (const Error&) {
      return {};  // it needs something that is not known, such as the size of the display
    }
  }
  static std::string state_of(const GazeLog& log) {
    std::size_t usable = 0;
    std::size_t on_display = 0;
    for (const GazeSample& sample : log.samples) {
      usable += is_usable(sample.validity) ? 1 : 0;
      on_display += is_usable(sample.validity) && sample.validity != GazeValidity::off_screen ? 1 : 0;
    }
    const std::size_t all = log.samples.size();
    return log.kind == GazeKind::screen
               ? fmt::format("{:.0f} % of the samples lie on the display", percent_of(on_display, all))
               : fmt::format("{:.0f} % of the samples are usable", percent_of(usable, all));
  }

  void faults_of_reading() {
    if (whole_ == nullptr) {
      return;
    }
    if (whole_->is_first_of_several) {
      add(FindingKind::fault, "several-recordings",
          fmt::format(
              "{}the file holds {}, and this is the first of them; nothing but an inspection reads it until one "
              "is chosen",
              words_of_restart(whole_->raw), recordings_in_words(log_.recordings)),
          "the columns or lines that begin a recording, or stamps that begin again", "`gaze-recording` 1");
    }
    for (const std::string& damage : whole_->raw.damages) {
      add(FindingKind::fault, "damaged", damage, "the bytes of the file");
    }
    for (const RawFault& fault : whole_->raw.faults) {
      add(FindingKind::fault, fault.code, fault.found, "the rows themselves", fault.setting);
    }
  }

  // What the judge of readings says, whom every command asks.
  bool doubts_of_reading() {
    if (whole_ == nullptr) {
      return false;
    }
    for (const ReadingDoubt& doubt : whole_->conventions.doubts) {
      add(FindingKind::suspicion, doubt.code, doubt.what, doubt.evidence, doubt.setting);
      report_.findings.back().is_open = doubt.is_open;
    }
    return has_finding({"position-unit", "origin", "beside-the-display"});
  }
  // The size of the display or of the scene camera's picture; it is a guess where the log was inspected with a guessed
  // size.
  [[nodiscard]] Vec2d picture_px() const {
    const DisplayGeometry given = options_.display.value_or(DisplayGeometry{});
    if (given.width_px > 0) {
      return {static_cast<double>(given.width_px), static_cast<double>(given.height_px)};
    }
    if (const auto& g = log_.recording_geometry; g && g->width_px > 0) {
      return {static_cast<double>(g->width_px), static_cast<double>(g->height_px)};
    }
    const auto& display = log_.conventions.display;
    return display ? Vec2d{static_cast<double>(display->value.width_px), static_cast<double>(display->value.height_px)}
                   : Vec2d{};
  }

  void recurring_place() {
    const auto place = whole_ == nullptr ? std::nullopt : find_recurring_place(whole_->raw, whole_->conventions);
    if (!place) {
      return;
    }
    const double x = place->raw.x;
    const double y = place->raw.y;
    const bool is_vector = whole_->conventions.form == PlaceForm::vector;
    const std::string where = is_vector && x == 0 ? "straight ahead"
                              : is_vector         ? fmt::format("at ({0}, {0}, {0})", x)
                                                  : fmt::format("at ({}, {})", x, y);
    // The option takes a value that both axes have, or a whole negative one of one axis, as trackers write it that
    // lose one axis alone.
    const auto is_mark = [&](double value) {
      return value < 0 && value == std::floor(value) && !is_vector &&
             log_.conventions.origin.value != PositionOrigin::center;
    };
    const double mark = x == y || is_mark(x) ? x : is_mark(y) ? y : 0;
    const bool option_takes_it = mark != 0;
    add(FindingKind::suspicion, "missing-value",
        fmt::format("{} of {} rows are exactly {} and count as good: a mark of missing values", place->rows,
                    log_.order.rows, where),
        "statistics: gaze comes to this place again and again, and by jumps" +
            (option_takes_it ? read_otherwise([&](Conventions& c) { c.missing_value = mark; }) : ""),
        option_takes_it ? fmt::format("`missing-value` {}", mark) : "");
  }

  void mark_in_one_axis() {
    if (whole_ == nullptr || log_.conventions.origin.value == PositionOrigin::center ||
        has_finding({"missing-value"})) {
      return;
    }
    if (const auto mark = find_mark_in_one_axis(whole_->raw, whole_->conventions)) {
      add(FindingKind::suspicion, "missing-value",
          fmt::format("{} coordinates are exactly {} and count as good: a mark of missing values, in one axis alone",
                      mark->rows, mark->raw.x),
          "statistics: a whole number beside the display that comes again and again" +
              read_otherwise([&](Conventions& c) { c.missing_value = mark->raw.x; }),
          fmt::format("`missing-value` {}", mark->raw.x));
    }
  }

  // Positions that exceed the display's height but never its width suggest exchanged axes.
  void swapped_by_extent() {
    const Vec2d size = picture_px();
    // What a format defines is not doubted because the eye rests below the screen.
    if (log_.kind != GazeKind::screen || log_.conventions.unit.value != PositionUnit::px || !(size.x > 1.2 * size.y) ||
        usable_.size() < 50 || whole_ == nullptr || !whole_->raw.is_own_table) {
      return;
    }
    std::size_t beside = 0;
    std::size_t beside_swapped = 0;
    for (const GazeSample* const s : usable_) {
      const double x = s->u * size.x;
      const double y = s->v * size.y;
      const auto outside = [&](double right, double down) {
        return right < 0 || down < 0 || right > size.x || down > size.y;
      };
      beside += outside(x, y) ? 1 : 0;
      beside_swapped += outside(y, x) ? 1 : 0;
    }
    if (beside * 10 > usable_.size() && beside_swapped * 4 < beside) {
      add(FindingKind::suspicion, "swapped-axes", "the axes seem to be exchanged",
          fmt::format("statistics: {:.0f} % of the samples lie beside the display, {:.0f} % with x and y exchanged",
                      percent_of(beside, usable_.size()), percent_of(beside_swapped, usable_.size())) +
              read_otherwise([](Conventions& c) { c.swap_xy = !c.swap_xy; }),
          "`swap-xy`");
    }
  }

  void rest() {
    const GazeLoss& loss = report_.loss;
    const auto share = [&](std::size_t n) {
      return loss.samples > 0 ? static_cast<double>(n) / static_cast<double>(loss.samples) : 0;
    };
    if (log_.kind == GazeKind::scene_camera) {
      add(FindingKind::note, "scene-camera",
          "the gaze lies on the picture of a camera on the head, which is no fault: it can be looked at and converted, "
          "but nothing can be rendered from it, since it is no place on a display",
          "the format; " +
              (whole_ != nullptr && !whole_->raw.way_out.empty()
                   ? whole_->raw.way_out
                   : "where the log has directions, `frame` head takes them; else map gaze onto the display"));
    }
    if (loss.samples == 1) {
      add(FindingKind::suspicion, "one-row",
          "the log holds one row: neither its rate nor a movement of the eye can be told from it",
          "the file; was it cut off?");
    }
    const bool is_reversed = has_finding({"validity"});  // then all that is said of losses follows from it
    if (!is_reversed) {
      lost_ends();
    }
    if (!is_reversed && loss.usable == 0) {
      add(FindingKind::suspicion, "nothing-usable", "no sample is usable",
          "check which column says what is valid: `validity-column`, `valid-values`");
    } else if (!is_reversed && share(loss.usable) < 0.5) {
      add(FindingKind::note, "lost", fmt::format("only {:.1f} % of the samples are usable", 100 * share(loss.usable)),
          "the log's own validity");
    }
    const std::size_t beside = loss.by_validity[static_cast<std::size_t>(GazeValidity::off_screen)];
    if (share(beside) > 0.2 && !has_finding({"origin", "beside-the-display"})) {
      add(share(beside) > 0.5 && !has_finding({"position-unit"}) ? FindingKind::suspicion : FindingKind::note,
          "off-screen",
          fmt::format("{:.1f} % of the samples lie beside the display, most of them {} it", 100 * share(beside),
                      side_of_most()),
          "positions outside 0..1 of the display: did the viewer look there, and is this the display of the "
          "recording?");
    }
    const bool are_marks = has_finding({"zero-missing", "missing-value"});
    // Marks stand still as well, and so do numbers of few digits; both are reported already.
    const bool tells = !are_marks && !is_reversed && !has_finding({"coarse"}) && !log_.sample_age_unknown;
    if (tells && report_.frozen.samples * 20 > loss.usable && report_.frozen.runs > 0) {
      add(FindingKind::suspicion, "frozen",
          fmt::format("positions stand still bit by bit in {} runs, the longest of {:.0f} ms in line {}",
                      report_.frozen.runs, static_cast<double>(report_.frozen.longest_ns) * 1e-6,
                      report_.frozen.longest_row),
          "data held while the eye was lost, or a logger that repeats; a validity column would tell "
          "(`validity-column`)");
    }
    if (tells && report_.frozen.samples * 20 <= loss.usable && report_.frozen.longest_ns >= 1'000'000'000) {
      add(FindingKind::note, "frozen",
          fmt::format("a position stands still bit by bit for {:.0f} ms, from line {} on",
                      static_cast<double>(report_.frozen.longest_ns) * 1e-6, report_.frozen.longest_row),
          "the positions; values may be held there while the eye is lost");
    }
    if (log_.sample_age_unknown) {
      add(FindingKind::note, "age-unknown",
          fmt::format("a row was written once a frame of the display, so that a sample's age is unknown; {:.0f} % of "
                      "the samples repeat the one before",
                      100 * report_.frozen.repeated_share),
          "the format");
    }
    if (report_.disparity && report_.unit == "deg" && std::abs(report_.disparity->vertical) > 0.5) {
      add(FindingKind::note, "disparity",
          fmt::format("the eyes differ vertically by {:.2f} deg in the median, as after a poor calibration",
                      report_.disparity->vertical),
          fmt::format("{} pairs", report_.disparity->pairs));
    }
    if (const auto& display = log_.conventions.display;
        display && display->evidence == Evidence::statistics && log_.kind == GazeKind::screen) {
      add(FindingKind::note, "display-unknown",
          "the file does not state the display's size: this report assumes a usual one, and cannot tell which gaze "
          "was beside the display",
          "statistics: " + display->detail + "; every other command needs `screen-px` W,H");
    }
  }

  // Where most of what is beside the display lies.
  [[nodiscard]] std::string_view side_of_most() const {
    std::array<std::size_t, 4> count{};
    for (const GazeSample* const s : usable_) {
      count[0] += s->u < 0 ? 1 : 0;
      count[1] += s->u > 1 ? 1 : 0;
      count[2] += s->v < 0 ? 1 : 0;
      count[3] += s->v > 1 ? 1 : 0;
    }
    static constexpr std::array<std::string_view, 4> kSides{"left of", "right of", "above", "below"};
    return kSides[static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin())];
  }

  // A log that begins before the eye is found, or goes on after it was lost for good.
  void lost_ends() {
    constexpr double kLongNs = 1e9;
    constexpr double kLargeShare = 0.05;
    const GazeLoss& loss = report_.loss;
    const double span_ns = static_cast<double>(report_.timing.last_ns - report_.timing.first_ns);
    const auto is_long = [&](std::int64_t lost_ns) {
      return loss.usable > 0 && static_cast<double>(lost_ns) > std::max(kLongNs, kLargeShare * span_ns);
    };
    const auto in_words = [&](std::int64_t lost_ns) {
      return fmt::format("{:.0f} % of the log ({:.1f} s)", 100 * static_cast<double>(lost_ns) / span_ns,
                         static_cast<double>(lost_ns) * 1e-9);
    };
    if (is_long(loss.leading_ns)) {
      add(FindingKind::suspicion, "lost-beginning",
          fmt::format("the eye is not found in the first {}, up to line {}", in_words(loss.leading_ns),
                      loss.first_usable_row),
          "the log's own validity; begin later (`gaze-start`), or leave these rows out");
    }
    if (is_long(loss.trailing_ns)) {
      add(FindingKind::suspicion, "lost-end",
          fmt::format("the eye is lost for good in line {}: there is no gaze in the last {}", loss.last_usable_row,
                      in_words(loss.trailing_ns)),
          "the log's own validity; render fewer frames (`frames`), or leave these rows out");
    }
  }

  // A flipped axis cannot be found without a second account of the gaze.
  [[nodiscard]] std::string untested_axes() const {
    std::string names;
    for (const GazeAxisTest& test : report_.axes) {
      if (test.verdict == AxisVerdict::undecided) {
        names += fmt::format("{}{}", names.empty() ? "" : " and ", test.axis);
      }
    }
    return names.empty()
               ? ""
               : fmt::format("; the direction of {} could not be tested: the lines above say how to check it", names);
  }

  // Follows from the worst line: an open question, a fault or a suspicion, a note that nothing good can be said beside.
  // Says what to do next.
  void verdict() {
    std::string questions;
    std::string changes;  // what changes between parts
    std::string helpless;
    std::string notes;
    const auto append = [](std::string& to, const std::string& text) { to += (to.empty() ? "" : "; ") + text; };
    for (const GazeFinding& finding : report_.findings) {
      if (finding.kind == FindingKind::note) {
        const bool counts = finding.code == "off-screen" || finding.code == "lost" || finding.code == "rate" ||
                            finding.code == "frozen" || finding.code == "scene-camera";
        if (counts) {
          append(notes, finding.code == "scene-camera" ? finding.what + " (" + finding.evidence + ")" : finding.what);
        }
        continue;
      }
      changes = finding.code == "display-changes" ? finding.what + ", so " : changes;
      const bool has_alternatives = finding.setting.find(" or ") != std::string::npos;
      if (finding.is_open) {
        append(questions, fmt::format("{} {} {}", finding.what + (finding.what.ends_with('?') ? "" : "."),
                                      has_alternatives ? "Ask who recorded it, then give" : "Give", finding.setting));
      } else if (finding.setting.empty() || has_alternatives) {
        append(helpless, fmt::format("{} ({}{})", finding.what, finding.evidence,
                                     finding.setting.empty() ? "" : "; " + finding.setting));
      }
      if (!finding.setting.empty() && !has_alternatives &&
          std::find(report_.settings.begin(), report_.settings.end(), finding.setting) == report_.settings.end()) {
        report_.settings.push_back(finding.setting);
      }
    }
    if (!questions.empty()) {
      report_.verdict = "undecided, and other commands refuse the file until you state it: " + questions;
      report_.verdict += helpless.empty() ? "" : "; besides, no option alone mends this: " + helpless;
    } else if (report_.settings.empty()) {
      report_.verdict = !helpless.empty() ? "suspicious, and no option alone mends it: " + helpless
                                          : (notes.empty() ? "nothing suspicious was found" : "mind this: " + notes) +
                                                untested_axes();
    } else {
      const bool are_several =
          report_.settings.size() > 1 || report_.settings.front().find(" and ") != std::string::npos;
      report_.verdict = has_finding({"several-recordings", "display-changes"})
                            ? fmt::format("{}each part is read by itself: {} takes the first, 2 the second", changes,
                                          fmt::join(report_.settings, " "))
                            : fmt::format("{} mend{} it", fmt::join(report_.settings, " "), are_several ? "" : "s");
      report_.verdict += helpless.empty() ? "" : "; besides, no option alone mends this: " + helpless;
    }
    if (has_finding({"display-unknown"})) {
      report_.verdict +=
          "; other commands also need `screen-px` W,H: ask for the display's resolution, since the size "
          "above is a guess";
    }
  }

  const GazeLog& log_;
  const GazeUnderInspection* whole_;
  const GazeInspectOptions& options_;
  GazeInspection& report_;
  std::vector<const GazeSample*> usable_;  // only a part of them where the log is long
};

}  // namespace

void find_what_is_wrong(const GazeLog& log, const GazeUnderInspection* whole, const GazeInspectOptions& options,
                        GazeInspection& inspection) {
  Doctor(log, whole, options, inspection).examine();
}

}  // namespace gazetrace
