// SPDX-License-Identifier: Apache-2.0
#include "serve/support/wire.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "base/text/text.h"
#include "support/test.h"

namespace sg::test {

namespace {
using Clock = std::chrono::steady_clock;
}

Wire::Wire(uint16_t port, int receive_buffer) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  if (receive_buffer > 0) ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
}

Wire::~Wire() {
  if (fd_ >= 0) ::close(fd_);
}

Wire::Wire(Wire&& other) noexcept : fd_(other.fd_), have_(std::move(other.have_)) { other.fd_ = -1; }

void Wire::kill() {
  const linger now{1, 0};
  ::setsockopt(fd_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  ::close(fd_);
  fd_ = -1;
}

bool Wire::send(std::string_view bytes) {
  const auto until = Clock::now() + std::chrono::seconds(10);
  while (!bytes.empty() && Clock::now() < until) {
    pollfd ready{fd_, POLLOUT, 0};
    if (::poll(&ready, 1, 100) == 0) continue;
    const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0) return false;
    bytes.remove_prefix(size_t(sent));
  }
  return bytes.empty();
}

bool Wire::more(Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
  pollfd ready{fd_, POLLIN, 0};
  if (::poll(&ready, 1, int(std::max<int64_t>(0, left))) <= 0) return false;
  char bytes[65536];
  const ssize_t got = ::recv(fd_, bytes, sizeof bytes, 0);
  if (got <= 0) return false;
  have_.append(bytes, size_t(got));
  return true;
}

std::string Wire::receive(std::chrono::milliseconds longest) {
  if (have_.empty()) more(Clock::now() + longest);
  return std::exchange(have_, "");
}

bool Wire::closes(std::chrono::milliseconds longest) {
  const auto until = Clock::now() + longest;
  while (more(until)) have_.clear();
  pollfd ready{fd_, POLLIN, 0};
  char byte;
  return ::poll(&ready, 1, 0) == 1 && ::recv(fd_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) <= 0;
}

Reply Wire::reply(bool has_body) {
  const auto until = Clock::now() + std::chrono::seconds(10);
  size_t end = have_.find("\r\n\r\n");
  while (end == std::string::npos && more(until)) end = have_.find("\r\n\r\n");
  if (end == std::string::npos) return {};
  Reply reply;
  const std::string head = have_.substr(0, end);
  have_.erase(0, end + 4);
  reply.status = std::atoi(head.c_str() + std::string_view("HTTP/1.1 ").size());
  for (const std::string_view line : split(head, '\n'))
    if (const size_t colon = line.find(':'); colon != line.npos && !line.starts_with("HTTP/")) {
      const std::string name = to_lower(line.substr(0, colon));
      CHECK_FALSE(reply.headers.contains(name));
      reply.headers[name] = trim(line.substr(colon + 1));
    }
  if (has_body && reply.headers.contains("content-length")) {
    const size_t size = size_t(std::atoll(reply.headers["content-length"].c_str()));
    while (have_.size() < size && more(until)) {
    }
    reply.body = have_.substr(0, size);
    have_.erase(0, size);
  }
  return reply;
}

bool Wire::send_frame(int opcode, std::string_view payload, bool final, bool masked) {
  std::string bytes;
  bytes += char((final ? 0x80 : 0) | opcode);
  const char mask_bit = masked ? char(0x80) : char(0);
  if (payload.size() < 126) {
    bytes += char(mask_bit | char(payload.size()));
  } else {
    const int width = payload.size() < 65536 ? 2 : 8;
    bytes += char(mask_bit | char(width == 2 ? 126 : 127));
    for (int i = width - 1; i >= 0; --i) bytes += char(uint64_t(payload.size()) >> (8 * i) & 0xff);
  }
  const char key[4] = {'\x37', '\xfa', '\x21', '\x3d'};
  if (masked) bytes.append(key, 4);
  for (size_t i = 0; i < payload.size(); ++i) bytes += masked ? char(payload[i] ^ key[i % 4]) : payload[i];
  return send(bytes);
}

std::optional<Frame> Wire::frame(std::chrono::milliseconds longest) {
  const auto until = Clock::now() + longest;
  const auto need = [&](size_t bytes) {
    while (have_.size() < bytes)
      if (!more(until)) return false;
    return true;
  };
  while (need(2)) {
    Frame frame;
    frame.final = (have_[0] & 0x80) != 0;
    frame.opcode = have_[0] & 0x0f;
    CHECK((have_[1] & 0x80) == 0);  // a server does not mask
    CHECK((have_[0] & 0x70) == 0);  // no extension: no compression
    size_t size = have_[1] & 0x7f, at = 2;
    if (size >= 126) {
      const size_t width = size == 126 ? 2 : 8;
      if (!need(2 + width)) return {};
      size = 0;
      for (size_t i = 0; i < width; ++i) size = size << 8 | uint8_t(have_[2 + i]);
      at = 2 + width;
    }
    if (!need(at + size)) return {};
    frame.payload = have_.substr(at, size);
    have_.erase(0, at + size);
    if (frame.opcode != ping_frame) return frame;
  }
  return {};
}

std::optional<Frame> Wire::message(std::chrono::milliseconds longest) {
  std::optional<Frame> whole;
  while (auto next = frame(longest)) {
    if (next->opcode == close_frame || next->opcode == pong_frame) return next;
    if (!whole) whole = std::move(next);
    else whole->payload += next->payload, whole->final = next->final;
    if (whole->final) return whole;
  }
  return {};
}

}  // namespace sg::test
