// SPDX-License-Identifier: Apache-2.0
#include "foveation_gain/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "foveation_gain/results.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace::gain {
namespace {

constexpr std::array<Metric, kMetrics> kAllMetrics{Metric::relmse, Metric::flip, Metric::jod};
constexpr std::array<const char*, kMetrics> kShownMetrics{"relMSE", "FLIP", "JOD"};

std::string metric_text(Metric metric) {
  return kShownMetrics.at(static_cast<std::size_t>(metric));
}
std::string error_text(Metric metric, double value) {
  return metric == Metric::jod ? fmt::format("{:.3f}", value) : fmt::format("{:.4f}", value);
}
std::string effect_text(Metric metric, double value) {
  return metric == Metric::relmse ? fmt::format("{:.3f}", value)
         : metric == Metric::flip ? fmt::format("{:+.4f}", value)
                                  : fmt::format("{:+.3f}", value);
}
std::string cell_text(const Comparison& c, Metric metric, bool with_interval) {
  if (c.leaves == 0) {
    return "-";
  }
  const std::string interval =
      with_interval ? fmt::format(" ({} .. {})", effect_text(metric, c.effect.low), effect_text(metric, c.effect.high))
                    : "";
  return fmt::format("{}{}{} {}{}", c.continued > 0 ? "~" : "", effect_text(metric, c.effect.value), interval,
                     verdict(c, metric), c.beneath_floor ? "*" : "");
}
std::string rate_text(const Interval& rate, bool with_interval) {
  const auto text = [](double r) {
    return r <= kUniformRates.front()  ? fmt::format("<{}", kUniformRates.front())
           : r >= kUniformRates.back() ? fmt::format(">{}", kUniformRates.back())
                                       : fmt::format("{:.2f}", r);
  };
  if (!std::isfinite(rate.value)) {
    return "-";
  }
  return text(rate.value) + (with_interval ? fmt::format(" ({} .. {})", text(rate.low), text(rate.high)) : "");
}

std::vector<std::size_t> columns_in_use(const Results& results) {
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < kColumns; ++c) {
    if (results.mean_share(c) > 0) {
      columns.push_back(c);
    }
  }
  return columns;
}

std::string rule(std::size_t cells) {
  std::string line = "|";
  for (std::size_t i = 0; i < cells; ++i) {
    line += " --- |";
  }
  return line + "\n";
}

std::string facts(const Results& results) {
  std::string text;
  for (const std::string& setup : results.setups()) {
    text += setup + "\n";
  }
  text += fmt::format(
      "{} scenes, {} gazes in all, {} models; samples of models and of uniform differ by {:.4f} % at most\n\n",
      results.scenes().size(), results.gazes(), results.models().size(), 100 * results.sample_deviation());
  const std::vector<std::size_t> columns = columns_in_use(results);
  text += "| degrees |";
  for (const std::size_t c : columns) {
    text += fmt::format(" {} |", column_name(c));
  }
  text += "\n" + rule(columns.size() + 1) + "| share of the pixels, % |";
  for (const std::size_t c : columns) {
    text += fmt::format(" {:.2f} |", 100 * results.mean_share(c));
  }
  for (const std::string& scene : results.scenes()) {
    for (const Metric metric : kAllMetrics) {
      text += fmt::format("\n| floor, {}, {} |", scene, metric_text(metric));
      for (const std::size_t c : columns) {
        text += " " + error_text(metric, results.mean_floor(metric, c, scene)) + " |";
      }
    }
  }
  return text + "\n";
}

std::string foveal_check(const Results& results) {
  constexpr std::size_t kFovea = 1;
  std::string text =
      "\nThe fovea of 32 / 16 / 8 against uniform with 32: relMSE ratio, FLIP difference; 1 and 0 expected but "
      "through\n"
      "filters that smooth uniform frames of any rate and leave full-rate foveae as they are (guided)\n\n"
      "| filter | scene | relMSE | FLIP |\n" +
      rule(4);
  std::vector<std::string> scenes = results.scenes();
  scenes.emplace_back();
  for (const std::string& filter : results.filters()) {
    for (const std::string& scene : scenes) {
      text += fmt::format("| {} | {} |", filter, scene.empty() ? "all" : scene);
      for (const Metric metric : {Metric::relmse, Metric::flip}) {
        const Comparison c = results.compare_arms(kPaper, kFovealRate, filter, metric, kFovea, scene);
        text += c.leaves == 0 ? " - |"
                              : fmt::format(" {} ({} .. {}) |", effect_text(metric, c.effect.value),
                                            effect_text(metric, c.effect.low), effect_text(metric, c.effect.high));
      }
      text += "\n";
    }
  }
  return text;
}

// The model's time over that of uniform with as many samples, over all scenes; the mean of the timed gazes.
std::string time_ratios(const Results& results) {
  if (!results.has_times()) {
    return "\nNo times were measured: nothing is said about equal time.\n";
  }
  std::string text = "\nTime by that of uniform with as many samples and the same filter, scene by scene\n\n| model |";
  for (const std::string& filter : results.filters()) {
    text += " " + filter + " |";
  }
  text += "\n" + rule(results.filters().size() + 1);
  for (const std::string& model : results.models()) {
    text += "| " + model + " |";
    for (const std::string& filter : results.filters()) {
      for (const std::string& scene : results.scenes()) {
        const auto own = results.time_ms(scene, model, filter, "");
        const auto other = results.time_ms(scene, uniform_arm(1), filter, kAnyGaze);
        text += own && other ? fmt::format(" {:.2f}", *own / *other) : " -";
      }
      text += " |";
    }
    text += "\n";
  }
  return text;
}

