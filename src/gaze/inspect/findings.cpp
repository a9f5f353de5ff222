// SPDX-License-Identifier: Apache-2.0
// From measurements to what is wrong, why that is thought, and the option that mends it. What only statistics say is a
// suspicion; where nothing in the log speaks for or against, the answer is undecided.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "gaze/inspect/inspect.hpp"

namespace gazetrace {
namespace {

constexpr std::string_view kPositionUnit = "position-unit";
constexpr double kPlausibleLowHz = 5, kPlausibleHighHz = 5000;

class Doctor {
 public:
  Doctor(const GazeLog& log, const GazeInspectOptions& options, GazeInspection& report)
      : log_(log), options_(options), report_(report) {
    for (const GazeSample& sample : log.samples) {
      if (is_usable(sample.validity)) {
        usable_.push_back(&sample);
      }
      if (usable_.size() > kMostLookedAt) {
        break;
      }
    }
    if (usable_.size() > kMostLookedAt) {
      // Every n-th of the whole log.
      usable_.clear();
      const std::size_t stride = log.samples.size() / kMostLookedAt + 1;
      for (std::size_t i = 0; i < log.samples.size(); i += stride) {
        if (is_usable(log.samples[i].validity)) {
          usable_.push_back(&log.samples[i]);
        }
      }
    }
  }

  void examine() {
    faults_of_reading();
    time_unit();
    const bool unit_is_wrong = position_unit();
    zeros();
    recurring_place();
    if (!examine_axes(log_, unit_is_wrong, report_)) {
      swapped_by_extent();
    }
    rest();
    verdict();
  }

 private:
  static constexpr std::size_t kMostLookedAt = 200'000;

  void add(FindingKind kind, std::string code, std::string what, std::string evidence, std::string flag = {}) {
    report_.findings.push_back({kind, std::move(code), std::move(what), std::move(evidence), std::move(flag)});
  }
  [[nodiscard]] const GazeFact* fact(std::string_view what) const { return find_fact(log_, what); }
  [[nodiscard]] std::string fact_text(std::string_view what) const {
    const GazeFact* const found = fact(what);
    return found == nullptr ? "" : found->value;
  }

  void faults_of_reading() {
    const GazeOrder& order = log_.order;
    const bool repeats = order.duplicates > 0 && order.identical_duplicates * 10 >= order.duplicates * 9;
    bool said = false;
    for (const GazeFault& fault : log_.faults) {
      if (fault.code == kPositionUnit) {
        add(FindingKind::suspicion, fault.code, fault.problem, "statistics: the sizes of the positions", fault.flag);
        continue;
      }
      if (fault.code != "unordered" && fault.code != "duplicates") {
        add(FindingKind::fault, fault.code, fault.problem, "the rows themselves", fault.flag);
        continue;
      }
      if (said) {
        continue;  // a repeated block goes back in time as well: one finding is enough
      }
      said = true;
      const std::string seen = fmt::format("{} of {} rows go back in time, {} stand at a time that is there already",
                                           order.backward_steps, order.rows, order.duplicates);
      if (order.backward_steps * 50 > order.rows) {
        add(FindingKind::fault, "unordered", "the rows are not in the order of time: " + fault.problem, seen,
            fault.flag);
      } else if (repeats) {
        add(FindingKind::fault, "repeated-rows",
            fmt::format("{} rows are repeated, the first in line {}", order.duplicates, order.first_duplicate_row),
            fmt::format("{}; {} of these have the same position, too", seen, order.identical_duplicates), fault.flag);
      } else if (order.duplicates > 0 && order.backward_steps == 0) {
        add(FindingKind::fault, "duplicates",
            fmt::format("{} rows stand at the time of another row with another position: {}", order.duplicates,
                        fault.problem),
            seen, fault.flag);
      } else if (order.longest_backward_ns > 1'000'000'000) {
        add(FindingKind::fault, "clock-restarts",
            fmt::format("the clock starts again {} {}, the first time in line {}", order.backward_steps,
                        order.backward_steps == 1 ? "time" : "times", order.first_backward_row),
            seen + "; sorting would mix the parts: give each a file of its own");
      } else {
        add(FindingKind::fault, "unordered", "some rows are not in the order of time: " + fault.problem, seen,
            fault.flag);
      }
    }
  }

