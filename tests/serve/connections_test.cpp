// SPDX-License-Identifier: Apache-2.0
// Connections as they come: broken, slow, half open, too many, too large. Limits are small here, so that they are met soon.
#include <fmt/core.h>

#include "serve/support/server.h"
#include "support/test.h"

namespace sg {

using namespace serve;
using namespace std::chrono_literals;
using test::becomes;
using test::contains;
using test::Reply;
using test::RunningServer;
using test::Wire;

namespace {

DoorOptions with_limits(const ServerLimits& limits) {
  DoorOptions options;
  options.server.limits = limits;
  return options;
}

}  // namespace

TEST_CASE("connections: what is no request is told so, and the connection ends") {
  RunningServer server;
  for (const std::string& bytes :
       {std::string("hello\r\n\r\n"), std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET  HTTP/1.1\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost\r\n\r\n"), std::string("GET http://127.0.0.1/ HTTP/1.1\r\n\r\n"),
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11) + "\r\n\r\n",
        std::string("GET / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n"), std::string("GET /%zz HTTP/1.1\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nX: a\0b\r\n\r\n", 26)}) {
    Wire wire(server.port);
    wire.send(bytes);
    const Reply reply = wire.reply();
    CHECK_MESSAGE((reply.status >= 400 && reply.status < 500), bytes);
    CHECK_MESSAGE(wire.closes(), bytes);
  }
  CHECK(server.get("/", server.enter()).status == 200);
}

TEST_CASE("connections: headers and bodies are bounded") {
  RunningServer server;
  Wire long_header(server.port), body(server.port), chunked(server.port), endless(server.port);
  long_header.send("GET / HTTP/1.1\r\nX: " + std::string(20'000, 'a') + "\r\n\r\n");
  CHECK(long_header.reply().status == 431);
  endless.send("GET /" + std::string(100'000, 'a'));
  CHECK(endless.reply().status == 431);
  body.send(server.request("/", "Content-Length: 5\r\n") + "hello");
  CHECK(body.reply().status == 413);
  CHECK(body.closes());
  CHECK(server.get("/", server.enter()).status == 200);
}

TEST_CASE("connections: several requests on one are answered in turn, in pieces of one byte as well") {
  RunningServer server;
  const std::string cookie = server.enter();
  Wire wire(server.port);
  wire.send(server.request("/", cookie) + server.request("/none", cookie) + server.request("/", cookie));
  CHECK(wire.reply().status == 200);
  CHECK(wire.reply().status == 404);
  CHECK(wire.reply().status == 200);
  for (const char c : server.request("/", cookie)) CHECK(wire.send({&c, 1}));
  CHECK(wire.reply().status == 200);
}

TEST_CASE("connections: who says nothing, or half of a request, is not waited for") {
  ServerLimits limits;
  limits.request = 200ms;
  RunningServer server(with_limits(limits));
  Wire silent(server.port), half(server.port), dripping(server.port);
  half.send("GET / HTTP/1.1\r\nHost: ");
  CHECK(silent.closes());
  CHECK(half.closes());
  for (int i = 0; i < 100 && dripping.send("G"); ++i) std::this_thread::sleep_for(10ms);  // a letter now and then buys no time
  CHECK(dripping.closes());
  CHECK(becomes([&] { return server.door.connections() == 0; }));
}

TEST_CASE("connections: too many requests on one are refused") {
  ServerLimits limits;
  limits.requests_per_second = 20;
  RunningServer server(with_limits(limits));
  const std::string cookie = server.enter();
  Wire wire(server.port);
  int answered = 0, status = 200;
  for (int i = 0; i < 1000 && status == 200; ++i) {
    wire.send(server.request("/", cookie));
    status = wire.reply().status;
    answered += status == 200;
  }
  CHECK(status == 429);
  CHECK(answered >= 20);
  CHECK(wire.closes());
  CHECK(server.get("/", cookie).status == 200);
}

TEST_CASE("connections: a flood of silent ones keeps nobody out") {
  ServerLimits limits;
  limits.connections = 40;
  RunningServer server(with_limits(limits));
  const std::string cookie = server.enter();
  Wire kept = server.socket(cookie);
  std::vector<Wire> flood;
  for (int i = 0; i < 400; ++i) {
    flood.emplace_back(server.port);
    if (i % 100 == 0) CHECK(server.get("/", cookie).status == 200);
  }
  CHECK(server.get("/", cookie).status == 200);
  CHECK(server.door.connections() <= 40);
  kept.send_frame(test::text_frame, "still here");
  CHECK(kept.message()->payload == "still here");
  int closed = 0;
  for (size_t i = 0; i < 300; ++i) closed += flood[i].closes();
  CHECK(closed == 300);
}

TEST_CASE("connections: a flood of requests without a token is answered, and others are served meanwhile") {
  RunningServer server;
  const std::string cookie = server.enter();
  std::atomic<int> refused{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 100; ++i) {
        Wire wire(server.port);
        wire.send(server.request("/catalog.json"));
        refused += wire.reply().status == 403;
      }
    });
  for (int i = 0; i < 20; ++i) CHECK(server.get("/", cookie).status == 200);
  for (std::thread& t : threads) t.join();
  CHECK(refused == 400);
}

TEST_CASE("connections: the server ends with all of them, and says goodbye to those who listen") {
  RunningServer server;
  const std::string cookie = server.enter();
  Wire socket = server.socket(cookie), silent(server.port), stuck = server.socket(cookie, "/socket", 4096);
  stuck.send_frame(test::text_frame, "pictures 8");
  CHECK(becomes([&] { return server.host.messages == 1; }));
  server.context.cancel();
  const auto goodbye = socket.message();
  REQUIRE(goodbye.has_value());
  CHECK(goodbye->close_code() == 1001);
  socket.send_frame(test::close_frame, goodbye->payload);
  server.stop();
  CHECK(silent.closes());
  CHECK(stuck.closes());
  CHECK(server.host.closed == 2);
  CHECK_FALSE(server.host.last_socket()->open());
  CHECK_FALSE(server.host.last_socket()->send_text("to nobody"));
}

TEST_CASE("connections: a port that is taken and an address that is none are usage errors") {
  RunningServer server;
  test::EchoHost host;
  DoorOptions options;
  options.server.port = server.port;
  CHECK(contains(test::error_of([&] { Door(options, host); }), "another port"));
  options.server.port = 0;
  options.server.address = "localhost";
  CHECK(contains(test::error_of([&] { Door(options, host); }), "'localhost' is no address"));
}

TEST_CASE("connections: the address is loopback unless another one is given") {
  CHECK(DoorOptions().server.address == "127.0.0.1");
  RunningServer server;
  CHECK(server.door.address() == fmt::format("http://127.0.0.1:{}/", server.port));
}

}  // namespace sg