// Models from the one that does best.
std::vector<std::string> ranked(const Results& results, const std::string& filter, Rival rival) {
  std::map<std::string, double> ratio;
  for (const std::string& model : results.models()) {
    const double value = results.compare(model, filter, rival, Metric::relmse, 0).effect.value;
    ratio[model] = std::isfinite(value) ? value : 1e30;
  }
  std::vector<std::string> models = results.models();
  std::stable_sort(models.begin(), models.end(), [&](const auto& a, const auto& b) { return ratio[a] < ratio[b]; });
  return models;
}

std::string summary(const Results& results, const std::string& filter) {
  const Rival main_rival = results.has_times() ? Rival::equal_time : Rival::equal_samples;
  std::vector<std::size_t> columns = columns_in_use(results);
  columns.erase(columns.begin());
  std::string text = fmt::format("\n## {}\n\n| model | metric | error |", filter);
  for (const char* name : kRivalNames) {
    text += fmt::format(" {} |", name);
  }
  text += " as uniform at |";
  for (const std::size_t c : columns) {
    text += fmt::format(" {} |", column_name(c));
  }
  text += "\n" + rule(4 + kRivals.size() + columns.size());
  for (const std::string& model : ranked(results, filter, main_rival)) {
    for (const Metric metric : kAllMetrics) {
      const Comparison first = results.compare(model, filter, Rival::equal_samples, metric, 0);
      if (first.leaves == 0) {
        continue;
      }
      text += fmt::format("| {} | {} | {} |", model, metric_text(metric), error_text(metric, first.own));
      for (const Rival rival : kRivals) {
        text += " " + cell_text(results.compare(model, filter, rival, metric, 0), metric, false) + " |";
      }
      text += " " + rate_text(results.equal_rate(model, filter, metric), false) + " |";
      for (const std::size_t c : columns) {
        text += " " + cell_text(results.compare(model, filter, main_rival, metric, c), metric, false) + " |";
      }
      text += "\n";
    }
  }
  return text;
}

std::string full_table(const Results& results) {
  std::string text = "| filter | model | metric | degrees | share, % | own |";
  for (const char* name : kRivalNames) {
    text += fmt::format(" {}: error | own against it |", name);
  }
  text += " as uniform at |\n" + rule(7 + 2 * kRivals.size());
  std::size_t continued = 0;
  std::size_t timed = 0;
  for (const std::string& filter : results.filters()) {
    for (const std::string& model : results.models()) {
      for (const Metric metric : kAllMetrics) {
        for (const std::size_t c : columns_in_use(results)) {
          std::string line;
          double own = std::numeric_limits<double>::quiet_NaN();
          for (const Rival rival : kRivals) {
            const Comparison r = results.compare(model, filter, rival, metric, c);
            line += fmt::format(" {} | {} |", r.leaves == 0 ? "-" : error_text(metric, r.other),
                                cell_text(r, metric, true));
            own = r.leaves == 0 ? own : r.own;
            continued += r.continued;
            timed += rival == Rival::equal_time ? r.leaves : 0;
          }
          text += fmt::format("| {} | {} | {} | {} | {:.2f} | {} |{}", filter, model, metric_text(metric),
                              column_name(c), 100 * results.mean_share(c), error_text(metric, own), line);
          text += " " + (c == 0 ? rate_text(results.equal_rate(model, filter, metric), true) : std::string()) + " |\n";
        }
      }
    }
  }
  return text + fmt::format(
                    "\n{} of {} errors at equal time lie beyond the measured times, on the line through the "
                    "last two.\n",
                    continued, timed);
}

}  // namespace

void print_tables(const std::vector<std::string>& files, const std::string& full_path) {
  std::vector<Row> rows;
  for (const std::string& file : files) {
    const std::vector<Row> more = read_rows(file);
    if (more.empty()) {
      throw Error(ErrorKind::input, file, "has no rows", "measure some first");
    }
    rows.insert(rows.end(), more.begin(), more.end());
  }
  const Results results(rows);
  fmt::print("{}{}{}", facts(results), foveal_check(results), time_ratios(results));
  fmt::print(
      "\nFor each filter, models against uniform through the same filter, the best first. relMSE: ratio, under 1 is "
      "better;\nFLIP: difference, under 0 is better; JOD: difference, over 0 is better. wins, loses: the 95 % interval "
      "over scenes,\ngazes and seeds lies on one side; even: it does not. Each interval stands by itself: of all "
      "these, "
      "one in twenty says wins\nor loses by chance. few: under {} gazes; *: beneath the reference's floor; ~: some, "
      "beyond: most of it at times beyond the\nmeasured ones. Intervals at equal time know nothing of how times "
      "scatter "
      "between rounds and between timed and other gazes.\n\"As uniform at\": times the budget. Bands of degrees: at "
      "{}.\n",
      kFewestGazes, results.has_times() ? "equal time" : "equal samples");
  for (const std::string& filter : results.filters()) {
    fmt::print("{}", summary(results, filter));
    std::fflush(stdout);
  }
  if (!full_path.empty()) {
    std::ofstream file(full_path);
    file << facts(results) << foveal_check(results) << time_ratios(results) << '\n' << full_table(results);
    if (!file.flush()) {
      throw Error(ErrorKind::runtime, full_path, "cannot be written", "check the folder and the disk");
    }
  }
}

}  // namespace gazetrace::gain
