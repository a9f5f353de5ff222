// SPDX-License-Identifier: Apache-2.0
#include "gazelog/log_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/text.hpp"
#include "gazelog/table.hpp"

namespace gazetrace {
namespace {

struct ForeignKind {
  std::string_view beginning, name, way_out;
};
using std::string_view_literals::operator""sv;
constexpr std::string_view kExportAsCsv = "export it as CSV with a column of time and columns of gaze";
constexpr ForeignKind kScene{"glTF", "a glTF scene", "the scene stands first, and the log after `gaze`"};
constexpr std::array kForeignKinds{
    kScene,
    ForeignKind{"SR_RESEARCH", "an EyeLink data file (.EDF)",
                "run `edf2asc FILE.EDF`, and give the .asc file that it writes"},
    ForeignKind{
        "\x89HDF\r\n"sv, "an HDF5 file, such as ioHub's of PsychoPy or MATLAB's of version 7.3",
        "of ioHub: gazetrace gaze iohub FILE.hdf5 -o gaze.csv `unit` UNIT `screen-px` W,H; else export it as CSV "
        "with a column of time and columns of gaze"},
    ForeignKind{"MATLAB 5.0 MAT-file", "a MATLAB file (.mat)", "write it as CSV with writetable() or writematrix()"},
    ForeignKind{"PK\x03\x04"sv, "a spreadsheet (.xlsx) or another zip archive",
                "save the sheet as CSV, or unpack the archive and give the file of gaze in it"},
    ForeignKind{"PAR1", "a Parquet file", "write it as CSV, such as with pandas: read_parquet(...).to_csv(...)"},
    ForeignKind{"ARROW1", "an Arrow or Feather file",
                "write it as CSV, such as with pandas: read_feather(...).to_csv(...)"},
    ForeignKind{"\x93NUMPY"sv, "a NumPy array (.npy)", "write it as CSV with numpy.savetxt(), with a header"},
    ForeignKind{"\x80\x02"sv, "a Python pickle", kExportAsCsv},
    ForeignKind{"\x80\x03"sv, "a Python pickle", kExportAsCsv},
    ForeignKind{"\x80\x04"sv, "a Python pickle", kExportAsCsv},
    ForeignKind{"\x80\x05"sv, "a Python pickle", kExportAsCsv},
    ForeignKind{"SQLite format 3", "an SQLite database", kExportAsCsv},
    ForeignKind{"RDX", "an R data file", "write it as CSV with write.csv()"},
    ForeignKind{"%PDF", "a PDF document", kExportAsCsv},
    ForeignKind{"BZh", "a bzip2 archive", "unpack it"},
    ForeignKind{"\xFD\x37zXZ"sv, "an xz archive", "unpack it"},
    ForeignKind{"7z\xBC\xAF"sv, "a 7-Zip archive", "unpack it"},
    ForeignKind{"\x28\xB5\x2F\xFD"sv, "a zstd archive", "unpack it"},
    ForeignKind{"\xD0\xCF\x11\xE0"sv, "a file of old Excel or Word", "save it as CSV"},
};

// What is binary and known by the end of its name alone.
constexpr std::array kBinaryEndings{
    ForeignKind{".idf", "SMI's own recording (.idf)", "export it with SMI's IDF Converter or BeGaze as text"},
    ForeignKind{".pldata", "Pupil Capture's own recording (.pldata)",
                "open the recording in Pupil Player and export gaze_positions.csv"},
    ForeignKind{".mp4", "a video", "give the file of gaze beside it"},
    ForeignKind{".avi", "a video", "give the file of gaze beside it"},
};

[[noreturn]] void refuse_kind(const GazeFile& file, std::string_view what, std::string_view way_out) {
  throw Error(ErrorKind::input, file.path, fmt::format("is {}, which is not read here", what), way_out);
}

// The names in the first object of a JSON text, which tell which columns a CSV of it would have.
std::string names_in_json(std::string_view line) {
  std::vector<std::string> names;
  constexpr std::size_t kMostKeys = 12;
  for (std::size_t at = line.find("\":"); at != std::string_view::npos && names.size() < kMostKeys;
       at = line.find("\":", at + 1)) {
    const std::size_t begin = line.rfind('"', at - 1);
    if (begin == std::string_view::npos || begin >= at) {
      continue;
    }
    if (std::string name(line.substr(begin + 1, at - begin - 1));
        std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(std::move(name));
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

// A table has numbers in some row near its beginning, and names that are no sentences above them.
bool is_prose(const GazeFile& file) {
  constexpr std::size_t kLines = 200;
  std::size_t seen = 0;
  LineReader lines(file.text);
  std::vector<std::string_view> cells;
  for (std::string_view line; seen < kLines && lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty()) {
      continue;
    }
    ++seen;
    const char separator = separator_of(text, text.find(',') != std::string_view::npos ? ',' : ' ');
    split_cells(text, separator, cells);
    const auto is_number = [](std::string_view cell) {
      const std::size_t first = cell.find_first_not_of(" \t\"'[(-+.");
      return first != std::string_view::npos && cell[first] >= '0' && cell[first] <= '9';
    };
    // Words between blanks may hold a number or two; in a cell of a table it stands first.
    const std::ptrdiff_t enough = separator == ' ' ? 2 : 1;
    if (std::count_if(cells.begin(), cells.end(), is_number) >= enough) {
      return false;
    }
  }
  return seen > 3;
}

}  // namespace

void refuse_foreign_file(const GazeFile& file) {
  const std::string_view text = file.text;
  for (const ForeignKind& kind : kForeignKinds) {
    if (text.starts_with(kind.beginning)) {
      refuse_kind(file, kind.name, kind.way_out);
    }
  }
  if (text.substr(0, 4096).find('\0') != std::string_view::npos && !text.starts_with("XDF:")) {
    const std::string path = to_lower(file.path);
    for (const ForeignKind& kind : kBinaryEndings) {
      if (path.ends_with(kind.beginning)) {
        refuse_kind(file, kind.name, kind.way_out);
      }
    }
  }
  const std::string_view head = trim(text.substr(0, text.find('\n')));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && (text[first] == '{' || text[first] == '[')) {
    const std::string_view beginning = text.substr(first, 4000);
    if (beginning.find("\"asset\"") != std::string_view::npos &&
        beginning.find("\"version\"") != std::string_view::npos) {
      refuse_kind(file, kScene.name, kScene.way_out);
    }
    const std::string names = names_in_json(beginning);
    const bool are_lines = head.starts_with('{') && head.ends_with('}');
    refuse_kind(file, are_lines ? "JSON with an object in each line" : "JSON",
                fmt::format("write it as CSV with a column of time and columns of gaze{}",
                            names.empty() ? "" : "; its names are: " + names));
  }
}

void refuse_prose(const GazeFile& file) {
  if (is_prose(file)) {
    refuse_kind(file, "a text without rows of numbers", "give a table of time and gaze, as CSV or TSV with a header");
  }
}

void refuse_split_numbers(const GazeFile& file) {
  constexpr std::size_t kLeastRows = 2;
  const bool is_arff = to_lower(head_of(file, 4096)).find("@attribute") != std::string::npos;
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::size_t longer = 0;
  std::int64_t first_longer = 0;
  bool in_rows = false;
  std::vector<std::string_view> cells;
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty() || text.front() == '#' || text.front() == '%') {
      continue;
    }
    if (!in_rows && is_arff) {
      const std::string word = to_lower(text.substr(0, 10));
      columns += word == "@attribute" ? 1 : 0;
      in_rows = word.starts_with("@data");
      continue;
    }
    if (!in_rows &&
        (text.find(',') == std::string_view::npos || text.find_first_of("\t;\"{") != std::string_view::npos)) {
      return;  // other separators, quotes, or no table
    }
    const auto commas = static_cast<std::size_t>(std::count(text.begin(), text.end(), ','));
    if (!in_rows) {
      columns = commas + (text.back() == ',' ? 0 : 1);
      in_rows = true;
      continue;
    }
    ++rows;
    if (commas < columns || text.back() == ',') {
      continue;
    }
    split_cells(text, ',', cells);
    const auto behind_a_comma = std::count_if(cells.begin() + 1, cells.end(), [](std::string_view cell) {
      return !cell.empty() && cell.find_first_not_of("0123456789") == std::string_view::npos;
    });
    if (static_cast<std::size_t>(behind_a_comma) < cells.size() - columns) {
      return;
    }
    first_longer = longer++ == 0 ? lines.number() : first_longer;
  }
  if (longer >= kLeastRows) {
    throw Error(ErrorKind::input, place_of(file, first_longer),
                fmt::format("the row holds more cells than the {} columns, as {} of {} rows do: commas separate the "
                            "columns, and stand in numbers as well, as decimal marks or between thousands",
                            columns, longer, rows),
                "export again with decimal points and without thousands separators, or with tabs or semicolons "
                "between the columns");
  }
}

}  // namespace gazetrace
