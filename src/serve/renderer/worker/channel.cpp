// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/worker/channel.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "base/error.h"

namespace sg::serve {

namespace {

constexpr uint32_t most_head = 64u << 20, most_bytes = 1u << 30;

bool send_all(int socket, const char* from, size_t count) {
  while (count > 0) {
    const ssize_t sent = ::send(socket, from, count, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    from += sent, count -= size_t(sent);
  }
  return true;
}

bool receive_all(int socket, char* to, size_t count) {
  while (count > 0) {
    const ssize_t got = ::recv(socket, to, count, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got, count -= size_t(got);
  }
  return true;
}

}  // namespace

Channel::~Channel() { ::close(socket_); }

void Channel::shut() { ::shutdown(socket_, SHUT_RDWR); }

bool Channel::send(const Json& head, const std::string& bytes) {
  const std::string text = head.dump();
  const uint32_t sizes[2] = {uint32_t(text.size()), uint32_t(bytes.size())};
  const std::lock_guard lock(sending_);
  return send_all(socket_, reinterpret_cast<const char*>(sizes), sizeof sizes) && send_all(socket_, text.data(), text.size()) &&
         send_all(socket_, bytes.data(), bytes.size());
}

std::optional<ChannelMessage> Channel::receive() {
  uint32_t sizes[2];
  if (!receive_all(socket_, reinterpret_cast<char*>(sizes), sizeof sizes) || sizes[0] > most_head || sizes[1] > most_bytes) return {};
  std::string head(sizes[0], '\0');
  ChannelMessage message;
  message.bytes.resize(sizes[1]);
  if (!receive_all(socket_, head.data(), head.size()) || !receive_all(socket_, message.bytes.data(), message.bytes.size())) return {};
  try {
    message.head = parse_json(head, "message of a worker");
  } catch (const Error&) {
    return {};
  }
  return message;
}

}  // namespace sg::serve
