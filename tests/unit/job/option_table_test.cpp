// SPDX-License-Identifier: Apache-2.0
// The table of the options of a job: how many rows it has, and that each row knows its value's place and type.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "gazetrace/job.hpp"

namespace gazetrace::option_table_test {
namespace {

constexpr std::size_t kMostRows = 120;

TEST(OptionTable, HasNoMoreRowsThanPeopleCanChooseFrom) {
  EXPECT_LE(job_schema().options().size(), kMostRows)
      << "a new option takes the place of another: take one away that the book of measurements does not speak for, or "
         "make it what the program does (src/job/schema/renamed_options.def tells its users)";
}

TEST(OptionTable, NamesAreUnique) {
  std::set<std::string> names;
  for (const Option* option : job_schema().list()) {
    EXPECT_TRUE(names.insert(option->name).second) << option->name;
  }
}

// A text that the option takes, beside its default; empty: none is known for its type.
std::string other_text(const OptionOf<JobSettings>& option) {
  static const std::map<std::string, std::string> kByUnit{{"FILE", "x.csv"}, {"NAME", "x"}};
  if (option.shape == OptionShape::flag) {
    return option.defaults == std::vector<std::string>{"true"} ? "false" : "true";
  }
  if (const std::size_t bar = option.unit.find('|'); bar != std::string::npos) {
    const std::string last = option.unit.substr(option.unit.rfind('|') + 1);
    return last.find_first_not_of("abcdefghijklmnopqrstuvwxyz-0123456789") == std::string::npos ? last : "";
  }
  const auto known = kByUnit.find(option.unit);
  return known != kByUnit.end() ? known->second : option.unit == "N" || option.unit == "DEG" ? "3" : "";
}

// Setting one option changes its own value and no other's: no two rows name one place, and none a wrong one.
TEST(OptionTable, EachRowHasAPlaceOfItsOwn) {
  std::size_t tried = 0;
  for (const OptionOf<JobSettings>& option : job_schema().options()) {
    const std::string text = other_text(option);
    try {
      option.check({text}, option.name);
    } catch (const Error&) {
      continue;
    }
    JobSettings settings;
    option.assign(settings, {text}, option.name);
    if (text.empty() || option.values(settings) == option.defaults) {
      continue;
    }
    ++tried;
    for (const OptionOf<JobSettings>& other : job_schema().options()) {
      // A density is said only while it is chosen.
      if (&other != &option && !(option.name == "sampling" && other.name == "density")) {
        EXPECT_EQ(other.values(settings), other.defaults) << option.name << " changes " << other.name;
      }
    }
  }
  EXPECT_GT(tried, job_schema().options().size() / 3);
}

TEST(OptionTable, ValuesThatAreRefusedChangeNothing) {
  for (const OptionOf<JobSettings>& option : job_schema().options()) {
    JobSettings settings;
    if (option.shape == OptionShape::flag) {
      EXPECT_THROW(option.check({"perhaps"}, option.name), Error) << option.name;
      EXPECT_THROW(option.assign(settings, {"perhaps"}, option.name), Error) << option.name;
    }
    EXPECT_EQ(option.values(settings), option.defaults) << option.name;
  }
}

}  // namespace
}  // namespace gazetrace::option_table_test
