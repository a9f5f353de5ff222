// SPDX-License-Identifier: Apache-2.0
// What documents point to exists: every relative link of every Markdown file, with its section, and every file that
// src/README.md names; and the index of the public headers is complete.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kSource = GAZETRACE_SOURCE_DIR;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<fs::path> documents() {
  std::vector<fs::path> found;
  for (const char* folder : {"docs", "examples", "gazelogs", "include", "scenes", "src", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kSource / folder)) {
      if (entry.path().extension() == ".md") {
        found.push_back(entry.path());
      }
    }
  }
  for (const char* name : {"README.md", "CHANGELOG.md", "CONTRIBUTING.md"}) {
    found.push_back(kSource / name);
  }
  std::sort(found.begin(), found.end());
  return found;
}

// A document without what stands in fences, where brackets are code and # is no heading.
std::string without_fences(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  bool fenced = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      fenced = !fenced;
    } else if (!fenced) {
      result += line + '\n';
    }
  }
  return result;
}

// The names by which links reach a document's sections: lower case, spaces as dashes, no punctuation.
std::set<std::string> sections(const fs::path& path) {
  std::istringstream lines(without_fences(text_of(path)));
  std::set<std::string> names;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) {
      continue;
    }
    line.erase(0, line.find_first_not_of("# "));
    std::string name;
    for (const char c : line) {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_') {
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      } else if (c == ' ') {
        name += '-';
      }
    }
    names.insert(name);
  }
  return names;
}

std::vector<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) {
    found.push_back((*it)[1]);
  }
  return found;
}

TEST(Documents, LinksLeadSomewhere) {
  const std::regex link(R"(\]\(([^)\s]+)\))");
  std::size_t links = 0;
  for (const fs::path& document : documents()) {
    for (const std::string& target : matches(without_fences(text_of(document)), link)) {
      if (target.find("://") != std::string::npos) {
        continue;
      }
      ++links;
      const std::size_t hash = target.find('#');
      const std::string file = target.substr(0, hash);
      const fs::path path = file.empty() ? document : document.parent_path() / file;
      ASSERT_TRUE(fs::exists(path)) << document << " links to " << target;
      if (hash != std::string::npos) {
        EXPECT_TRUE(sections(path).contains(target.substr(hash + 1)))
            << document << " links to " << target << ", and there is no such section";
      }
    }
  }
  EXPECT_GT(links, 30U);
}

// Names in back quotes that end like sources, in the map of the sources. Alone they lie in the folder named before
// them, so any place with that name will do.
TEST(Documents, TheMapOfTheSourcesNamesFilesThatExist) {
  std::set<std::string> names;
  std::set<fs::path> folders;
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "src")) {
    (entry.is_directory() ? (void)folders.insert(entry.path()) : (void)names.insert(entry.path().filename().string()));
  }
  const auto exists = [&](const std::string& name) {
    if (name.starts_with("gazetrace/")) {
      return fs::exists(kSource / "include" / name);
    }
    if (name.find('/') == std::string::npos) {
      return names.contains(name) || fs::exists(kSource / "include/gazetrace" / name);
    }
    return fs::exists(kSource / "src" / name) || fs::exists(kSource / name) ||
           std::any_of(folders.begin(), folders.end(),
                       [&](const fs::path& folder) { return fs::exists(folder / name); });
  };
  const std::string text = without_fences(text_of(kSource / "src/README.md"));
  std::size_t files = 0;
  for (std::string name : matches(text, std::regex(R"(`([\w/]+\.(?:cpp|hpp|def|\*)|[\w/]+/)`)"))) {
    ++files;
    if (name.ends_with(".*")) {
      name.replace(name.size() - 1, 1, "cpp");
    }
    EXPECT_TRUE(exists(name)) << "src/README.md names " << name;
  }
  EXPECT_GT(files, 50U);
}

TEST(Documents, TheIndexNamesEveryPublicHeader) {
  const std::string index = text_of(kSource / "include/gazetrace/README.md");
  for (const auto& entry : fs::directory_iterator(kSource / "include/gazetrace")) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".hpp")) {
      EXPECT_NE(index.find("| `" + name + "` |"), std::string::npos) << name << " is not in the index";
    }
  }
  for (const std::string& name : matches(index, std::regex(R"(\| `(\w+\.hpp)` \|)"))) {
    EXPECT_TRUE(name == "version.hpp" || fs::exists(kSource / "include/gazetrace" / name)) << name;
  }
}

}  // namespace