  // The unit of stamps whose exponent differs by `shift` powers of ten, as an option; empty where there is none.
  [[nodiscard]] std::string time_unit_flag(int shift) const {
    static constexpr std::array<std::pair<std::string_view, int>, 4> kUnits{
        {{"ns", 0}, {"us", 3}, {"ms", 6}, {"s", 9}}};
    const std::string now = fact_text("time unit");
    for (const auto& [name, exponent] : kUnits) {
      if (name != now) {
        continue;
      }
      for (const auto& [other, wanted] : kUnits) {
        if (wanted == exponent + shift) {
          return fmt::format("--gaze-time-unit {}", other);
        }
      }
    }
    return {};
  }

  void time_unit() {
    const double rate = report_.timing.median_rate_hz;
    if (log_.samples.size() < 10 || !(rate > 0)) {
      return;
    }
    const double nominal = log_.nominal_rate_hz;
    // Decimal powers between what is read and what is meant.
    for (const int shift : {3, 6, 9, -3, -6, -9}) {
      const double meant = rate * std::pow(10.0, -shift);
      const std::string flag = time_unit_flag(shift);
      if (flag.empty()) {
        continue;
      }
      if (nominal > 0) {
        if (meant / nominal > 0.5 && meant / nominal < 2) {
          add(FindingKind::fault, "time-unit",
              fmt::format("the stamps are not in {}: the log states {:.6g} Hz, and its stamps give {:.4g} Hz",
                          fact_text("time unit"), nominal, rate),
              fmt::format("the stated rate against the median step; the two differ by 10^{}", shift), flag);
          return;
        }
      } else if ((rate > kPlausibleHighHz || rate < kPlausibleLowHz) && meant >= 20 && meant <= 2100) {
        add(FindingKind::suspicion, "time-unit",
            fmt::format("the stamps can hardly be in {}: they give {:.4g} Hz, {:.4g} Hz in the other unit",
                        fact_text("time unit"), rate, meant),
            "statistics: the median step against the rates that eye trackers have", flag);
        return;
      }
    }
    if (nominal > 0 && (rate / nominal > 1.2 || rate / nominal < 0.83)) {
      add(FindingKind::note, "rate", fmt::format("the log states {:.6g} Hz, its stamps give {:.6g} Hz", nominal, rate),
          "the stated rate against the median step");
    }
  }

  // Quantiles of a coordinate in the file's unit, as far as that can be told back.
  struct Extent {
    double low, median, high;
  };
  [[nodiscard]] Extent extent(double scale, double GazeSample::*coordinate) const {
    std::vector<double> values;
    values.reserve(usable_.size());
    for (const GazeSample* const sample : usable_) {
      values.push_back(sample->*coordinate * scale);
    }
    return {quantile(values, 0.05), quantile(values, 0.5), quantile(values, 0.95)};
  }

  bool position_unit() {
    if (std::any_of(log_.faults.begin(), log_.faults.end(),
                    [](const GazeFault& fault) { return fault.code == kPositionUnit; })) {
      return true;  // was seen before degrees and lengths became places
    }
    const std::string unit = fact_text("position unit");
    if (log_.kind == GazeKind::direction || usable_.size() < 10 || (unit != "px" && unit != "fraction")) {
      return false;
    }
    const Vec2d size = unit == "px" ? picture_px() : Vec2d{1, 1};
    if (!(size.x > 0)) {
      return false;
    }
    Extent x = extent(size.x, &GazeSample::u);
    Extent y = extent(size.y, &GazeSample::v);
    const std::string seen = fmt::format("90 % of x lie in {:.4g} .. {:.4g}, of y in {:.4g} .. {:.4g} {}", x.low,
                                         x.high, y.low, y.high, unit);
    const bool both_signs = (x.low < 0 && x.high > 0) || (y.low < 0 && y.high > 0);
    const auto within = [&](double most) {
      return std::max({std::abs(x.low), std::abs(x.high), std::abs(y.low), std::abs(y.high)}) < most;
    };
    const bool from_top_left = fact_text("origin") == "top-left";
    const bool guessed = fact("position unit")->evidence == Evidence::statistics;
    if (guessed) {
      return false;
    }
    const double spread = std::max(x.high - x.low, y.high - y.low);
    if (unit == "px" && within(1.5) && spread > 0.02) {
      add(FindingKind::suspicion, "position-unit", "the positions are no pixels but fractions of the display",
          "statistics: " + seen, "--gaze-unit fraction");
      return true;
    }
    if (unit == "px" && both_signs && within(60) && within(0.12 * size.x) && spread > 0.5) {
      add(FindingKind::suspicion, "position-unit", "the positions are no pixels but degrees from straight ahead",
          "statistics: " + seen, "--gaze-unit deg");
      return true;
    }
    if (unit == "fraction" && !within(5)) {
      add(FindingKind::suspicion, "position-unit", "the positions are no fractions of the display but pixels",
          "statistics: " + seen, "--gaze-unit px");
      return true;
    }
    if (from_top_left && log_.kind == GazeKind::screen) {
      const auto centred = [](const Extent& e) {
        return e.low < 0 && e.high > 0 && std::abs(e.median) < 0.25 * (e.high - e.low);
      };
      const bool fits = x.high - x.low <= 1.05 * size.x && y.high - y.low <= 1.05 * size.y;
      if (centred(x) && centred(y) && fits && spread > 0.05 * size.x) {
        add(FindingKind::suspicion, "origin", "the positions count from the center of the display, not its top left",
            "statistics: " + seen, "--gaze-origin center");
        return true;
      }
    }
    return false;
  }

