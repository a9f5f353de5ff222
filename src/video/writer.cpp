// SPDX-License-Identifier: Apache-2.0
// Runs ffmpeg as a child process that reads raw frames from a socket. Unlike a pipe, a socket reports without a signal
// that the reader has gone.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>

#include "core/atomic_file.hpp"
#include "core/text.hpp"
#include "gazetrace/video.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX asks programs to declare it

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

std::string suffix_of(const std::string& path) {
  return to_lower(fs::path(path).extension().string());
}

// FFV1 keeps RGB; H.264 and HEVC store luma, and two color differences at half the resolution.
std::vector<std::string> arguments_of(const std::string& output, int width_px, int height_px,
                                      const VideoSettings& settings) {
  std::vector<std::string> list{settings.program,
                                "-hide_banner",
                                "-loglevel",
                                "error",
                                "-y",
                                "-f",
                                "rawvideo",
                                "-pixel_format",
                                "rgb24",
                                "-video_size",
                                fmt::format("{}x{}", width_px, height_px),
                                "-framerate",
                                fmt::format("{}/{}", settings.fps.numerator, settings.fps.denominator),
                                "-i",
                                "pipe:0",
                                "-an"};
  const auto add = [&](std::initializer_list<std::string> more) { list.insert(list.end(), more); };
  if (settings.codec == VideoCodec::ffv1) {
    add({"-vf", "format=gbrp", "-c:v", "ffv1", "-level", "3", "-colorspace", "rgb", "-color_range", "pc"});
  } else {
    add({"-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int+bicubic,format=yuv420p",
         "-c:v", settings.codec == VideoCodec::h264 ? "libx264" : "libx265", "-crf", std::to_string(settings.crf),
         "-colorspace", "bt709", "-color_range", "tv"});
  }
  if (settings.codec == VideoCodec::hevc) {
    add({"-x265-params", "log-level=error", "-tag:v", "hvc1"});
  }
  add({"-color_primaries", settings.color.primaries, "-color_trc", settings.color.transfer});
  if (settings.threads > 0) {
    add({"-threads", std::to_string(settings.threads)});
  }
  if (const std::string suffix = suffix_of(output); suffix == ".mp4" || suffix == ".mov") {
    add({"-movflags", "+faststart"});
  }
  if (!settings.comment.empty()) {
    add({"-metadata", "comment=" + settings.comment});
  }
  add({fs::absolute(output).string()});  // of a relative one ffmpeg takes what stands before a colon for a protocol
  return list;
}

std::string text_of(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    text += static_cast<char>(c);
  }
  return text;
}

std::string system_message(int error) {
  return std::generic_category().message(error);
}

}  // namespace

void check_video_settings(const std::string& path, const VideoSettings& settings) {
  const std::string suffix = suffix_of(path);
  if (suffix != ".mp4" && suffix != ".mov" && suffix != ".mkv") {
    throw Error(ErrorKind::usage, path, "a video ends in .mp4, .mov or .mkv", "give it such a name");
  }
  if (settings.codec == VideoCodec::ffv1 && suffix != ".mkv") {
    throw Error(ErrorKind::usage, path, "FFV1 can be written into .mkv files only",
                "give it such a name, or choose `codec` h264");
  }
  if (settings.crf < 0 || settings.crf > 51) {
    throw Error(ErrorKind::usage, "`crf`", std::to_string(settings.crf) + " is not possible", "give 0 to 51");
  }
  if (settings.fps.numerator <= 0 || settings.fps.denominator <= 0) {
    throw Error(ErrorKind::usage, "`fps`", "the frame rate must be positive");
  }
}

struct VideoWriter::Impl {
  std::string path, temporary, program;
  int width_px = 0, height_px = 0;              // of the frames given
  int coded_width_px = 0, coded_height_px = 0;  // of the video
  pid_t child = -1;
  int socket = -1;
  std::FILE* errors = nullptr;  // the program's messages
  std::size_t frames = 0;       // that were sent
  bool is_finished = false;

  ~Impl() {
    close_socket();
    if (child > 0) {
      ::kill(child, SIGKILL);
      wait_for_child();
    }
    if (errors != nullptr) {
      std::fclose(errors);
    }
    if (!is_finished) {
      ::unlink(temporary.c_str());
    }
  }

  void close_socket() {
    if (socket >= 0) {
      ::close(socket);
      socket = -1;
    }
  }

