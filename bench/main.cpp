// SPDX-License-Identifier: Apache-2.0
// sg_bench --data FOLDER [--only REGEX-free substring] [--out records.jsonl] [--runs N] [--large SAMPLES] [--list]
#include <fmt/core.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "bench.h"

namespace sg::bench {
namespace {

double now() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

struct Result {
  double median = 0, least = 0, count = 0, peak_mb = 0, base_mb = 0;
  int runs = 0;
  bool good = false;
};

double peak_memory_mb() {
  struct rusage u {};
  ::getrusage(RUSAGE_SELF, &u);
  return double(u.ru_maxrss) / 1024;
}

Result summary(std::vector<double>& seconds) {
  std::sort(seconds.begin(), seconds.end());
  Result r;
  r.runs = int(seconds.size());
  r.least = seconds.front();
  r.median = seconds.size() % 2 ? seconds[seconds.size() / 2] : 0.5 * (seconds[seconds.size() / 2 - 1] + seconds[seconds.size() / 2]);
  r.good = true;
  return r;
}

// One warm-up, then at least five runs, up to fifteen short ones.
Result measure(const Task& task, int runs) {
  int pipe_ends[2];
  if (::pipe(pipe_ends) != 0) fail_internal("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    Result r;
    try {
      auto work = task.setup();
      const double base = peak_memory_mb();
      work();
      std::vector<double> seconds;
      const double begin = now();
      double count = 0;
      while (int(seconds.size()) < runs || (seconds.size() < 15 && now() - begin < 1.0)) {
        const double t = now();
        count = work();
        seconds.push_back(now() - t);
      }
      r = summary(seconds);
      r.count = count;
      r.base_mb = base;
      r.peak_mb = peak_memory_mb();
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s %s: %s\n", task.task.c_str(), task.size.c_str(), e.what());
    }
    [[maybe_unused]] const ssize_t n = ::write(pipe_ends[1], &r, sizeof r);
    ::_exit(0);
  }
  ::close(pipe_ends[1]);
  Result r;
  if (::read(pipe_ends[0], &r, sizeof r) != ssize_t(sizeof r)) r = {};
  ::close(pipe_ends[0]);
  ::waitpid(child, nullptr, 0);
  return r;
}

Result measure(const ProcessTask& task, int runs) {
  std::vector<double> seconds;
  double peak = 0;
  for (int i = 0; i <= runs; ++i) {
    if (!task.output.empty()) ::unlink(task.output.c_str());
    std::vector<char*> argv;
    for (const std::string& a : task.command) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    const double t = now();
    const pid_t child = ::fork();
    if (child == 0) {
      if (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr)) ::_exit(126);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    int status = 0;
    struct rusage u {};
    double s = 0;
    while (task.first && s == 0) {
      siginfo_t ended{};
      if (file_exists(task.output)) s = now() - t;
      else if (::waitid(P_PID, id_t(child), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 || ended.si_pid != 0) break;
      else ::usleep(500);
    }
    ::wait4(child, &status, 0, &u);
    if (s == 0) s = now() - t;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || (!task.output.empty() && !file_exists(task.output))) return {};
    if (i == 0) continue;
    seconds.push_back(s);
    peak = std::max(peak, double(u.ru_maxrss) / 1024);
  }
  Result r = summary(seconds);
  r.peak_mb = peak;
  if (!task.output.empty()) r.count = double(MappedFile(task.output).size());
  return r;
}

std::string record(const std::string& task, const std::string& peer, const std::string& size, const std::string& unit, const Result& r) {
  return fmt::format(
      "{{\"task\": {}, \"peer\": {}, \"size\": {}, \"threads\": {}, \"min_s\": {:.6f}, \"median_s\": {:.6f}, \"runs\": {}, "
      "\"output_count\": {:.0f}, "
      "\"output_unit\": {}, \"peak_rss_mb\": {:.1f}, \"base_rss_mb\": {:.1f}}}\n",
      json_string(task), json_string(peer), json_string(size), thread_count(), r.least, r.median, r.runs, r.count, json_string(unit),
      r.peak_mb, r.base_mb);
}

int run(int argc, char** argv) {
  std::string data = "bench-data", only, out, program;
  int runs = 5, large = 1625;
  bool list = false;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    auto value = [&] {
      if (i + 1 >= argc) fail_usage(a + " needs a value", "sg_bench");
      return std::string(argv[++i]);
    };
    if (a == "--data") data = value();
    else if (a == "--only") only = value();
    else if (a == "--out") out = value();
    else if (a == "--runs") runs = std::atoi(value().c_str());
    else if (a == "--program") program = value();
    else if (a == "--large") large = std::atoi(value().c_str());
    else if (a == "--list") list = true;
    else
      fail_usage("unknown argument '" + a + "'", "sg_bench",
                 "--data FOLDER --only TEXT --out FILE --runs N --program SIGHTGLASS --large SAMPLES --list");
  }
  if (program.empty()) program = folder_of(argv[0]) + "../sightglass";
  auto wanted = [&](const std::string& task, const std::string& size, const std::string& peer) {
    return only.empty() || (task + "|" + size + "|" + peer).find(only) != std::string::npos;
  };
  const bool of_large = only.starts_with("volume_large");
  if (!list && !of_large) make_inputs(data);
  std::string lines;
  auto report = [&](const std::string& task, const std::string& peer, const std::string& size, const std::string& unit, auto&& measured) {
    if (!wanted(task, size, peer)) return;
    if (list) {
      std::printf("%s|%s|%s\n", task.c_str(), size.c_str(), peer.c_str());
      return;
    }
    const Result r = measured();
    if (!r.good) {
      std::fprintf(stderr, "FAILED %s|%s\n", task.c_str(), size.c_str());
      return;
    }
    std::printf("%-22s %-28s %-34s median %9.3f ms  min %9.3f ms  n %2d  %.0f %s  peak %.0f MB\n", task.c_str(), size.c_str(), peer.c_str(),
                r.median * 1e3, r.least * 1e3, r.runs, r.count, unit.c_str(), r.peak_mb);
    std::fflush(stdout);
    lines += record(task, peer, size, unit, r);
  };
  if (of_large) {
    if (!list) make_large_volume(data, program, large);
    for (const ProcessTask& t : volume_large_tasks(data, program, large))
      report(t.task, t.peer, t.size, "PNG bytes", [&] { return measure(t, runs); });
    if (!out.empty()) write_file(out, lines);
    return 0;
  }
  for (const ProcessTask& t : process_tasks(data, program)) report(t.task, t.peer, t.size, "PNG bytes", [&] { return measure(t, runs); });
  for (const Task& t : tasks(data, only.starts_with("smoke_pressure")))
    report(t.task, t.peer, t.size, t.unit, [&] { return measure(t, runs); });
  if (!out.empty()) write_file(out, lines);
  return 0;
}

}  // namespace
}  // namespace sg::bench

int main(int argc, char** argv) {
  try {
    return sg::bench::run(argc, argv);
  } catch (const sg::Error& e) {
    std::fprintf(stderr, "sg_bench: %s\n", e.what());
    return e.exit_code();
  }
}
