// SPDX-License-Identifier: Apache-2.0
// Finds the directions of the axes from second accounts of the gaze in the same file, from the vestibulo-ocular reflex,
// and from comparing one eye with the other.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gaze/inspect/inspect.hpp"

namespace gazetrace {
namespace {

constexpr double kWitnessAgrees = 0.6;  // correlation from which a witness counts
constexpr std::size_t kFewestPairs = 50;

class Axes {
 public:
  Axes(const GazeLog& log, GazeInspection& report) : log_(log), report_(report) {}

  // Whether the axes are exchanged, or cannot be tested.
  bool examine(bool unit_is_wrong) {
    for (const char axis : {'x', 'y'}) {
      report_.axes.push_back(
          {axis, AxisVerdict::undecided,
           fmt::format("the log holds nothing to test it against, so {} could be exchanged. To check it, find a moment "
                       "when the person looked at something {}, and see in 'gazetrace gaze report' whether the gaze "
                       "goes there",
                       axis == 'x' ? "left and right" : "up and down", axis == 'x' ? "on the left" : "at the top")});
    }
    if (unit_is_wrong) {
      report_.axes[0].evidence = report_.axes[1].evidence = "not tested: the unit or the origin is wrong";
      return true;
    }
    bool swapped = false;
    for (const GazeWitness& w : log_.witnesses) {
      if (!is_of_this_gaze(w)) {
        continue;
      }
      const bool across = std::abs(w.xy) > kWitnessAgrees && std::abs(w.yx) > kWitnessAgrees;
      const bool along = std::abs(w.xx) > kWitnessAgrees || std::abs(w.yy) > kWitnessAgrees;
      if (across && !along) {
        if (swapped) {
          continue;
        }
        swapped = true;
        add_finding(report_, FindingKind::fault, "swapped-axes", "the axes are exchanged",
                    fmt::format("gaze x goes with y of {} (r = {:.2f}), and y with its x (r = {:.2f}), {} values",
                                w.what, w.xy, w.yx, w.count),
                    "`swap-xy`");
        continue;
      }
      if (speaks_for_gaze('x')) {
        witness(w.what, w.count, w.xx, report_.axes[0]);
      }
      if (speaks_for_gaze('y')) {
        witness(w.what, w.count, w.yy, report_.axes[1]);
      }
    }
    for (const VorTest& test : report_.vor) {
      vor(test, report_.axes[test.axis == 'x' ? 0 : 1]);
    }
    for (const GazeAxisTest& test : report_.axes) {
      if (test.verdict == AxisVerdict::flipped) {
        const bool by_vor = test.evidence.starts_with("vestibulo");
        add_finding(report_, by_vor ? FindingKind::suspicion : FindingKind::fault, fmt::format("{}-flip", test.axis),
                    test.axis == 'x' ? "left and right are exchanged" : "top and bottom are exchanged", test.evidence,
                    fmt::format("`flip-{}`", test.axis));
      }
    }
    one_eye_told();
    one_eye_flipped();
    return swapped;
  }

 private:
  static void witness(const std::string& what, std::size_t count, double r, GazeAxisTest& test) {
    if (std::isnan(r) || std::abs(r) < kWitnessAgrees || test.verdict != AxisVerdict::undecided) {
      return;
    }
    test.verdict = r > 0 ? AxisVerdict::confirmed : AxisVerdict::flipped;
    test.evidence = fmt::format("against {} in the same file: {} (r = {:.2f}, {} values)", what,
                                r > 0 ? "the same way" : "the other way", r, count);
  }

  static void vor(const VorTest& vor, GazeAxisTest& test) {
    if (test.verdict != AxisVerdict::undecided) {
      return;
    }
    test.verdict = vor.verdict;
    if (vor.stretches == 0) {
      test.evidence =
          "the head turns too little about it to tell. To decide it, record while the wearer looks at one thing and "
          "turns the head to and fro";
      return;
    }
    test.evidence = fmt::format(
        "vestibulo-ocular reflex: gaze in the world moves by {:.1f} deg/s as read and {:.1f} deg/s with {} turned, and "
        "is steadier as read in {} of {} stretches of head movement",
        vor.speed_as_read_deg_s, vor.speed_flipped_deg_s, vor.axis, vor.steadier_as_read, vor.stretches);
    if (vor.verdict == AxisVerdict::flipped) {
      test.evidence += "; the head's axes could be the wrong ones instead";
    }
  }

  // The eye that was taken alone where the log has two.
  [[nodiscard]] std::optional<Eye> only_eye() const {
    const auto& taken = log_.conventions.eye_taken;
    if (!taken || !taken->value.is_alone) {
      return std::nullopt;
    }
    return taken->value.eye == Conventions::TakenEye::left ? Eye::left : Eye::right;
  }

  // For the gaze of one eye alone, the witnesses of that eye count, where it has any.
  [[nodiscard]] bool is_of_this_gaze(const GazeWitness& witness) const {
    const std::optional<Eye> only = only_eye();
    if (!only || witness.eye == only) {
      return true;
    }
    return !witness.eye && std::none_of(log_.witnesses.begin(), log_.witnesses.end(),
                                        [&](const GazeWitness& w) { return w.eye == only; });
  }

