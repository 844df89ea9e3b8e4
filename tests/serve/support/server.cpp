// SPDX-License-Identifier: Apache-2.0
#include "serve/support/server.h"

#include <fmt/core.h>

#include <stdexcept>

#include "base/text/text.h"
#include "support/test.h"

namespace sg::test {

using namespace serve;

std::optional<SocketHandler> EchoHost::join(const std::string& file, Rights rights, const std::string& user,
                                            std::shared_ptr<Socket> socket) {
  if (full) return {};
  {
    const std::lock_guard lock(mutex_);
    joined_.push_back({file, user, rights});
    last_ = socket;
  }
  return SocketHandler{[this, socket](std::string_view text) {
                         ++messages;
                         if (text == "throw") throw std::runtime_error("asked to");
                         if (text == "close") return socket->close("as you wish");
                         if (text.starts_with("pictures ")) {
                           const auto picture = std::make_shared<const std::string>(size_t(1) << 20, 'p');
                           for (int64_t i = 0; i < *parse_int(text.substr(9)); ++i) socket->send_binary(picture);
                           return;
                         }
                         socket->send_text(std::string(text));
                       },
                       [this] { ++closed; }};
}

std::optional<Saved> EchoHost::saved(const std::string& id) { return on_saved ? on_saved(id) : std::nullopt; }

std::vector<EchoHost::Joined> EchoHost::joined() const {
  const std::lock_guard lock(mutex_);
  return joined_;
}

std::shared_ptr<Socket> EchoHost::last_socket() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

RunningServer::RunningServer(DoorOptions options)
    : door(std::move(options), host), port(door.port()), thread_([this] { door.run(context); }) {}

RunningServer::~RunningServer() { stop(); }

void RunningServer::stop() {
  door.stop();
  if (thread_.joinable()) thread_.join();
}

std::string RunningServer::request(const std::string& target, const std::string& more, const std::string& method) const {
  return fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}\r\n", method, target, port, more);
}

Reply RunningServer::get(const std::string& target, const std::string& more) const {
  Wire wire(port);
  wire.send(request(target, more));
  return wire.reply();
}

std::string RunningServer::token() const {
  const std::string address = door.address_with_token();
  const size_t at = address.find("token=");
  return at == std::string::npos ? "" : address.substr(at + 6);
}

std::string RunningServer::enter(const std::string& given) {
  const Reply reply = get("/?token=" + (given.empty() ? token() : given));
  REQUIRE(reply.status == 303);
  const std::string set = reply.headers.at("set-cookie");
  return "Cookie: " + set.substr(0, set.find(';')) + "\r\n";
}

std::string RunningServer::upgrade(const std::string& target, const std::string& more, const std::string& origin) const {
  return request(target, more + (origin.empty() ? "" : "Origin: " + origin + "\r\n") +
                             "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                             "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n");
}

Wire RunningServer::socket(const std::string& cookie, const std::string& target, int receive_buffer) const {
  Wire wire(port, receive_buffer);
  wire.send(upgrade(target, cookie, origin()));
  const Reply reply = wire.reply(false);
  REQUIRE(reply.status == 101);
  CHECK(reply.headers.at("sec-websocket-accept") == "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");  // RFC 6455, section 1.3
  CHECK_FALSE(reply.headers.contains("sec-websocket-extensions"));
  return wire;
}

bool becomes(const std::function<bool()>& is) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!is()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace sg::test
