// SPDX-License-Identifier: Apache-2.0
#include "core/data_root.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>
#include <system_error>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

fs::path resolved(const fs::path& path) {
  std::error_code failed;
  const fs::path followed = fs::weakly_canonical(path, failed);
  return failed ? fs::absolute(path).lexically_normal() : followed;
}

// Where the git data of a working tree is: in .git, or, of a dataset within another, where the file .git says.
fs::path git_folder(const fs::path& tree) {
  const fs::path git = tree / ".git";
  std::error_code ignored;
  if (!fs::is_regular_file(git, ignored)) {
    return git;
  }
  constexpr std::string_view kKey = "gitdir: ";
  std::ifstream file(git);
  std::string line;
  std::getline(file, line);
  return line.starts_with(kKey) ? resolved(tree / line.substr(kKey.size())) : git;
}

bool lies_in(const fs::path& file, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first == root.end();
}

// Whether git's data are those of this tree. A tree may name any folder as its own; where that lies elsewhere, as that
// of a dataset within another, it must name the tree, too, as `core.worktree` in its configuration. Else a file that
// came with a scene would open the annex of another dataset.
bool belongs_to(const fs::path& git, const fs::path& tree) {
  const fs::path folder = resolved(git);
  const fs::path root = resolved(tree);
  if (lies_in(folder, root)) {
    return true;
  }
  std::ifstream config(folder / "config");
  constexpr std::string_view kBlank = " \t";
  for (std::string line; std::getline(config, line);) {
    std::string_view rest = line;
    const auto skip_blanks = [&] { rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size())); };
    skip_blanks();
    if (!rest.starts_with("worktree")) {
      continue;
    }
    rest.remove_prefix(std::string_view("worktree").size());
    skip_blanks();
    if (rest.starts_with('=')) {
      rest.remove_prefix(1);
      skip_blanks();
      return resolved(folder / rest) == root;
    }
  }
  return false;
}

// The annex of a tree; empty where there is none.
fs::path annex_of(const fs::path& tree) {
  const fs::path git = git_folder(tree);
  std::error_code ignored;
  return fs::exists(git / "annex", ignored) && belongs_to(git, tree) ? git / "annex" : fs::path();
}

bool is_root(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "dataset_description.json", ignored) || fs::exists(folder / ".datalad", ignored) ||
         !annex_of(folder).empty();
}

void add_root(std::vector<fs::path>& roots, const fs::path& folder) {
  fs::path root = folder;
  for (fs::path at = folder;; at = at.parent_path()) {
    if (is_root(at)) {
      root = at;
      break;
    }
    if (at == at.parent_path()) {
      break;
    }
  }
  const auto add = [&](const fs::path& one) {
    if (std::find(roots.begin(), roots.end(), one) == roots.end()) {
      roots.push_back(one);
    }
  };
  add(root);
  // The object store alone, and only where it is one: a link in its place must not open another folder.
  std::error_code ignored;
  const fs::path annex = annex_of(root);
  if (const fs::path store = annex / "objects"; !annex.empty() && fs::is_directory(store, ignored)) {
    if (const fs::path real = resolved(store);
        real.filename() == "objects" && real.parent_path().filename() == "annex") {
      add(real);
    }
  }
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  const int lower = std::tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

}  // namespace

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0) {
      text += static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

std::vector<fs::path> data_roots(const std::string& path) {
  std::vector<fs::path> roots;
  const fs::path file = fs::absolute(path);
  add_root(roots, resolved(file.parent_path()));
  add_root(roots, resolved(file).parent_path());
  return roots;
}

void check_within(const std::vector<fs::path>& roots, const std::string& named, const std::string& words,
                  const std::string& place, const std::string& remedy) {
  const fs::path file = resolved(fs::absolute(named));
  if (std::any_of(roots.begin(), roots.end(), [&](const fs::path& root) { return lies_in(file, root); })) {
    return;
  }
  throw Error(ErrorKind::input, place,
              "'" + bounded(words, 200) + "' leads outside of '" + roots.front().string() + "', where the data lies",
              remedy);
}

std::string file_of_uri(const std::string& path, std::string_view uri) {
  // Not resolved: where a folder on the way is a link, `..` behind it leads elsewhere.
  const auto place = [&](const std::string& name) {
    return (fs::path(path).parent_path() / name).lexically_normal().string();
  };
  std::string name = percent_decoded(uri);
  std::string file = place(name);
  std::error_code unknown;
  if (name.find('\\') != std::string::npos && !fs::exists(file, unknown)) {
    std::replace(name.begin(), name.end(), '\\', '/');
    file = place(name);
  }
  return file;
}

}  // namespace gazetrace