  [[nodiscard]] bool both_eyes_are_in_use() const {
    return !only_eye() && report_.disparity && report_.disparity->pairs >= kFewestPairs;
  }
  [[nodiscard]] double correlation_of_eyes(char axis) const {
    if (!both_eyes_are_in_use()) {
      return 0;
    }
    return axis == 'x' ? report_.disparity->horizontal_correlation : report_.disparity->vertical_correlation;
  }
  // Decided by their positions or, where gaze hardly moves along the axis, by the witnesses of each eye.
  [[nodiscard]] bool eyes_oppose(char axis) const {
    if (!both_eyes_are_in_use()) {
      return false;
    }
    const double r = correlation_of_eyes(axis);
    const AxisVerdict left = eye_verdict(Eye::left, axis);
    const AxisVerdict right = eye_verdict(Eye::right, axis);
    const bool both_speak = left != AxisVerdict::undecided && right != AxisVerdict::undecided;
    return r < -kWitnessAgrees || (both_speak && left != right && !(r > kWitnessAgrees));
  }

  static double along(const GazeWitness& witness, char axis) { return axis == 'x' ? witness.xx : witness.yy; }
  static AxisVerdict verdict_of(double r) {
    return !(std::abs(r) > kWitnessAgrees) ? AxisVerdict::undecided
           : r > 0                         ? AxisVerdict::confirmed
                                           : AxisVerdict::flipped;
  }

  // The witness of one eye that tells about an axis; null: there is none.
  [[nodiscard]] const GazeWitness* eye_witness(Eye eye, char axis) const {
    const auto found = std::find_if(log_.witnesses.begin(), log_.witnesses.end(), [&](const GazeWitness& w) {
      return w.eye == eye && verdict_of(along(w, axis)) != AxisVerdict::undecided;
    });
    return found == log_.witnesses.end() ? nullptr : &*found;
  }
  [[nodiscard]] AxisVerdict eye_verdict(Eye eye, char axis) const {
    const GazeWitness* const witness = eye_witness(eye, axis);
    return witness == nullptr ? AxisVerdict::undecided : verdict_of(along(*witness, axis));
  }

  // With both eyes in use, a witness of one eye counts for the other only where both move the same way. A witness that
  // states no eye may hold the values of one eye alone.
  [[nodiscard]] bool speaks_for_gaze(char axis) const {
    if (!both_eyes_are_in_use() || correlation_of_eyes(axis) > kWitnessAgrees) {
      return true;
    }
    return !eyes_oppose(axis) && eye_verdict(Eye::left, axis) == eye_verdict(Eye::right, axis);
  }

  // There is a witness of one eye, but neither a witness nor the positions of the other eye show that it moves the same
  // way.
  void one_eye_told() {
    for (const char axis : {'x', 'y'}) {
      GazeAxisTest& test = report_.axes[axis == 'x' ? 0 : 1];
      if (test.verdict != AxisVerdict::undecided || !both_eyes_are_in_use() || eyes_oppose(axis)) {
        continue;
      }
      const GazeWitness* const left = eye_witness(Eye::left, axis);
      const GazeWitness* const told = left != nullptr ? left : eye_witness(Eye::right, axis);
      if (told == nullptr) {
        continue;
      }
      const std::string_view other = told->eye == Eye::left ? "right" : "left";
      witness(told->what, told->count, along(*told, axis), test);
      const bool flipped = test.verdict == AxisVerdict::flipped;
      test.verdict = AxisVerdict::undecided;
      test.evidence += fmt::format("; nothing tells of the {} eye", other);
      if (flipped) {
        add_finding(report_, FindingKind::fault, fmt::format("{}-flip", axis),
                    fmt::format("{} of the {} eye are exchanged", axis == 'x' ? "left and right" : "top and bottom",
                                to_string(*told->eye)),
                    test.evidence, fmt::format("`flip-{}`", axis));
        add_finding(report_, FindingKind::suspicion, "one-eye-untested",
                    fmt::format("which way {} of the {} eye runs could not be tested", axis, other), test.evidence,
                    fmt::format("`gaze-eye` {}", to_string(*told->eye)));
      }
    }
  }

  void one_eye_flipped() {
    for (const char axis : {'x', 'y'}) {
      if (!eyes_oppose(axis)) {
        continue;
      }
      if (GazeAxisTest& test = report_.axes[axis == 'x' ? 0 : 1]; test.verdict == AxisVerdict::undecided) {
        test.evidence = "the eyes go opposite ways along it";
      }
      const AxisVerdict left = eye_verdict(Eye::left, axis);
      const AxisVerdict right = eye_verdict(Eye::right, axis);
      const bool told = left != right;
      const bool left_is_good =
          left == AxisVerdict::confirmed || (left == AxisVerdict::undecided && right == AxisVerdict::flipped);
      const std::string which = !told          ? "one of them, left or right, it cannot be told,"
                                : left_is_good ? "the right one"
                                               : "the left one";
      add_finding(report_, FindingKind::fault, "one-eye-flipped",
                  fmt::format("the eyes go opposite ways along {}: {} has this axis the other way round", axis, which),
                  evidence_of_opposed_eyes(axis),
                  !told          ? ""
                  : left_is_good ? "`gaze-eye` left"
                                 : "`gaze-eye` right");
    }
  }

  [[nodiscard]] std::string evidence_of_opposed_eyes(char axis) const {
    const double r = correlation_of_eyes(axis);
    if (r < -kWitnessAgrees) {
      return fmt::format("r = {:.2f} between left and right eye, {} pairs", r, report_.disparity->pairs);
    }
    const GazeWitness& left = *eye_witness(Eye::left, axis);
    const GazeWitness& right = *eye_witness(Eye::right, axis);
    return fmt::format("against {} r = {:.2f}, {} values; against {} r = {:.2f}, {} values", left.what,
                       along(left, axis), left.count, right.what, along(right, axis), right.count);
  }

  const GazeLog& log_;
  GazeInspection& report_;
};

}  // namespace

bool examine_axes(const GazeLog& log, bool unit_is_wrong, GazeInspection& inspection) {
  return Axes(log, inspection).examine(unit_is_wrong);
}

}  // namespace gazetrace
