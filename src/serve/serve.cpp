// SPDX-License-Identifier: Apache-2.0
#include "serve/serve.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

#include "base/error.h"
#include "base/file/file.h"
#include "data/memory/memory_budget.h"
#include "pipeline/picture/picture.h"
#include "serve/door/door.h"
#include "serve/guard/users.h"
#include "serve/renderer/local_renderer.h"
#include "serve/session/sessions.h"

namespace sg::serve {

namespace {

// Results kept for later edits: half of what may be in memory.
uint64_t cache_bytes() { return allowed_memory() / 2; }

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

}  // namespace

void describe(Schema& s, ServeParams& p) {
  s("address", p.address, "Address of this machine to listen at; others than 127.0.0.1 can be reached from elsewhere.");
  s("port", p.port, "Port to listen at; 0: any that is free.").range(0, 65535);
  s("browser", p.browser, "Open the window in the system's browser.");
  s("users", p.users,
    "Who may come in: one a line, NAME RIGHTS HASH (see docs/security.md). Default: whoever has the token that is printed.")
      .unit("file");
  s("origin", p.origin, "Address by which browsers reach this server through a proxy, e.g. https://view.example.org.");
}

void view(PipelineFile file, const std::vector<std::string>& coloring, const std::string& title, const ServeParams& p, Context& context) {
  Sessions sessions(
      [&](const std::string&) { return Session::open(std::make_unique<LocalRenderer>(cache_bytes(), coloring), file, title); });
  Door door(door_options(p), sessions);
  say_address(fmt::format("{}: {}\n", title, door.address_with_token()));
  if (p.browser && !open_browser(door.address_with_token())) context.info("no browser could be started: open the address in one");
  door.run(context);
}

void serve(const std::string& folder, const ServeParams& p, Context& context) {
  DoorOptions options = door_options(p);
  options.folder = folder;
  if (!p.users.empty()) options.users = read_users(p.users);
  Sessions sessions([](const std::string& path) {
    PipelineFile file;
    file.steps.push_back({"input", "read", {"path=" + path}, {}, 0});
    file.show.push_back({std::string(auto_show), {}, "input", 0});
    return Session::open(std::make_unique<LocalRenderer>(cache_bytes(), std::vector<std::string>{}), std::move(file), file_name_of(path));
  });
  Door door(options, sessions);
  say_address(fmt::format("{}: {}\n", folder, door.address_with_token()));
  door.run(context);
}

}  // namespace sg::serve
