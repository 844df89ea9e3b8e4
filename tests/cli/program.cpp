// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "base/file/file.h"
#include "support/test.h"

namespace sg::test {

Ran sightglass(const std::vector<std::string>& args, const std::string& folder, long largest_file) {
  const std::string where = folder.empty() ? temp_folder() : folder;
  const std::string out = temp_folder() + "stdout.txt", err = temp_folder() + "stderr.txt";
  std::vector<char*> argv;
  const std::string program = std::string(test::build_folder()) + "/sightglass";
  argv.push_back(const_cast<char*>(program.c_str()));
  for (const std::string& a : args) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const int o = ::open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), e = ::open(err.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    if (::chdir(where.c_str()) != 0 || ::dup2(o, 1) < 0 || ::dup2(e, 2) < 0) ::_exit(126);
    if (largest_file > 0) {
      const struct rlimit limit { rlim_t(largest_file), rlim_t(largest_file) };
      ::setrlimit(RLIMIT_FSIZE, &limit);
      ::signal(SIGXFSZ, SIG_IGN);
    }
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  struct rusage usage {};
  ::wait4(child, &status, 0, &usage);
  Ran r;
  r.peak_bytes = size_t(usage.ru_maxrss) * 1024;
  r.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  r.out = std::string(MappedFile(out).text());
  r.err = std::string(MappedFile(err).text());
  return r;
}

Ran must(const std::vector<std::string>& args) {
  const Ran r = sightglass(args);
  INFO(args[0] << ": " << r.err);
  REQUIRE(r.status == 0);
  return r;
}

std::string bytes_of(const std::string& name) { return std::string(MappedFile(temp_folder() + name).text()); }

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace sg::test
