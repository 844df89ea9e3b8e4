// SPDX-License-Identifier: Apache-2.0
#include "serve/serve.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "data/memory/memory_budget.h"
#include "pipeline/picture/picture_parts.h"
#include "scene/show/show.h"
#include "serve/door/door.h"
#include "serve/guard/users.h"
#include "serve/renderer/local_renderer.h"
#include "serve/renderer/worker/worker_renderer.h"
#include "serve/session/forbidden.h"
#include "serve/session/sessions.h"

namespace sg::serve {

namespace {

DoorOptions door_options(const ServeParams& p) {
  DoorOptions options;
  options.server.address = p.address, options.server.port = uint16_t(p.port), options.public_origins = p.origin;
  return options;
}

void say_address(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

// Detached: a browser outlives the program, and does not write on its terminal.
bool open_browser(const std::string& address) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int stream : {0, 1, 2}) posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  const char* const command[] = {"xdg-open", address.c_str(), nullptr};
  pid_t child = 0;
  const bool started = posix_spawnp(&child, command[0], &files, nullptr, const_cast<char* const*>(command), environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  int status = 0;
  return started && ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// From here on nothing is read but what lies below folders of the files that are served, and nothing is written: whatever a window asks
// for.
void fence_in(std::vector<std::string> folders, std::string who) {
  FileFence fence;
  fence.read_below = std::move(folders);
  fence.who = std::move(who);
  set_file_fence(std::move(fence));
}

}  // namespace

void describe(Schema& s, ServeParams& p) {
  s("address", p.address, "Address of this machine to listen at; others than 127.0.0.1 can be reached from elsewhere.");
  s("port", p.port, "Port to listen at; 0: any that is free.").range(0, 65535);
  s("browser", p.browser, "Open the window in the system's browser.");
  s("users", p.users,
    "Who may come in: one a line, NAME RIGHTS HASH (see docs/security.md). Default: whoever has the token that is printed.")
      .unit("file");
  s("workers", p.workers,
    "Draw in processes of their own, one a session and at most so many: what exhausts memory or crashes ends a session's picture, not the "
    "server. 0: all in this process.")
      .range(0, 256);
  s("worker_memory", p.worker_memory,
    "Memory that each worker may take, e.g. 4G: what needs more is told in the window, and ended. Default: what the machine has.");
  s("most_seconds", p.most_seconds,
    "Seconds that reading what is opened, and one picture, question, picture to save or edit of a window may take before it is ended; 0: "
    "any time.")
      .at_least(0);
  s("origin", p.origin, "Address by which browsers reach this server through a proxy, e.g. https://view.example.org.");
}

namespace {

// Mistakes that can be seen without running anything end the command instead of standing in the window.
void check_pipeline(const PipelineFile& file) {
  stated_in(file);
  for (const PipelineFile::Show& s : file.show)
    if (s.kind != auto_show) show_params(find_show(s.kind), s.words);
  build_graph(file).graph.validate();
}

std::vector<std::string> folders_of(const std::vector<std::string>& files) {
  std::vector<std::string> folders;
  for (const std::string& f : files) folders.push_back(folder_of(f).empty() ? "." : folder_of(f));
  return folders;
}

uint64_t worker_memory(const ServeParams& p) {
  if (p.worker_memory.empty()) return 0;
  const auto bytes = parse_bytes(p.worker_memory);
  if (!bytes || *bytes < least_worker_memory)
    fail_usage(fmt::format("'{}' is no amount of memory in which a worker could work", p.worker_memory), "--worker-memory",
               fmt::format("write e.g. 4G; at least {}", human_bytes(least_worker_memory)));
  if (p.workers == 0) fail_usage("there are no workers", "--worker-memory", "--workers N starts them; --memory bounds this process");
  return *bytes;
}

std::unique_ptr<Renderer> new_renderer(const ServeParams& p, const std::vector<std::string>& coloring,
                                       const std::vector<std::string>& folders) {
  if (p.workers == 0) return std::make_unique<LocalRenderer>(allowed_memory() / 2, coloring);
  WorkerOptions options;
  options.command = {"/proc/self/exe", worker_command};
  options.coloring = coloring, options.folders = folders, options.memory = memory_limit();
  options.process_memory = worker_memory(p);
  return std::make_unique<WorkerRenderer>(std::move(options));
}

}  // namespace

void view(PipelineFile file, const std::vector<std::string>& coloring, const std::string& title, const ServeParams& p, Context& context) {
  check_pipeline(file), worker_memory(p);
  const std::vector<std::string> folders = folders_of(files_read(file));
  Sessions sessions([&](const std::string&) { return Session::open(new_renderer(p, coloring, folders), file, title); });
  fence_in(folders, "a window");
  sessions.begin("");  // reads while the browser starts
  Door door(door_options(p), sessions);
  say_address(fmt::format("{}: {}\n", title, door.address_with_token()));
  if (p.browser && !open_browser(door.address_with_token())) context.info("no browser could be started: open the address in one");
  door.run(context);
}

void serve(const std::string& folder, const ServeParams& p, Context& context) {
  DoorOptions options = door_options(p);
  options.folder = folder;
  worker_memory(p);
  const auto longest = std::chrono::milliseconds(int64_t(std::min(1000 * p.most_seconds, 1e12)));
  if (!p.users.empty()) options.users = read_users(p.users);
  Sessions sessions(
      [&](const std::string& path) {
        PipelineFile file;
        file.steps.push_back({"input", "read", {"path=" + path}, {}, 0});
        file.show.push_back({std::string(auto_show), {}, "input", 0});
        return Session::open(new_renderer(p, {}, {folder}), std::move(file), file_name_of(path), folder, longest);
      },
      p.workers > 0 ? size_t(p.workers) : 16);
  fence_in({folder}, "a window");
  Door door(options, sessions);
  say_address(fmt::format("{}: {}\n", folder, door.address_with_token()));
  door.run(context);
}

}  // namespace sg::serve
