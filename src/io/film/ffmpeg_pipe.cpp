// SPDX-License-Identifier: Apache-2.0
#include "io/film/ffmpeg_pipe.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"

extern char** environ;

namespace sg {

FfmpegPipe::FfmpegPipe(std::string path, int width, int height, double fps)
    : path_(std::move(path)), partial_(path_), log_(partial_.folder() + "log"), width_(width), height_(height) {
  int ends[2];
  // A socket and not a pipe: writing to one without a reader can be made not to raise a signal.
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    fail_data(fmt::format("cannot create a pipe: {}", std::strerror(errno)), path_);
  socket_ = ends[0];
  // It takes "a:b" for a protocol and "-a" for an option.
  const std::string target = "file:" + partial_.name();
  const std::string size = fmt::format("{}x{}", width, height), rate = exact_number(fps);
  const std::vector<std::string> words{"ffmpeg",
                                       "-nostdin",
                                       "-loglevel",
                                       "error",
                                       "-y",
                                       "-f",
                                       "rawvideo",
                                       "-pix_fmt",
                                       "rgb24",
                                       "-s",
                                       size,
                                       "-r",
                                       rate,
                                       "-i",
                                       "pipe:0",
                                       "-vf",
                                       "scale=out_color_matrix=bt709:out_range=tv",
                                       "-colorspace",
                                       "bt709",
                                       "-color_primaries",
                                       "bt709",
                                       "-color_trc",
                                       "bt709",
                                       "-pix_fmt",
                                       "yuv420p",
                                       "-crf",
                                       "18",
                                       "-map_metadata",
                                       "-1",
                                       "-fflags",
                                       "+bitexact",
                                       "-flags:v",
                                       "+bitexact",
                                       "-movflags",
                                       "+faststart",
                                       target};
  std::vector<char*> argv;
  for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 2, log_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, 0600);
  pid_t child = -1;
  const int failed = ::posix_spawnp(&child, "ffmpeg", &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (failed != 0) {
    ::close(socket_);
    fail_data(fmt::format("cannot start ffmpeg, which writes .{} films: {}", extension_of(path_), std::strerror(failed)), path_,
              "install it (apt-get install ffmpeg), or write a .webm, which needs no other program");
  }
  child_ = child;
  remember_partial(log_);
}

FfmpegPipe::~FfmpegPipe() {
  if (child_ < 0) return;
  ::close(socket_);
  forget_partial(log_);
  ::kill(child_, SIGTERM);
  ::waitpid(child_, nullptr, 0);
}

std::string FfmpegPipe::last_words() const {
  try {
    const std::string text(MappedFile(log_).text());
    const auto lines = split(trim(text), '\n');
    return lines.empty() ? "" : std::string(lines.back());
  } catch (const Error&) {
    return "";
  }
}

void FfmpegPipe::add(const Image& rgb) {
  std::string bytes;
  bytes.reserve(size_t(width_) * size_t(height_) * 3);
  for (int y = 0; y < height_; ++y) {
    const auto* row = reinterpret_cast<const char*>(rgb.at(0, std::min(y, rgb.height - 1)));
    bytes.append(row, size_t(rgb.width) * 3);
    for (int x = rgb.width; x < width_; ++x) bytes.append(row + size_t(rgb.width - 1) * 3, 3);
  }
  for (size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail_data(fmt::format("ffmpeg stopped accepting pictures: {}", last_words()), path_);
    sent += size_t(n);
  }
}

void FfmpegPipe::finish() {
  ::close(socket_);
  int status = 0;
  while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  forget_partial(log_);
  if (status == 0) return partial_.commit();
  const std::string said = last_words();
  fail_data(fmt::format("ffmpeg did not write the film: {}", said.empty() ? "it gave no reason" : said), path_);
}

}  // namespace sg