  // Whether it ended as a program does that has done its work. Where a process ignores SIGCHLD nobody can know, which
  // is no success.
  bool wait_for_child() {
    int status = 0;
    pid_t ended = 0;
    do {
      ended = ::waitpid(child, &status, 0);
    } while (ended < 0 && errno == EINTR);
    child = -1;
    return ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  // The last line that the program wrote.
  [[nodiscard]] std::string said() const {
    const std::string text = text_of(errors);
    std::string last;
    LineReader lines(text);
    for (std::string_view line; lines.next(line);) {
      if (!trim(line).empty()) {
        last = trim(line);
      }
    }
    return last;
  }

  [[noreturn]] void fail() {
    close_socket();
    if (child > 0) {
      wait_for_child();
    }
    fail(said());
  }

  [[noreturn]] void fail(const std::string& words) const {
    throw Error(ErrorKind::runtime, path, program + " failed" + (words.empty() ? "" : ": " + words),
                "check free space and the codecs of this ffmpeg (ffmpeg -encoders)");
  }

  // Whether all frames that were sent can be read from what it wrote.
  bool is_whole() {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> list(std::tmpfile(), std::fclose);
    if (list == nullptr) {
      return false;
    }
    start({program, "-hide_banner", "-loglevel", "error", "-xerror", "-i", temporary, "-map", "0:v", "-c", "copy", "-f",
           "framecrc", "pipe:1"},
          list.get());
    close_socket();
    const bool ended_well = wait_for_child();
    const std::string text = text_of(list.get());  // a line for each frame, and some that begin with #
    std::size_t count = 0;
    LineReader lines(text);
    for (std::string_view line; lines.next(line);) {
      count += trim(line).empty() || line.front() == '#' ? 0 : 1;
    }
    return ended_well && count == frames;
  }

  void send_bytes(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) {
        continue;
      }
      if (sent <= 0) {
        fail();
      }
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
  }

  // `out`: where its output goes; nullptr: nowhere.
  void start(const std::vector<std::string>& list, std::FILE* out = nullptr) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw Error(ErrorKind::runtime, program, "cannot be started: " + system_message(errno));
    }
    socket = ends[0];
    if (errors != nullptr) {
      std::fclose(errors);
    }
    errors = std::tmpfile();
    if (errors == nullptr) {
      ::close(ends[1]);
      throw Error(ErrorKind::runtime, program, "cannot make a temporary file: " + system_message(errno));
    }
    std::vector<char*> arguments;
    for (const std::string& argument : list) {
      arguments.push_back(const_cast<char*>(argument.c_str()));  // NOLINT: exec does not write to them
    }
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    if (out != nullptr) {
      posix_spawn_file_actions_adddup2(&actions, ::fileno(out), STDOUT_FILENO);
    } else {
      posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    }
    posix_spawn_file_actions_adddup2(&actions, ::fileno(errors), STDERR_FILENO);
    // In a process group of its own, so that an interrupt from the keyboard does not reach it.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int error = ::posix_spawnp(&child, program.c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (error != 0) {
      child = -1;
      throw Error(ErrorKind::input, program,
                  error == ENOENT ? "the program is not found" : "cannot be started: " + system_message(error),
                  "install it (apt-get install ffmpeg), or name it with `ffmpeg`");
    }
  }
};

VideoWriter::VideoWriter(const std::string& path, int width_px, int height_px, const VideoSettings& settings)
    : impl_(std::make_unique<Impl>()) {
  check_video_settings(path, settings);
  impl_->path = path;
  impl_->temporary = temporary_name(path).string();
  impl_->program = settings.program;
  impl_->width_px = width_px;
  impl_->height_px = height_px;
  const bool halves = settings.codec != VideoCodec::ffv1;
  impl_->coded_width_px = halves ? width_px + width_px % 2 : width_px;
  impl_->coded_height_px = halves ? height_px + height_px % 2 : height_px;
  impl_->start(arguments_of(impl_->temporary, impl_->coded_width_px, impl_->coded_height_px, settings));
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const DisplayImage& frame) {
  if (frame.width_px != impl_->width_px || frame.height_px != impl_->height_px || frame.bits != 8) {
    throw Error(ErrorKind::input, impl_->path,
                fmt::format("a frame has {}x{} pixels of {} bits, the video {}x{} of 8", frame.width_px,
                            frame.height_px, frame.bits, impl_->width_px, impl_->height_px),
                "give pictures of one size");
  }
  ++impl_->frames;
  const bool grows = impl_->coded_width_px > impl_->width_px;
  const std::size_t row = 3 * static_cast<std::size_t>(frame.width_px);
  for (int y = 0; y < impl_->coded_height_px; ++y) {
    const std::size_t begin = row * static_cast<std::size_t>(std::min(y, frame.height_px - 1));
    if (!grows && y == 0) {
      impl_->send_bytes(frame.bytes);
      y = frame.height_px - 1;
      continue;
    }
    impl_->send_bytes({&frame.bytes[begin], row});
    if (grows) {
      impl_->send_bytes({&frame.bytes[begin + row - 3], 3});
    }
  }
}

void VideoWriter::finish() {
  impl_->close_socket();
  // On a full disk some versions say so, leave a cut film and end with 0. Other errors that they tell of harm nothing.
  const bool ended_well = impl_->wait_for_child();
  const std::string words = impl_->said();
  if (!ended_well || (!words.empty() && !impl_->is_whole())) {
    impl_->fail(words);
  }
  put_file_in_place(impl_->temporary, impl_->path);
  impl_->is_finished = true;
}

}  // namespace gazetrace
