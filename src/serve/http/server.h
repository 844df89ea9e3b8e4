// SPDX-License-Identifier: Apache-2.0
// HTTP and WebSocket on one port. Nothing is decided here: who may ask for what is up to the handlers (door/). What a client sends, how
// much waits for it and how long it may take are bounded here.
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/context.h"
#include "serve/http/request.h"

namespace sg::serve {

/// The bounds of a server. Times are the longest that something may take.
struct ServerLimits {
  size_t sockets = 64;                        ///< WebSockets at a time
  size_t connections = 256;                   ///< of all kinds at a time; the oldest without a WebSocket gives way to a new one
  size_t header_bytes = 16 << 10;             ///< of a request
  size_t message_bytes = 256 << 10;           ///< of a message of a client, its fragments together
  size_t queued_bytes = size_t(64) << 20;     ///< that wait for one client
  double requests_per_second = 100;           ///< of one connection; more are answered 429
  double messages_per_second = 500;           ///< of one WebSocket; more wait in the client, more pings end it
  std::chrono::milliseconds request{10'000};  ///< from one request's answer (or the connection) to the end of the next one's header
  std::chrono::milliseconds write{20'000};    ///< for the next 64 KiB to leave
  std::chrono::milliseconds idle{60'000};     ///< of a WebSocket: without a sign of life; it is asked for one after half of it
};

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< of this machine, as numbers; "::1", "0.0.0.0"
  uint16_t port = 0;                  ///< 0: any that is free
  ServerLimits limits;
  std::vector<std::pair<std::string, std::string>> headers;  ///< of every answer, also of those that the server gives itself
};

/// A WebSocket as those see it who send to a client. All functions are safe from any thread, also after the client has gone.
class Socket {
 public:
  virtual ~Socket() = default;
  /// Queues a message. False when the client has gone, or when more than ServerLimits::queued_bytes would wait: then it is dropped, and
  /// the client with it, as it would miss what the others see. Senders that can leave out messages look at waiting() first.
  virtual bool send_text(std::string text) = 0;
  virtual bool send_binary(std::shared_ptr<const std::string> bytes) = 0;
  /// Bytes that wait to leave, the message on its way included; each message counts 64 more than it has.
  virtual size_t waiting() const = 0;
  virtual bool open() const = 0;
  /// Says goodbye after what is queued; `reason` (at most 120 bytes) is for the person.
  virtual void close(std::string reason) = 0;
};

/// What a session does with a WebSocket. Both are called from the thread of the connections and must not wait: work is handed to threads
/// of the session's own. on_close comes once, last, whatever ended the connection.
struct SocketHandler {
  std::function<void(std::string_view text)> on_text;
  std::function<void()> on_close;
};

/// Called by one thread, one at a time, which is not that of the connections: they may take a while. What they throw is answered 500.
struct Handlers {
  std::function<HttpResponse(const HttpRequest&)> answer;
  /// A request for a WebSocket. Fills in `refusal` when it gives none. Nothing that is sent before the client has its answer is lost.
  std::function<std::optional<SocketHandler>(const HttpRequest&, std::shared_ptr<Socket>, HttpResponse& refusal)> open;
};

struct ServerCore;

class Server {
 public:
  /// Listens from now on. Throws Error(usage) for an address that is none and a port that is taken.
  Server(const ServerOptions& options, Handlers handlers);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  uint16_t port() const;
  /// Serves until stop() or until the context is cancelled (looked at ten times a second); every on_close has been called then.
  void run(const Context& context);
  /// From any thread, not from a signal handler.
  void stop();
  /// Connections of all kinds, and those of them that are WebSockets.
  size_t connections() const;
  size_t sockets() const;

 private:
  std::shared_ptr<ServerCore> core_;
};

}  // namespace sg::serve
