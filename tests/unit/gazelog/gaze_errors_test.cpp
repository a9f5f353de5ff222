// SPDX-License-Identifier: Apache-2.0
// What a broken log or a wrong option is answered with: one line, with place and remedy.
#include <gtest/gtest.h>

#include "gazetrace/gaze.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_errors_test {
namespace {

struct Case {
  std::string name, text, message;
};

void expect_errors(const std::vector<Case>& cases, const GazeReadOptions& options = {}) {
  const TextFiles files;
  for (const Case& c : cases) {
    try {
      load_gaze_log(files.write(c.name, c.text), options);
      ADD_FAILURE() << c.name << " was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(files.without_folder(error.what()), c.message);
      EXPECT_EQ(error.kind(), ErrorKind::input) << c.name;
    }
  }
}

TEST(GazeErrors, EmptyLogs) {
  const std::string no_row = "holds no sample; a gaze log needs at least one row below its header";
  expect_errors({
      {"nothing.csv", "", "nothing.csv: is empty; give a gaze log with a header and at least one sample"},
      {"blank.csv", "\n \r\n", "blank.csv: is empty; give a gaze log with a header and at least one sample"},
      {"bom.csv", "\xEF\xBB\xBF", "bom.csv: is empty; give a gaze log with a header and at least one sample"},
      {"header.csv", "t[ms],u,v\n", "header.csv: " + no_row},
      {"header_only.csv", "t[ms],u,v", "header_only.csv: " + no_row},
      {"comments.csv", "t[ms],u,v\n# no data\n", "comments.csv: " + no_row},
      {"preamble.csv", "# gazetrace-gaze 1\n",
       "preamble.csv: holds no sample; a gaze log needs a header and at least one row below it"},
  });
}

TEST(GazeErrors, Columns) {
  expect_errors({
      {"timeless.csv", "frame,x,y\n1,2,3\n",
       "timeless.csv:1: no column for time is found; the columns are: frame, x, y; name it with `time-column`"},
      {"no_x.csv", "# a\nt[ms],left,right\n1,2,3\n",
       "no_x.csv:2: no columns for the horizontal position and the vertical position are found; the columns are: "
       "t[ms], "
       "left, right; name them with `x-column` and `y-column`"},
      {"no_y.csv", "t[ms],x[px],right\n1,2,3\n",
       "no_y.csv:1: no column for the vertical position is found; the columns are: t[ms], x[px], right; name it with "
       "`y-column`"},
      {"two.csv", "t[ms],u\n1,2\n",
       "two.csv:1: 't[ms],u' is not a table of time and position; separate the cells by commas, semicolons or tabs"},
      {"blanks.txt", "t u v\n1 2 3\n",
       "blanks.txt:1: 't u v' is not a table of time and position; separate the cells by commas, semicolons or tabs"},
      {"numbers.csv", "1,2,3\n2,3,4\n",
       "numbers.csv:1: there is no header, only 3 columns of numbers; say by number which is which: `time-column` "
       "1 "
       "`x-column` 2 `y-column` 3"},
      {"unit.csv", "t[ms],x[inch],y[inch]\n1,2,3\n",
       "unit.csv:1: unknown unit 'inch' of column 'x[inch]'; use [1], [px], [mm], [cm] or [deg], or give `unit`"},
      {"mixed.csv", "t[ms],x[px],y[mm]\n1,2,3\n",
       "mixed.csv:1: columns 'x[px]' and 'y[mm]' are in different units; name two columns of one unit, or give "
       "`unit`"},
      {"hours.csv", "t[h],u,v\n1,2,3\n",
       "hours.csv:1: unknown unit 'h' of time column 't[h]'; use [s], [ms], [us] or [ns], or give `time-unit`"},
      {"steps.csv", "time,u,v\n0,.5,.5\n100,.5,.5\n200,.5,.5\n",
       "steps.csv:1: the unit of time column 'time' is not stated and cannot be guessed from its steps; give "
       "`time-unit`, or write it into the header: t[ms]"},
      {"one.csv", "time,u,v\n0,.5,.5\n",
       "one.csv:1: the unit of time column 'time' is not stated and cannot be guessed from its steps; give "
       "`time-unit`, or write it into the header: t[ms]"},
  });
  GazeReadOptions options;
  options.columns.time = "timestmp";
  expect_errors({{"name.csv", "timestamp,gaze_x,gaze_y\n1,2,3\n",
                  "name.csv:1: unknown column 'timestmp'; did you mean 'timestamp'? Known: timestamp, gaze_x, gaze_y"}},
                options);
  options.columns.time = "7";
  expect_errors({{"number.csv", "timestamp,gaze_x,gaze_y\n1,2,3\n",
                  "number.csv:1: unknown column '7'; Known: timestamp, gaze_x, gaze_y"}},
                options);
}

TEST(GazeErrors, DisplaysThatUnitsNeed) {
  expect_errors({
      {"px.csv", "t[ms],x[px],y[px]\n1,2,3\n",
       "px.csv:1: positions are in px, and the size in pixels of the display of the recording is not known; give "
       "`screen-px` W,H, or write `# display_px W H` above the header"},
      {"mm.csv", "t[ms],x[mm],y[mm]\n1,2,3\n",
       "mm.csv:1: positions are in mm, and the size in cm of the display of the recording is not known; give "
       "`screen-cm` W,H, or write `# display_mm W H` above the header"},
      {"deg.csv", "# display_mm 480 270\nt[ms],x[deg],y[deg]\n1,2,3\n",
       "deg.csv:2: positions are in deg, and the eye's distance of the display of the recording is not known; give "
       "`screen-distance-cm`, or write `# distance_mm D` above the header"},
      {"preamble.csv", "# display_px 1920\nt[ms],x[px],y[px]\n1,2,3\n",
       "preamble.csv:1: `# display_px` needs 2 positive numbers, not '1920'"},
      {"half.csv", "# display_px 1920.5 1080\nt[ms],x[px],y[px]\n1,2,3\n",
       "half.csv:1: `# display_px` needs two whole numbers, not '1920.5 1080'"},
      {"far.csv", "# distance_mm -600\nt[ms],x[px],y[px]\n1,2,3\n",
       "far.csv:1: `# distance_mm` needs 1 positive number, not '-600'"},
      {"newer.csv", "# gazetrace-gaze 2\nt[ns],u[1],v[1]\n1,2,3\n",
       "newer.csv: is gazetrace CSV of version 2; this program reads version 1; use a newer gazetrace"},
  });
}

TEST(GazeErrors, Rows) {
  const std::string header = "t[s],u,v,valid,eye\n0,.5,.5,1,left\n";
  const std::string mend = "; remove or mend the row";
  expect_errors({
      {"backwards.csv", header + "2.433,.5,.5,1,left\n2.417,.5,.5,1,left\n",
       "backwards.csv:4: time 2417000000 ns is before that of line 3 (2433000000 ns); sort the log, or use "
       "`order` sort"},
      {"duplicate.csv", header + "1,.5,.5,1,left\n1,.6,.5,1,left\n",
       "duplicate.csv:4: time 1000000000 ns repeats that of line 3; dropping repeats would keep only 2 of 3 rows: "
       "export "
       "again with stamps that differ, or look at it with 'gazetrace gaze inspect'"},
      {"short.csv", header + "1,.5,.5\n",
       "short.csv:3: the row has 3 of the 5 cells that reach to column 'eye'; it is short or cut off; remove or mend "
       "it"},
      {"cut.csv", header + "1,.5,.5,1,left\n2",
       "cut.csv:4: the row has 1 of the 5 cells that reach to column 'eye'; it is short or cut off; remove or mend it"},
      {"timeless.csv", header + ",.5,.5,1,left\n",
       "timeless.csv:3: this row has no time; remove the row, or give it a time"},
      {"clock.csv", header + "12:30,.5,.5,1,left\n",
       "clock.csv:3: time '12:30' is a time of day; write times as numbers, such as milliseconds from the beginning, "
       "or "
       "name the column of the tracker's own clock with `time-column`"},
      {"word.csv", header + "noon,.5,.5,1,left\n", "word.csv:3: time 'noon' is not a number" + mend},
      {"overflow.csv", header + "9223372036.854775808,.5,.5,1,left\n",
       "overflow.csv:3: time '9223372036.854775808' in s does not fit int64 nanoseconds; check the unit of the time "
       "column"},
      // Above .NET's count of 1970, ticks are counted from there; below it they are only too many.
      {"ticks.csv", "time(100ns),u,v\n538342794000115346,.5,.5\n",
       "ticks.csv:2: time '538342794000115346' in 100 ns does not fit int64 nanoseconds; check the unit of the time "
       "column"},
      {"text.csv", header + "1,.5,here,1,left\n",
       "text.csv:3: 'here' in column 'v' is not a number; write missing values as an empty cell or n/a"},
      {"eye.csv", header + "1,.5,.5,1,third\n",
       "eye.csv:3: eye 'third' is not left, right or cyclopean; mend the row, or leave the column out"},
  });
  expect_errors(
      {{"validity.csv", "# gazetrace-gaze 1\nt[ns],u[1],v[1],valid\n1,.5,.5,blnk\n",
        "validity.csv:3: unknown validity 'blnk'; did you mean 'blink'? Known: ok, low_confidence, blink, lost, "
        "off_screen, interpolated"}});
}

std::string message_of(const std::string& path, const GazeReadOptions& options, ErrorKind kind) {
  try {
    load_gaze_log(path, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "no error";
}

TEST(GazeErrors, FilesAndFormats) {
  const TextFiles files;
  GazeReadOptions options;
  EXPECT_EQ(files.without_folder(message_of(files.path("absent.csv"), options, ErrorKind::input)),
            "absent.csv: cannot be opened: No such file or directory; check the path");
  EXPECT_EQ(files.without_folder(
                message_of(files.write("bytes.bin", std::string("a,b\0c,d\n", 8)), options, ErrorKind::input)),
            "bytes.bin: is not a gaze log of a known format; give a CSV or TSV with a header, or name the format with "
            "`format`");
  EXPECT_EQ(files.without_folder(message_of(files.write("log.tsv.gz", "\x1F\x8B\x08"), options, ErrorKind::input)),
            "log.tsv.gz: gzip data are cut off; copy the file again; gzip -t tests it");
  const std::string log = files.write("log.csv", "t[ns],u[1],v[1]\n1,.5,.5\n");
  options.format = "gazetrace_csv";
  EXPECT_TRUE(
      message_of(log, options, ErrorKind::usage)
          .starts_with("unknown gaze format 'gazetrace_csv'; did you mean 'gazetrace-csv'? Known: gazetrace-csv, "));
  options.format = "generic";
  EXPECT_EQ(load_gaze_log(log, options).format, "generic");
  options.columns.position_unit = PositionUnit::deg;
  options.columns.origin = PositionOrigin::top_left;
  EXPECT_EQ(files.without_folder(message_of(log, options, ErrorKind::usage)),
            "log.csv:1: positions in degrees cannot count from the top-left; degrees count from straight ahead: "
            "`origin` center");
}

}  // namespace
}  // namespace gazetrace::gaze_errors_test
