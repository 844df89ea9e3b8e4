// SPDX-License-Identifier: Apache-2.0
// The fuzz target of the server. The first letter says what the rest of an input is:
//   h  what a client sends; {COOKIE} and {HOST} stand for right ones
//   w  frames on a WebSocket that is open
//   p  names, targets, headers and files of users, for the functions that read them
// Whatever it is, the server ends the connection soon after the client has, opens sessions only by a right cookie and an origin, of files
// in its folder, and tells their end.
#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/replace.h"
#include "serve/door/catalog_text.h"
#include "serve/door/door.h"
#include "serve/guard/confined_path.h"
#include "serve/guard/host_check.h"
#include "serve/http/target.h"

namespace sg::serve {

// The door alone is tried here: what there is to request is a matter of other folders.
std::string catalog_text() { return "{}"; }

}  // namespace sg::serve

namespace {

using namespace sg::serve;

std::string folder;

[[noreturn]] void broken(const std::string& promise) {
  std::fprintf(stderr, "ERROR: broken promise: %s\n", promise.c_str());
  std::abort();
}

class Host : public SessionHost {
 public:
  std::optional<SocketHandler> join(const std::string& file, Rights, const std::string&, std::shared_ptr<Socket> socket) override {
    if (!may_join) broken("a session without a cookie");
    if (!file.starts_with(folder) || file.find("/..") != file.npos || file.find("secret") != file.npos) broken("opens " + file);
    ++open;
    return SocketHandler{[socket](std::string_view text) { socket->send_text(std::string(text)); }, [this] { --open; }};
  }
  std::optional<Saved> saved(const std::string& id) override {
    return Saved{id, "image/png", std::make_shared<const std::string>("picture")};
  }
  std::atomic<bool> may_join{false};
  std::atomic<int> open{0};
};

Host host;
Door* door = nullptr;
std::string cookie;

int connected() {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(door->port());
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  for (int tries = 0; tries < 1000; ++tries) {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (::connect(fd, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0) return fd;
    ::close(fd);  // all ports are in use for a moment
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  broken("takes no connection");
}

void send_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;
    bytes.remove_prefix(size_t(sent));
  }
}

std::string receive_until(int fd, std::string_view end) {
  std::string have;
  char bytes[4096];
  while (end.empty() || have.find(end) == have.npos) {
    pollfd ready{fd, POLLIN, 0};
    if (::poll(&ready, 1, 20'000) == 0) broken("neither answers nor ends within 20 s");
    const ssize_t got = ::recv(fd, bytes, sizeof bytes, 0);
    if (got <= 0) break;
    have.append(bytes, size_t(got));
  }
  return have;
}

std::string all_answers(int fd) {
  ::shutdown(fd, SHUT_WR);
  const std::string answers = receive_until(fd, "");
  ::close(fd);
  return answers;
}

std::string host_name() { return fmt::format("127.0.0.1:{}", door->port()); }

void try_requests(std::string text) {
  const bool right = text.find("{COOKIE}") != text.npos;
  host.may_join = right;
  sg::replace_all(text, "{COOKIE}", cookie);
  sg::replace_all(text, "{HOST}", host_name());
  const int fd = connected();
  send_all(fd, text);
  const std::string answers = all_answers(fd);
  if (!answers.empty() && !answers.starts_with("HTTP/1.1 ")) broken("an answer that is none");
  if (!answers.empty() && answers.find("Content-Security-Policy: default-src 'none'") == answers.npos) broken("an answer without a policy");
  if (!right && answers.find("\r\nContent-Type: application/json") != answers.npos) broken("an answer without a cookie");
}

void try_frames(std::string_view bytes) {
  host.may_join = true;
  const int fd = connected();
  send_all(fd, fmt::format("GET /socket?open=a.vtk HTTP/1.1\r\nHost: {0}\r\nOrigin: http://{0}\r\nCookie: {1}\r\nConnection: Upgrade\r\n"
                           "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
                           host_name(), cookie));
  if (!receive_until(fd, "\r\n\r\n").starts_with("HTTP/1.1 101")) broken("opens no WebSocket");
  send_all(fd, bytes);
  (void)all_answers(fd);
}

void try_functions(const std::string& text) {
  static const HostCheck hosts("127.0.0.1", 8234, {"https://view.example.org"});
  static const ConfinedFolder confined(folder);
  (void)parse_target(text);
  (void)cookie_values(text, "a");
  (void)hosts.origin_of(text);
  const auto tried = [](auto&& f) {
    try {
      f();
    } catch (const sg::Error& e) {
      if (e.kind() == sg::ErrorKind::internal) broken(e.what());
    }
  };
  tried([&] { (void)parse_users(text, "users"); });
  tried([&] { (void)HostCheck("127.0.0.1", 1, {text}); });
  tried([&] { (void)confined.list(text, 10); });
  tried([&] {
    const auto found = confined.find(text);
    if (!std::filesystem::canonical(found.path).string().starts_with(confined.path())) broken("finds " + found.path);
  });
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* where = std::getenv("TMPDIR");
  const std::string top = fmt::format("{}/sightglass-fuzz-serve-{}", where ? where : "/dev/shm", ::getpid());
  std::filesystem::create_directories(top + "/served/sub");
  for (const char* name : {"/served/a.vtk", "/served/t1.vtk", "/served/t2.vtk", "/served/t3.vtk", "/served/sub/b c.vtk", "/secret.vtk"})
    sg::write_file(top + name, "# vtk DataFile Version 3.0\n");
  std::filesystem::create_symlink("../secret.vtk", top + "/served/link.vtk");
  std::filesystem::create_symlink("..", top + "/served/up");
  folder = std::filesystem::canonical(top + "/served").string();
  DoorOptions options;
  options.folder = folder;
  options.server.limits.requests_per_second = options.server.limits.messages_per_second = 1e9;
  static Door here(options, host);
  door = &here;
  static std::thread thread([] { here.run(sg::Context()); });
  const int fd = connected();
  const std::string address = door->address_with_token();
  send_all(fd, fmt::format("GET /{} HTTP/1.1\r\nHost: {}\r\n\r\n", address.substr(address.find('?')), host_name()));
  const std::string answer = all_answers(fd), mark = "Set-Cookie: ";
  const size_t at = answer.find(mark);
  if (at == answer.npos) broken("gives no cookie");
  cookie = answer.substr(at + mark.size(), answer.find(';', at) - at - mark.size());
  std::atexit([] {
    door->stop();
    thread.join();
    std::error_code ignored;
    std::filesystem::remove_all(std::filesystem::path(folder).parent_path(), ignored);
  });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(bytes) + 1, size - 1);
  switch (bytes[0]) {
    case 'h': try_requests(std::string(rest)); break;
    case 'w': try_frames(rest); break;
    case 'p': try_functions(std::string(rest)); break;
    default: return -1;
  }
  for (int tries = 0; host.open > 0 || door->connections() > 0; ++tries) {
    if (tries == 20'000) broken("a connection is kept");
    std::this_thread::sleep_for(std::chrono::milliseconds(tries < 100 ? 0 : 1));
  }
  return 0;
}