  // Of the display or the scene camera's picture; by a guess where the log was looked at with one.
  [[nodiscard]] Vec2d picture_px() const {
    const DisplayGeometry given = options_.display.value_or(DisplayGeometry{});
    if (given.width_px > 0) {
      return {static_cast<double>(given.width_px), static_cast<double>(given.height_px)};
    }
    if (const auto& g = log_.recording_geometry; g && g->width_px > 0) {
      return {static_cast<double>(g->width_px), static_cast<double>(g->height_px)};
    }
    const std::string text = fact_text(log_.kind == GazeKind::scene_camera ? "picture size" : "display size");
    int width = 0;
    int height = 0;
    return std::sscanf(text.c_str(), "%dx%d", &width, &height) == 2
               ? Vec2d{static_cast<double>(width), static_cast<double>(height)}
               : Vec2d{};
  }

  void zeros() {
    const std::size_t zeros = log_.zero_positions;
    if (zeros < 3 || zeros * 2000 < log_.order.rows) {
      return;
    }
    // Straight ahead in degrees is a place like any other: only zeros that come and go by a jump are none.
    if (fact_text("origin") == "center" && zeros * 200 < log_.order.rows) {
      return;
    }
    add(FindingKind::suspicion, "zero-missing",
        fmt::format("{} of {} rows are exactly at (0, 0) and count as good: missing values written as zeros", zeros,
                    log_.order.rows),
        "statistics: noise never gives exact zeros in both axes that often", "--gaze-zero-missing");
  }

  void recurring_place() {
    if (!log_.recurring_place) {
      return;
    }
    const RecurringPlace& place = *log_.recurring_place;
    const bool is_vector = log_.kind == GazeKind::direction && fact_text("position unit") != "deg";
    const std::string where = is_vector && place.x == 0 ? "straight ahead"
                              : is_vector               ? fmt::format("at ({0}, {0}, {0})", place.x)
                                                        : fmt::format("at ({}, {})", place.x, place.y);
    const bool option_takes_it = place.x == place.y && place.x != 0;
    add(FindingKind::suspicion, "missing-value",
        fmt::format("{} of {} rows are exactly {} and count as good: a mark of missing values", place.rows,
                    log_.order.rows, where),
        "statistics: gaze comes to this place again and again, and by jumps",
        option_takes_it ? fmt::format("--gaze-missing-value {}", place.x) : "");
  }

  // More than a display's height but never its width.
  void swapped_by_extent() {
    const Vec2d size = picture_px();
    if (log_.kind != GazeKind::screen || fact_text("position unit") != "px" || !(size.x > 1.2 * size.y) ||
        usable_.size() < 50) {
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
      const auto share = [&](std::size_t n) {
        return 100 * static_cast<double>(n) / static_cast<double>(usable_.size());
      };
      add(FindingKind::suspicion, "swapped-axes", "the axes seem to be exchanged",
          fmt::format("statistics: {:.0f} % of the samples lie beside the display, {:.0f} % with x and y exchanged",
                      share(beside), share(beside_swapped)),
          "--gaze-swap-xy");
    }
  }

