// SPDX-License-Identifier: Apache-2.0
// WebSockets: messages in all forms, right and wrong; clients that are slow, dead, killed, many.
#include <fmt/core.h>

#include "serve/support/server.h"
#include "support/test.h"

namespace sg {

using namespace serve;
using namespace std::chrono_literals;
using test::becomes;
using test::binary_frame;
using test::close_frame;
using test::continuation_frame;
using test::ping_frame;
using test::pong_frame;
using test::RunningServer;
using test::text_frame;
using test::Wire;

namespace {

DoorOptions with_socket_limits(const ServerLimits& limits) {
  DoorOptions options;
  options.server.limits = limits;
  return options;
}

int close_code_after(Wire& wire) {
  while (auto message = wire.message())
    if (message->opcode == close_frame) return message->close_code();
  return 0;
}

}  // namespace

TEST_CASE("sockets: texts of all lengths come back whole") {
  RunningServer server;
  Wire wire = server.socket(server.enter());
  for (const size_t size : {0, 1, 125, 126, 127, 65535, 65536, 65537, 200'000}) {
    const std::string text(size, 'a');
    wire.send_frame(text_frame, text);
    const auto echo = wire.message();
    REQUIRE(echo.has_value());
    CHECK(echo->opcode == text_frame);
    CHECK(echo->payload == text);
  }
}

TEST_CASE("sockets: fragments are joined, with pings between them") {
  RunningServer server;
  Wire wire = server.socket(server.enter());
  wire.send_frame(text_frame, "Gr\xc3", false);
  wire.send_frame(ping_frame, "there?");
  wire.send_frame(continuation_frame, "\xbc\xc3\x9f", false);
  wire.send_frame(continuation_frame, "", false);
  wire.send_frame(continuation_frame, "e");
  const auto pong = wire.frame();
  REQUIRE(pong.has_value());
  CHECK(pong->opcode == pong_frame);
  CHECK(pong->payload == "there?");
  CHECK(wire.message()->payload ==
        "Gr\xc3\xbc\xc3\x9f"
        "e");
  CHECK(server.host.messages == 1);
}

TEST_CASE("sockets: a message that is too large ends the connection, in one frame, announced alone, or in fragments") {
  ServerLimits limits;
  limits.message_bytes = 10'000;
  RunningServer server(with_socket_limits(limits));
  const std::string cookie = server.enter();
  Wire fits = server.socket(cookie);
  fits.send_frame(text_frame, std::string(10'000, 'a'));
  CHECK(fits.message()->payload.size() == 10'000);
  Wire one = server.socket(cookie);
  one.send_frame(text_frame, std::string(10'001, 'a'));
  CHECK(close_code_after(one) == 1009);
  Wire announced = server.socket(cookie);
  announced.send(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff", 10) + "abcd");
  CHECK(announced.closes());
  Wire fragments = server.socket(cookie);
  fragments.send_frame(text_frame, std::string(4000, 'a'), false);
  for (int i = 0; i < 3; ++i) fragments.send_frame(continuation_frame, std::string(4000, 'a'), false);
  CHECK(close_code_after(fragments) == 1009);
  CHECK(server.host.messages == 1);
  CHECK(becomes([&] { return server.host.closed == 3; }));
}

TEST_CASE("sockets: what the protocol forbids ends the connection") {
  RunningServer server;
  const std::string cookie = server.enter();
  const auto code_of = [&](auto&& misbehave) {
    Wire wire = server.socket(cookie);
    misbehave(wire);
    return close_code_after(wire);
  };
  CHECK(code_of([](Wire& w) { w.send_frame(binary_frame, "abc"); }) == 1003);
  CHECK(code_of([](Wire& w) { w.send_frame(text_frame, "\xff\xfe"); }) == 1007);
  CHECK(code_of([](Wire& w) { w.send_frame(text_frame, "\xc0\xaf"); }) == 1007);
  CHECK(code_of([](Wire& w) { w.send_frame(text_frame, "abc", true, false); }) == 1002);  // without a mask
  CHECK(code_of([](Wire& w) { w.send_frame(continuation_frame, "abc"); }) == 1002);
  CHECK(code_of([](Wire& w) {
          w.send_frame(text_frame, "a", false);
          w.send_frame(text_frame, "b");
        }) == 1002);
  CHECK(code_of([](Wire& w) { w.send_frame(3, "abc"); }) == 1002);
  CHECK(code_of([](Wire& w) { w.send_frame(11, "abc"); }) == 1002);
  CHECK(code_of([](Wire& w) { w.send_frame(ping_frame, "abc", false); }) == 1002);
  CHECK(code_of([](Wire& w) { w.send_frame(ping_frame, std::string(126, 'a')); }) == 1002);
  CHECK(code_of([](Wire& w) {
          w.send(
              "\xc1\x83"
              "abcd123");
        }) == 1002);  // compressed, which was not agreed on
  CHECK(code_of([](Wire& w) { w.send_frame(close_frame, "x"); }) == 1002);
  CHECK(code_of([](Wire& w) { w.send_frame(text_frame, "throw"); }) == 1011);
  CHECK(server.host.messages == 1);
  CHECK(becomes([&] { return server.host.closed == 13; }));
  Wire good = server.socket(cookie);
  good.send_frame(text_frame, "after all that");
  CHECK(good.message()->payload == "after all that");
}

TEST_CASE("sockets: wrong handshakes open nothing") {
  RunningServer server;
  const std::string cookie = server.enter();
  const auto status_of = [&](const std::string& from, const std::string& to) {
    std::string request = server.upgrade("/socket", cookie, server.origin());
    const size_t at = request.find(from);
    REQUIRE(at != std::string::npos);
    request.replace(at, from.size(), to);
    Wire wire(server.port);
    wire.send(request);
    return wire.reply(false).status;
  };
  CHECK(status_of("Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n", "") == 400);
  CHECK(status_of("dGhlIHNhbXBsZSBub25jZQ==", "short") == 400);
  CHECK(status_of("Version: 13", "Version: 8") >= 400);
  CHECK(status_of("Upgrade: websocket", "Upgrade: h2c") == 426);
  CHECK(status_of("GET /socket", "POST /socket") == 405);
  CHECK(status_of("GET /socket", "GET /") == 404);
  CHECK(status_of("\r\n\r\n", "\r\nSec-WebSocket-Version: 13\r\n\r\n") == 400);
  Wire early(server.port);
  early.send(server.upgrade("/socket", cookie, server.origin()) +
             "\x81\x81"
             "abcd1");
  CHECK(early.reply().status == 400);
  CHECK(becomes([&] { return server.door.sockets() == 0; }));
  CHECK(server.host.messages == 0);
  CHECK(int(server.host.joined().size()) == server.host.closed);  // whoever was told of a client was told of its end
}

TEST_CASE("sockets: a goodbye of either side is answered") {
  RunningServer server;
  const std::string cookie = server.enter();
  Wire wire = server.socket(cookie), other = server.socket(cookie);
  wire.send_frame(close_frame,
                  "\x03\xe8"
                  "bye");
  CHECK(close_code_after(wire) == 1000);
  CHECK(wire.closes());
  other.send_frame(text_frame, "close");
  const auto goodbye = other.message();
  CHECK(goodbye->close_code() == 1000);
  CHECK(goodbye->payload.substr(2) == "as you wish");
  CHECK(other.closes());  // also when it does not answer
  CHECK(becomes([&] { return server.host.closed == 2; }));
}

TEST_CASE("sockets: who reads slowly gets all of it; who reads nothing is told apart, and let go") {
  ServerLimits limits;
  limits.write = 300ms;
  RunningServer server(with_socket_limits(limits));
  const std::string cookie = server.enter();
  Wire slow = server.socket(cookie, "/socket", 16'384);
  slow.send_frame(text_frame, "pictures 4");
  for (int i = 0; i < 4; ++i) {
    const auto picture = slow.message();
    REQUIRE(picture.has_value());
    CHECK(picture->payload.size() == size_t(1) << 20);
    std::this_thread::sleep_for(100ms);
  }
  Wire stuck = server.socket(cookie, "/socket", 4096);
  stuck.send_frame(text_frame, "pictures 16");
  CHECK(becomes([&] { return server.host.last_socket()->waiting() > 0 || server.host.closed == 1; }));  // seen by the session
  CHECK(becomes([&] { return server.host.closed == 1; }));
  CHECK(server.host.last_socket()->waiting() == 0);  // nothing is kept for it
  slow.send_frame(text_frame, "still here");
  CHECK(slow.message()->payload == "still here");
}

TEST_CASE("sockets: no more waits for one client than the bound") {
  ServerLimits limits;
  limits.queued_bytes = size_t(4) << 20;
  RunningServer server(with_socket_limits(limits));
  Wire stuck = server.socket(server.enter(), "/socket", 4096);
  stuck.send_frame(text_frame, "pictures 100");
  CHECK(becomes([&] { return server.host.closed == 1; }));
  CHECK_FALSE(server.host.last_socket()->send_text("more"));
}

TEST_CASE("sockets: one whose other end is silent is asked for a sign of life, and ended without one") {
  ServerLimits limits;
  limits.idle = 300ms;
  RunningServer server(with_socket_limits(limits));
  const std::string cookie = server.enter();
  Wire dead = server.socket(cookie), alive = server.socket(cookie);
  const auto until = std::chrono::steady_clock::now() + 1s;
  while (std::chrono::steady_clock::now() < until) {
    alive.send_frame(pong_frame, "");
    std::this_thread::sleep_for(30ms);
  }
  CHECK(becomes([&] { return server.host.closed == 1; }));
  CHECK(dead.closes());
  alive.send_frame(text_frame, "alive");
  CHECK(alive.message()->payload == "alive");
}

TEST_CASE("sockets: a flood of messages waits in the client, a flood of pings ends it, and others do not notice") {
  ServerLimits limits;
  limits.messages_per_second = 50;
  RunningServer server(with_socket_limits(limits));
  const std::string cookie = server.enter();
  Wire flooding = server.socket(cookie), pinging = server.socket(cookie), fragments = server.socket(cookie), other = server.socket(cookie);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) flooding.send_frame(text_frame, "x");
  for (int i = 0; i < 200 && fragments.send_frame(i ? continuation_frame : text_frame, "", false); ++i) {
  }
  other.send_frame(text_frame, "and I?");
  CHECK(other.message()->payload == "and I?");
  for (int i = 0; i < 100; ++i) CHECK(flooding.message().has_value());
  CHECK(std::chrono::steady_clock::now() - begin > 900ms);  // 50 at once, then 50 a second
  for (int i = 0; i < 200 && pinging.send_frame(ping_frame, ""); ++i) {
  }
  CHECK(pinging.closes());
  CHECK(becomes([&] { return server.host.closed == 1; }));
}

TEST_CASE("sockets: killed clients are noticed, and come back by their cookie, as who they were") {
  RunningServer server;
  const std::string cookie = server.enter();
  for (int round = 1; round <= 10; ++round) {
    Wire wire = server.socket(cookie);
    wire.send_frame(text_frame, "pictures 2");
    if (round % 2 == 0) CHECK(wire.frame().has_value());
    wire.kill();
    CHECK(becomes([&] { return server.host.closed == round; }));
  }
  CHECK(server.host.joined().size() == 10);
  Wire back = server.socket(cookie);
  back.send_frame(text_frame, "here again");
  CHECK(back.message()->payload == "here again");
  CHECK(server.door.sockets() == 1);
}

TEST_CASE("sockets: killed during the handshake or in the middle of a message") {
  RunningServer server;
  const std::string cookie = server.enter(), request = server.upgrade("/socket", cookie, server.origin());
  for (size_t cut = 0; cut <= request.size(); cut += 37) {
    Wire wire(server.port);
    wire.send(request.substr(0, cut));
    wire.kill();
  }
  for (int i = 0; i < 10; ++i) {
    Wire whole(server.port);
    whole.send(request);
    whole.kill();
  }
  Wire wire = server.socket(cookie);
  wire.send(std::string("\x81\xfe\x10\x00"
                        "abcd",
                        8) +
            "half of it");
  wire.kill();
  CHECK(becomes([&] { return server.door.connections() == 0; }));
  CHECK(becomes([&] { return int(server.host.joined().size()) == server.host.closed; }));
}

TEST_CASE("sockets: fifty clients at once, each with its own answers") {
  RunningServer server;
  const std::string cookie = server.enter();
  std::vector<Wire> clients;
  for (int i = 0; i < 50; ++i) clients.push_back(server.socket(cookie));
  CHECK(server.door.sockets() == 50);
  for (int round = 0; round < 5; ++round) {
    for (size_t i = 0; i < clients.size(); ++i) clients[i].send_frame(text_frame, fmt::format("{} of {}", i, round));
    for (size_t i = 0; i < clients.size(); ++i) CHECK(clients[i].message()->payload == fmt::format("{} of {}", i, round));
  }
  for (Wire& client : clients) client.send_frame(text_frame, "pictures 1");
  for (Wire& client : clients) CHECK(client.message()->payload.size() == size_t(1) << 20);
  CHECK(server.get("/", cookie).status == 200);
}

TEST_CASE("sockets: more than the bound are refused until one leaves; a host without room refuses, too") {
  ServerLimits limits;
  limits.sockets = 3;
  RunningServer server(with_socket_limits(limits));
  const std::string cookie = server.enter();
  const auto status = [&] {
    Wire wire(server.port);
    wire.send(server.upgrade("/socket", cookie, server.origin()));
    return wire.reply(false).status;
  };
  Wire one = server.socket(cookie), two = server.socket(cookie), three = server.socket(cookie);
  CHECK(status() == 503);
  three.kill();
  CHECK(becomes([&] { return server.door.sockets() == 2; }));
  server.host.full = true;
  CHECK(status() == 503);
  server.host.full = false;
  CHECK(status() == 101);
}

TEST_CASE("sockets: sent from many threads, messages stay whole") {
  RunningServer server;
  Wire wire = server.socket(server.enter());
  const auto socket = server.host.last_socket();
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 50; ++i) socket->send_text(std::string(size_t(t) * 40'000, char('a' + t)) + "!");
    });
  int counts[4] = {};
  for (int i = 0; i < 200; ++i) {
    const auto message = wire.message();
    REQUIRE(message.has_value());
    const size_t t = message->payload.size() / 40'000;
    REQUIRE(t < 4);
    CHECK(message->payload == std::string(t * 40'000, char('a' + t)) + "!");
    ++counts[t];
  }
  for (std::thread& t : threads) t.join();
  for (const int count : counts) CHECK(count == 50);
  CHECK(socket->waiting() == 0);
}

}  // namespace sg
