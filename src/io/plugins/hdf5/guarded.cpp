// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/guarded.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>

#include "io/isolated/child.h"

namespace sg::h5 {

namespace {

constexpr size_t most_bytes = 1 << 20;
constexpr int most_milliseconds = 10000;
constexpr size_t most_memory = size_t(256) << 20;
constexpr int most_computing = 300000;  // microseconds; reading a text takes a few

// In the child: the answer, prefixed with '+'. Nothing of the parent's state may be flushed or destroyed.
[[noreturn]] void answer(int to, const std::function<std::string()>& f) {
  become_child({most_memory, 1, most_milliseconds / 1000});
  std::signal(SIGPROF, SIG_DFL);
  const itimerval spinning{{0, 0}, {0, most_computing}};
  ::setitimer(ITIMER_PROF, &spinning, nullptr);
  try {
    const std::string text = "+" + f();
    for (size_t at = 0; at < text.size();) {
      const ssize_t n = ::write(to, text.data() + at, text.size() - at);
      if (n <= 0) ::_exit(1);
      at += size_t(n);
    }
  } catch (...) {
    ::_exit(1);
  }
  ::_exit(0);
}

}  // namespace

std::optional<std::string> guarded(const std::function<std::string()>& f) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) return {};
  const pid_t child = ::fork();
  if (child == 0) answer(pipe[1], f);
  ::close(pipe[1]);
  std::string text;
  bool good = child > 0;
  const auto begin = std::chrono::steady_clock::now();
  while (good) {
    const auto spent = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin).count();
    pollfd wait{pipe[0], POLLIN, 0};
    const int ready = ::poll(&wait, 1, int(std::max<long long>(most_milliseconds - spent, 0)));
    if (ready < 0 && errno == EINTR) continue;
    char part[4096];
    const ssize_t n = ready > 0 ? ::read(pipe[0], part, sizeof part) : -1;
    if (n < 0 && ready > 0 && errno == EINTR) continue;
    if (n <= 0) {
      good = n == 0;
      break;
    }
    text.append(part, size_t(n));
    good = text.size() <= most_bytes;
  }
  ::close(pipe[0]);
  if (child > 0) {
    if (!good) ::kill(child, SIGKILL);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    good = good && WIFEXITED(status) && WEXITSTATUS(status) == 0 && text.starts_with('+');
  }
  if (!good) return {};
  return text.substr(1);
}

}  // namespace sg::h5
