// SPDX-License-Identifier: Apache-2.0
#include "cli/spool.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <vector>

#include "base/error.h"
#include "base/file/partial_file.h"
#include "base/text/text.h"

namespace sg {

namespace {

bool names_stream(const std::string& path) {
  if (path != "/dev/stdin" && !path.starts_with("/dev/fd/") && !path.starts_with("/proc/self/fd/")) return false;
  struct stat st {};
  return ::stat(path.c_str(), &st) == 0 && (S_ISFIFO(st.st_mode) || S_ISSOCK(st.st_mode) || S_ISCHR(st.st_mode));
}

void write_all(int fd, const char* bytes, size_t n, const std::string& path) {
  while (n > 0) {
    const ssize_t done = ::write(fd, bytes, n);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0)
      fail_data(std::string("cannot store the pipe's data in $TMPDIR:  ") + std::strerror(errno), path, "save it in a file first");
    bytes += done, n -= size_t(done);
  }
}

struct Spooled {
  std::string file, stream;
};
std::deque<Spooled> spooled_files;

}  // namespace

std::string with_stream_names(std::string text) {
  for (const Spooled& s : spooled_files)
    for (size_t at = text.find(s.file); at != text.npos; at = text.find(s.file, at + s.stream.size()))
      text.replace(at, s.file.size(), s.stream);
  return text;
}

std::string spooled(const std::string& path, size_t most, const Context& context) {
  if (!names_stream(path)) return path;
  const int from = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (from < 0) fail_data(std::string("cannot open the input: ") + std::strerror(errno), path);
  if (::isatty(from)) {
    ::close(from);
    fail_data("is a terminal, not a file", path);
  }
  // In a folder of its own: data from the pipe may not name files next to it.
  static std::deque<PartialFile> kept;  // removed at the end
  const char* chosen = std::getenv("TMPDIR");
  const std::string name = kept.emplace_back((chosen && *chosen ? std::string(chosen) : std::string("/tmp")) + "/sightglass-pipe").name();
  const int to = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (to < 0) fail_data(std::string("cannot store the pipe's data in $TMPDIR:  ") + std::strerror(errno), path);
  std::vector<char> part(size_t(1) << 20);
  size_t all = 0;
  for (;;) {
    context.check();
    struct pollfd wait {
      from, POLLIN, 0
    };
    ::poll(&wait, 1, 200);
    const ssize_t n = wait.revents ? ::read(from, part.data(), part.size()) : -2;
    if (n == 0) break;
    if (n == -2 || (n < 0 && (errno == EINTR || errno == EAGAIN))) continue;
    if (n < 0) fail_data(std::string("cannot be read: ") + std::strerror(errno), path);
    if ((all += size_t(n)) > most)
      fail_data(fmt::format("the pipe delivers more than {}", human_bytes(most)), path,
                "save it in a file first, or allow more with --memory");
    write_all(to, part.data(), size_t(n), path);
  }
  ::close(from), ::close(to);
  spooled_files.push_back({name, path});
  return name;
}

}  // namespace sg