  void rest() {
    const GazeLoss& loss = report_.loss;
    const auto share = [&](std::size_t n) {
      return loss.samples > 0 ? static_cast<double>(n) / static_cast<double>(loss.samples) : 0;
    };
    if (log_.kind == GazeKind::scene_camera) {
      add(FindingKind::note, "scene-camera",
          "the gaze lies on the picture of a camera on the head: it can be looked at and converted, but is no place on "
          "a display to render from",
          "the format; where the log has directions, --gaze-frame head takes them; else map gaze onto the display");
    }
    if (loss.usable == 0) {
      add(FindingKind::suspicion, "nothing-usable", "no sample is usable",
          "check which column says what is valid: --gaze-validity-column, --gaze-valid-values");
    } else if (share(loss.usable) < 0.5) {
      add(FindingKind::note, "lost", fmt::format("only {:.1f} % of the samples are usable", 100 * share(loss.usable)),
          "the log's own validity");
    }
    const std::size_t beside = loss.by_validity[static_cast<std::size_t>(GazeValidity::off_screen)];
    if (share(beside) > 0.2) {
      add(FindingKind::note, "off-screen",
          fmt::format("{:.1f} % of the samples lie beside the display", 100 * share(beside)),
          "positions outside 0..1 of the display");
    }
    const bool are_marks = std::any_of(report_.findings.begin(), report_.findings.end(), [](const GazeFinding& f) {
      return f.code == "zero-missing" || f.code == "missing-value";
    });
    const bool tells = !are_marks && !log_.sample_age_unknown;  // marks stand still, too, and are told already
    if (tells && report_.frozen.samples * 20 > loss.usable && report_.frozen.runs > 0) {
      add(FindingKind::suspicion, "frozen",
          fmt::format("positions stand still bit by bit in {} runs, the longest of {:.0f} ms in line {}",
                      report_.frozen.runs, static_cast<double>(report_.frozen.longest_ns) * 1e-6,
                      report_.frozen.longest_row),
          "data held while the eye was lost, or a logger that repeats; a validity column would tell "
          "(--gaze-validity-column)");
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
    if (const GazeFact* const size = fact("display size");
        size != nullptr && size->evidence == Evidence::statistics && log_.kind == GazeKind::screen) {
      add(FindingKind::note, "display-unknown",
          "the display's size is not stated; a usual one was taken to look at the log, and what is beside it is not "
          "known",
          "statistics: " + size->detail + "; reading for anything else needs --screen-px W,H");
    }
  }

  // A flipped axis without a second account of the gaze is nothing that could have been found.
  [[nodiscard]] std::string untested_axes() const {
    std::string names;
    for (const GazeAxisTest& test : report_.axes) {
      if (test.verdict == AxisVerdict::undecided) {
        names += fmt::format("{}{}", names.empty() ? "" : " and ", test.axis);
      }
    }
    return names.empty() ? "" : fmt::format("; the direction of {} could not be tested", names);
  }

  void verdict() {
    std::size_t faults = 0;
    std::size_t helpless = 0;
    for (const GazeFinding& finding : report_.findings) {
      if (finding.kind == FindingKind::note) {
        continue;
      }
      ++faults;
      helpless += finding.flag.empty() ? 1 : 0;
      if (!finding.flag.empty() &&
          std::find(report_.flags.begin(), report_.flags.end(), finding.flag) == report_.flags.end()) {
        report_.flags.push_back(finding.flag);
      }
    }
    if (faults == 0) {
      report_.verdict = "nothing suspicious was found" + untested_axes();
    } else if (report_.flags.empty()) {
      report_.verdict = "suspicious, and no option mends it";
    } else {
      report_.verdict = fmt::format("{}{}", fmt::join(report_.flags, " "),
                                    helpless > 0 ? " mends a part of it; the rest no option mends" : " mends it");
    }
  }

  const GazeLog& log_;
  const GazeInspectOptions& options_;
  GazeInspection& report_;
  std::vector<const GazeSample*> usable_;  // of a long log, a part
};

}  // namespace

const GazeFact* find_fact(const GazeLog& log, std::string_view what) {
  const auto found =
      std::find_if(log.facts.rbegin(), log.facts.rend(), [&](const GazeFact& f) { return f.what == what; });
  return found == log.facts.rend() ? nullptr : &*found;
}

void conclude(const GazeLog& log, const GazeInspectOptions& options, GazeInspection& inspection) {
  Doctor(log, options, inspection).examine();
}

}  // namespace gazetrace
