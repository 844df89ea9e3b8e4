// SPDX-License-Identifier: Apache-2.0
#include "io/isolated/child.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <linux/futex.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/serial.h"
#include "base/text/text.h"
#include "io/plausible.h"

namespace sg {

namespace {

constexpr size_t library_memory = size_t(256) << 20;
constexpr const char* seconds_variable = "SIGHTGLASS_READ_SECONDS";

// Whole seconds, at least one.
rlim_t whole_seconds(double s) { return rlim_t(std::clamp(std::ceil(s), 1.0, 1e9)); }

size_t plus(size_t a, size_t b) { return a > SIZE_MAX / 2 - std::min(b, SIZE_MAX / 2) ? SIZE_MAX / 2 : a + b; }

void limit_to(int what, rlim_t value) {
  rlimit now{};
  if (::getrlimit(what, &now) != 0) return;
  now.rlim_cur = now.rlim_max = std::min({value, now.rlim_cur, now.rlim_max});
  ::setrlimit(what, &now);
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

[[noreturn]] void fail_time(const std::string& took, double seconds, const std::string& path) {
  fail_data(fmt::format("reading it takes more than {:.0f} s {}", std::ceil(seconds), took), path,
            fmt::format("the file may be damaged; otherwise allow more with {}=SECONDS in the environment", seconds_variable));
}

// Until the child ends or that many milliseconds have passed. Without a descriptor of the process (old systems) it looks again and again.
void wait_a_little(int process, int milliseconds) {
  if (process < 0) {
    ::usleep(500);
    return;
  }
  pollfd ends{process, POLLIN, 0};
  ::poll(&ends, 1, milliseconds);
}

/// Whether every thread of a process waits without timeout for a lock of the process itself, so that nothing will ever wake it.
bool waits_for_itself(pid_t process) {
  const std::string folder = fmt::format("/proc/{}/task", process);
  DIR* tasks = ::opendir(folder.c_str());
  bool any = false, all = tasks != nullptr;
  while (const dirent* task = all ? ::readdir(tasks) : nullptr) {
    if (task->d_name[0] == '.') continue;
    any = true, all = false;
    if (std::FILE* f = std::fopen(fmt::format("{}/{}/syscall", folder, task->d_name).c_str(), "r")) {
      long call = -1;
      unsigned long word = 0, what = 0, value = 0, until = 1;
      if (std::fscanf(f, "%ld %lx %lx %lx %lx", &call, &word, &what, &value, &until) == 5 && call == SYS_futex) {
        const unsigned long kind = what & FUTEX_CMD_MASK;
        all = (kind == FUTEX_WAIT || kind == FUTEX_WAIT_BITSET) && (what & FUTEX_PRIVATE_FLAG) != 0 && until == 0;
      }
      std::fclose(f);
    }
  }
  if (tasks) ::closedir(tasks);
  return any && all;
}

/// Number of consecutive checks in which it does so before it counts: threads may wake each other in between.
constexpr int most_looks = 5;
/// Starts of a child, of which each may meet a lock that is held.
constexpr int most_starts = 20;

}  // namespace

ChildLimits reading_limits(size_t file_bytes) {
  ChildLimits l;
  const size_t numbers = size_t(std::min<uint64_t>(plausible_memory(file_bytes), SIZE_MAX / 8));
  l.memory = plus(2 * numbers, library_memory);
  l.processor = 5 + double(l.memory >> 29) + double(file_bytes >> 20);
  if (const char* set = std::getenv(seconds_variable)) l.processor = std::max(std::atof(set), 1.0);
  l.wall = 10 * l.processor;
  return l;
}

size_t bytes_at(const std::string& path) {
  struct stat st {};
  if (::stat(path.c_str(), &st) != 0) return 0;
  if (!S_ISDIR(st.st_mode)) return size_t(st.st_size);
  size_t sum = 0;
  DIR* folder = ::opendir(path.c_str());
  while (const dirent* entry = folder ? ::readdir(folder) : nullptr)
    if (::fstatat(::dirfd(folder), entry->d_name, &st, 0) == 0 && S_ISREG(st.st_mode)) sum = plus(sum, size_t(st.st_size));
  if (folder) ::closedir(folder);
  return sum;
}

void become_child(const ChildLimits& limits) {
  run_serially();
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGXFSZ, SIGALRM, SIGINT, SIGTERM, SIGHUP, SIGPIPE})
    std::signal(signal, SIG_DFL);
  size_t pages = 0;
  if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(f, "%zu", &pages) != 1) pages = 0;
    std::fclose(f);
  }
  if (pages > 0) limit_to(RLIMIT_AS, plus(pages * size_t(::sysconf(_SC_PAGESIZE)), limits.memory));
  limit_to(RLIMIT_FSIZE, plus(limits.memory, 1 << 20));  // what it hands over is memory too
  limit_to(RLIMIT_CPU, whole_seconds(limits.processor));
  limit_to(RLIMIT_CORE, 0);
  ::alarm(unsigned(whole_seconds(limits.wall) + 2));  // should the parent be gone
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) ::dup2(nowhere, 1), ::dup2(nowhere, 2);
}

namespace {

/// run_child() for one child. Sets `stuck`, if given, when it had to be killed because it waits for itself.
int wait_for(pid_t child, const ChildLimits& limits, const std::string& path, const Context& context, bool* stuck) {
  const auto begin = std::chrono::steady_clock::now();
#ifdef SYS_pidfd_open
  const int process = int(::syscall(SYS_pidfd_open, child, 0));
#else
  const int process = -1;
#endif
  bool late = false;
  int status = 0, looks = 0;
  for (;;) {
    const pid_t r = ::waitpid(child, &status, WNOHANG);
    if (r == child || (r < 0 && errno != EINTR)) break;
    late = seconds_since(begin) > limits.wall;
    if (stuck && seconds_since(begin) > 0.1) {
      looks = waits_for_itself(child) ? looks + 1 : 0;
      *stuck = looks >= most_looks;
    }
    if (late || context.cancelled() || (stuck && *stuck)) ::kill(child, SIGKILL);
    wait_a_little(process, 20);
  }
  if (process >= 0) ::close(process);
  context.check();
  if (late) fail_time("of wall-clock time", limits.wall, path);
  if (stuck && *stuck) return status;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) fail_time("of wall-clock time", limits.wall, path);
  // The processor's limit ends a child by SIGXCPU, or by SIGKILL where both limits are one; only the system, when short of memory, kills it
  // like this.
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    fail_time("of processor time", limits.processor, path);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ) fail_child_memory(limits, path);
  return status;
}

}  // namespace

int run_child(const ChildLimits& limits, const std::string& path, const Context& context, const std::function<void()>& work) {
  for (int start = 1;; ++start) {
    // The child must not print again what the parent still has to print.
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child < 0) fail_data(fmt::format("cannot start a process for reading: {}", std::strerror(errno)), path);
    if (child == 0) {
      become_child(limits);
      work();
      ::_exit(0);
    }
    bool stuck = false;
    const int status = wait_for(child, limits, path, context, start < most_starts ? &stuck : nullptr);
    if (!stuck) return status;
  }
}

void fail_child_memory(const ChildLimits& limits, const std::string& path) {
  fail_data(fmt::format("reading it needs more memory than the {} allowed for a file of {}", human_bytes(limits.memory),
                        human_bytes(bytes_at(path))),
            path, "the file may be damaged; otherwise allow more with --memory SIZE, e.g. 16G");
}

}  // namespace sg
