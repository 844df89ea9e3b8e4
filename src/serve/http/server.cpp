// SPDX-License-Identifier: Apache-2.0
// The one file that sees Boost.Beast. One thread does all reading and writing (run()), another one asks the handlers:
//
//   accept -> HttpConnection: read - handlers (other thread) - write - read ...
//                  `- asks for a WebSocket -> SocketConnection: accept - read, write ... - on_close
//
// What sends to a client holds a SendQueue, which outlives its connection.
#include "serve/http/server.h"

#include <fcntl.h>
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <list>

#include "base/error.h"
#include "serve/guard/rate.h"
#include "serve/http/send_queue.h"
#include "serve/http/target.h"

namespace sg::serve {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::milliseconds;

constexpr size_t piece = 64 << 10;        // what is written at once, so that slow clients can be told from stuck ones
constexpr milliseconds farewell{1000};    // for the last words on either side
constexpr milliseconds look_around{100};  // whether the work is cancelled; after a failed accept
constexpr size_t longest_reason = 120;    // of a close, in bytes
constexpr size_t key_letters = 24;        // of 16 bytes in base64 (RFC 6455, section 4.1)

HttpResponse plain_answer(int status, std::string text) {
  return {status, "text/plain; charset=utf-8", {}, std::move(text) + "\n", nullptr};
}

void close_on_exec(int fd) { ::fcntl(fd, F_SETFD, FD_CLOEXEC); }

// Both directions at once: readers of files run in child processes, which may hold the descriptor for a while.
void hang_up(tcp::socket& socket) {
  error_code ignored;
  socket.shutdown(tcp::socket::shutdown_both, ignored);
  socket.close(ignored);
}

class SocketConnection;
class HttpConnection;

}  // namespace

struct ServerCore : std::enable_shared_from_this<ServerCore> {
  ServerOptions options;
  Handlers handlers;
  std::shared_ptr<asio::io_context> io = std::make_shared<asio::io_context>(1);
  asio::thread_pool answering{1};
  tcp::acceptor acceptor{*io};
  asio::steady_timer tick{*io}, pause{*io}, last_call{*io};
  std::list<std::shared_ptr<HttpConnection>> https;  // the oldest first
  std::list<std::shared_ptr<SocketConnection>> sockets;
  size_t opening = 0;  // requests for WebSockets that are with the handlers
  std::atomic<size_t> connection_count{0}, socket_count{0};
  std::atomic<bool> stopping{false};
  uint16_t port = 0;

  void listen();
  void accept();
  void watch(const Context& context);
  void shut();
  void count() {
    connection_count = https.size() + sockets.size();
    socket_count = sockets.size();
  }
  template <class Connection>
  void remove(std::list<std::shared_ptr<Connection>>& from, const std::shared_ptr<Connection>& c) {
    from.remove(c);
    count();
    if (stopping && https.empty() && sockets.empty()) last_call.cancel();
  }
};

namespace {

class SocketConnection : public std::enable_shared_from_this<SocketConnection> {
 public:
  SocketConnection(std::shared_ptr<ServerCore> core, beast::tcp_stream stream, std::shared_ptr<SendQueue> client, SocketHandler handler)
      : core_(std::move(core)),
        ws_(std::move(stream)),
        client_(std::move(client)),
        handler_(std::move(handler)),
        buffer_(core_->options.limits.message_bytes + 2 * piece),
        stuck_(*core_->io),
        rest_(*core_->io),
        goodbye_(*core_->io),
        rate_(core_->options.limits.messages_per_second) {}

  void start(const http::request<http::empty_body>& request) {
    const ServerLimits& limits = core_->options.limits;
    client_->on_change([io = core_->io, weak = weak_from_this()] {
      asio::post(*io, [weak] {
        if (const auto self = weak.lock()) self->write();
      });
    });
    beast::get_lowest_layer(ws_).expires_never();  // the WebSocket has times of its own
    ws_.set_option(websocket::stream_base::timeout{limits.request, limits.idle, true});
    ws_.set_option(websocket::stream_base::decorator([headers = core_->options.headers](websocket::response_type& response) {
      for (const auto& [name, value] : headers) response.set(name, value);
    }));
    ws_.read_message_max(limits.message_bytes);
    ws_.control_callback([this](websocket::frame_type, beast::string_view) {
      if (rate_.take() || closing_) return;
      asio::post(*core_->io, [weak = weak_from_this()] {
        if (const auto self = weak.lock()) self->close(websocket::close_code::policy_error, "too many pings");
      });
    });
    ws_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return self->finish();
      self->accepted_ = true;
      self->watch(false);
      self->read();
      self->write();
    });
  }

  // There may be something to send.
  void write() {
    if (finished_ || !accepted_) return;
    if (client_->overrun()) return finish();
    if (writing_ || closing_) return;
    message_ = client_->front();
    written_ = 0;
    if (message_) return write_piece();
    if (const auto goodbye = client_->goodbye()) close(websocket::close_code::normal, *goodbye);
  }

  void close(websocket::close_code code, const std::string& reason) {
    if (finished_ || closing_) return;
    if (!accepted_) return finish();
    closing_ = true;
    // The other side has its time to answer; what it does not, the clock does.
    stuck_.expires_after(farewell);
    stuck_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->finish();
    });
    farewell_ = {code, beast::string_view(reason.data(), std::min(reason.size(), longest_reason))};
    if (!writing_) say_farewell();
  }

  void finish() {
    if (finished_) return;
    finished_ = true;
    const auto self = shared_from_this();
    stuck_.cancel();
    rest_.cancel();
    goodbye_.cancel();
    client_->end();
    hang_up(beast::get_lowest_layer(ws_).socket());
    core_->remove(core_->sockets, self);
    try {
      if (handler_.on_close) handler_.on_close();
    } catch (const std::exception&) {  // the connection has ended already
    }
    handler_ = {};
  }

 private:
  void read() {
    if (finished_) return;
    ws_.async_read_some(buffer_, piece, [self = shared_from_this()](error_code error, size_t bytes) { self->have_read(error, bytes); });
  }

  void have_read(error_code error, size_t bytes) {
    if (finished_) return;
    if (error) return closing_ ? void() : finish();
    if (ws_.is_message_done()) {
      if (!ws_.got_text()) return close(websocket::close_code::unknown_data, "messages are text: JSON");
      const auto data = buffer_.cdata();
      try {
        if (handler_.on_text && !closing_) handler_.on_text({static_cast<const char*>(data.data()), data.size()});
      } catch (const std::exception&) {
        return close(websocket::close_code::internal_error, "the message could not be taken");
      }
      buffer_.consume(buffer_.size());
    } else if (bytes > 0) {
      return read();
    }
    // A message, or a fragment without content, of which any number makes no message.
    rest();
  }

  // Whose goodbye has begun has a moment for it: Beast waits for the other side to hang up, without telling, after whatever broke the
  // rules.
  void watch(bool was_ending) {
    if (finished_) return;
    const bool ending = !ws_.is_open();
    if (ending && was_ending) return finish();
    goodbye_.expires_after(farewell);
    goodbye_.async_wait([self = shared_from_this(), ending](error_code error) {
      if (!error) self->watch(ending);
    });
  }

  void rest() {
    if (finished_) return;
    if (rate_.take()) return read();
    rest_.expires_after(rate_.wait());
    rest_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->rest();
    });
  }

  void say_farewell() {
    ws_.async_close(farewell_, [self = shared_from_this()](error_code) { self->finish(); });
  }

  void write_piece() {
    const std::string& all = *message_->bytes;
    const size_t size = std::min(piece, all.size() - written_);
    const bool last = written_ + size == all.size();
    writing_ = true;
    stuck_.expires_after(core_->options.limits.write);
    stuck_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->finish();
    });
    ws_.text(message_->text);
    ws_.async_write_some(last, asio::buffer(all.data() + written_, size),
                         [self = shared_from_this(), size, last](error_code error, size_t) {
                           self->writing_ = false;
                           if (self->finished_) return;
                           if (error || self->closing_) return self->finish();
                           self->stuck_.cancel();
                           self->written_ += size;
                           if (!last) return self->write_piece();
                           self->message_.reset();
                           self->client_->pop();
                           self->write();
                         });
  }

  const std::shared_ptr<ServerCore> core_;
  websocket::stream<beast::tcp_stream, false> ws_;  // false: no compression, which pictures do not need and bombs do
  const std::shared_ptr<SendQueue> client_;
  SocketHandler handler_;
  beast::flat_buffer buffer_;
  asio::steady_timer stuck_, rest_, goodbye_;
  Rate rate_;
  std::optional<SendQueue::Message> message_;  // that is on its way
  size_t written_ = 0;
  websocket::close_reason farewell_;
  bool accepted_ = false, writing_ = false, closing_ = false, finished_ = false;
};

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(std::shared_ptr<ServerCore> core, tcp::socket socket)
      : core_(std::move(core)), stream_(std::move(socket)), buffer_(2 * piece), rate_(core_->options.limits.requests_per_second) {}

  bool waits() const { return waits_; }

  void read() {
    parser_.emplace();
    parser_->header_limit(uint32_t(core_->options.limits.header_bytes));
    waits_ = true;
    stream_.expires_after(core_->options.limits.request);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, size_t) {
      self->waits_ = false;
      self->have_read(error);
    });
  }

  void finish() {
    hang_up(stream_.socket());
    core_->remove(core_->https, shared_from_this());
  }

 private:
  void have_read(error_code error) {
    if (core_->stopping) return finish();
    keep_ = false;
    if (error == http::error::header_limit) return write(plain_answer(431, "The header of the request is too long."));
    if (error == http::error::unexpected_body || error == http::error::body_limit)
      return write(plain_answer(413, "Requests have no body here."));
    if (error.category() == make_error_code(http::error::bad_method).category() && error != http::error::end_of_stream &&
        error != http::error::partial_message)
      return write(plain_answer(400, "This is no request of HTTP/1.1."));
    if (error) return finish();

    const auto& request = parser_->get();
    const auto text = [](beast::string_view s) { return std::string(s.data(), s.size()); };
    HttpRequest asked;
    asked.method = text(request.method_string());
    if (asked.method != "GET" && asked.method != "HEAD") {
      HttpResponse refusal = plain_answer(405, "Only GET and HEAD are answered here.");
      refusal.headers.emplace_back("Allow", "GET, HEAD");
      return write(std::move(refusal));
    }
    auto target = parse_target({request.target().data(), request.target().size()});
    if (!target || !single_headers()) return write(plain_answer(400, "This is no request that a browser would send."));
    if (!rate_.take()) return write(plain_answer(429, "Too many requests."));
    asked.path = std::move(target->path);
    asked.query = std::move(target->query);
    asked.host = text(request[http::field::host]);
    asked.origin = text(request[http::field::origin]);
    asked.cookie = text(request[http::field::cookie]);
    asked.fetch_site = text(request["Sec-Fetch-Site"]);
    asked.accept_encoding = text(request[http::field::accept_encoding]);
    asked.if_none_match = text(request[http::field::if_none_match]);
    keep_ = request.keep_alive();
    stream_.expires_never();
    if (websocket::is_upgrade(request)) return open(std::move(asked));
    asio::post(core_->answering, [self = shared_from_this(), asked = std::move(asked)] {
      HttpResponse response;
      try {
        response = self->core_->stopping ? plain_answer(503, "The server ends.") : self->core_->handlers.answer(asked);
      } catch (const std::exception& e) {
        response = plain_answer(500, e.what());
      }
      asio::post(*self->core_->io, [self, response = std::move(response)]() mutable { self->write(std::move(response)); });
    });
  }

  // A header that comes twice may be read one way here and another way by a proxy.
  bool single_headers() const {
    const auto& request = parser_->get();
    for (const auto field : {http::field::host, http::field::origin, http::field::cookie, http::field::upgrade, http::field::content_length,
                             http::field::transfer_encoding, http::field::sec_websocket_key, http::field::sec_websocket_version})
      if (request.count(field) > 1) return false;
    return request.count(http::field::transfer_encoding) == 0;
  }

  void open(HttpRequest asked) {
    keep_ = false;
    if (buffer_.size() > 0) return write(plain_answer(400, "Messages came before the WebSocket was there."));
    if (parser_->get()[http::field::sec_websocket_key].size() != key_letters)
      return write(plain_answer(400, "The key of the WebSocket is none."));
    if (core_->sockets.size() + core_->opening >= core_->options.limits.sockets)
      return write(plain_answer(503, "There are too many windows at this server; close one of them."));
    ++core_->opening;
    asio::post(core_->answering, [self = shared_from_this(), asked = std::move(asked)] {
      auto client = std::make_shared<SendQueue>(self->core_->options.limits.queued_bytes);
      HttpResponse refusal = plain_answer(503, "The server ends.");
      std::optional<SocketHandler> handler;
      try {
        if (!self->core_->stopping && self->core_->handlers.open) handler = self->core_->handlers.open(asked, client, refusal);
      } catch (const std::exception& e) {
        refusal = plain_answer(500, e.what());
      }
      asio::post(*self->core_->io, [self, client, refusal = std::move(refusal), handler = std::move(handler)]() mutable {
        --self->core_->opening;
        if (!handler) return self->write(std::move(refusal));
        self->become_socket(client, std::move(*handler));
      });
    });
  }

  void become_socket(const std::shared_ptr<SendQueue>& client, SocketHandler handler) {
    const auto self = shared_from_this();
    core_->https.remove(self);
    const auto connection = std::make_shared<SocketConnection>(core_, std::move(stream_), client, std::move(handler));
    core_->sockets.push_back(connection);
    core_->count();
    if (core_->stopping) return connection->finish();
    connection->start(parser_->get());
  }

  void write(HttpResponse response) {
    const bool head = parser_ && parser_->is_header_done() && parser_->get().method() == http::verb::head;
    said_ = std::move(response);
    auto& message = answer_.emplace();
    message.result(unsigned(said_.status));
    message.version(11);
    for (const auto& [name, value] : core_->options.headers) message.set(name, value);
    for (const auto& [name, value] : said_.headers) message.set(name, value);
    if (!said_.type.empty()) message.set(http::field::content_type, said_.type);
    const std::string_view bytes = said_.bytes();
    message.keep_alive(keep_);
    if (said_.status != 304) message.content_length(bytes.size());
    if (!head && said_.status != 304) message.body() = {bytes.data(), bytes.size()};
    serializer_.emplace(message);
    serializer_->limit(piece);
    write_piece();
  }

  void write_piece() {
    stream_.expires_after(core_->options.limits.write);
    http::async_write_some(stream_, *serializer_, [self = shared_from_this()](error_code error, size_t) {
      if (error) return self->finish();
      if (!self->serializer_->is_done()) return self->write_piece();
      self->said_ = {};
      if (self->keep_ && !self->core_->stopping) return self->read();
      self->say_goodbye();
    });
  }

  // What the client still sends is read for a moment: closing over it would take the answer away from it.
  void say_goodbye() {
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(farewell);
    drain(size_t(1) << 20);
  }
  void drain(size_t most) {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(piece), [self = shared_from_this(), most](error_code error, size_t bytes) {
      if (error || bytes >= most) return self->finish();
      self->drain(most - bytes);
    });
  }

  const std::shared_ptr<ServerCore> core_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  using Answer = http::response<http::span_body<const char>>;
  HttpResponse said_;
  std::optional<Answer> answer_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
  Rate rate_;
  bool waits_ = false, keep_ = false;
};

}  // namespace

void ServerCore::listen() {
  error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error) fail_usage(fmt::format("'{}' is no address", options.address), "address", "give numbers: 127.0.0.1, ::1, 0.0.0.0");
  const tcp::endpoint endpoint(address, options.port);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    fail_usage(fmt::format("cannot listen: {}", error.message()), fmt::format("{} port {}", options.address, options.port),
               "another port, or 0 for any that is free");
  close_on_exec(acceptor.native_handle());
  port = acceptor.local_endpoint().port();
}

void ServerCore::accept() {
  acceptor.async_accept([self = shared_from_this()](error_code error, tcp::socket socket) {
    if (self->stopping) return;
    if (error) {  // no descriptors left, say: others may end meanwhile
      self->pause.expires_after(look_around);
      self->pause.async_wait([self](error_code stopped) {
        if (!stopped && !self->stopping) self->accept();
      });
      return;
    }
    close_on_exec(socket.native_handle());
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    if (self->https.size() + self->sockets.size() >= self->options.limits.connections) {
      const auto oldest = std::find_if(self->https.begin(), self->https.end(), [](const auto& c) { return c->waits(); });
      if (oldest == self->https.end()) {
        hang_up(socket);
        return self->accept();
      }
      const auto gives_way = *oldest;
      gives_way->finish();
    }
    const auto connection = std::make_shared<HttpConnection>(self, std::move(socket));
    self->https.push_back(connection);
    self->count();
    connection->read();
    self->accept();
  });
}

void ServerCore::watch(const Context& context) {
  tick.expires_after(look_around);
  tick.async_wait([self = shared_from_this(), &context](error_code stopped) {
    if (stopped || self->stopping) return;
    if (context.cancelled()) return self->shut();
    self->watch(context);
  });
}

void ServerCore::shut() {
  stopping = true;
  error_code ignored;
  acceptor.close(ignored);
  tick.cancel();
  pause.cancel();
  for (const auto& connection : std::list(https))
    if (connection->waits()) connection->finish();
  for (const auto& connection : std::list(sockets)) connection->close(websocket::close_code::going_away, "the server ends");
  if (https.empty() && sockets.empty()) return;
  last_call.expires_after(2 * farewell);
  last_call.async_wait([self = shared_from_this()](error_code) {
    for (const auto& connection : std::list(self->https)) connection->finish();
    for (const auto& connection : std::list(self->sockets)) connection->finish();
  });
}

Server::Server(const ServerOptions& options, Handlers handlers) : core_(std::make_shared<ServerCore>()) {
  core_->options = options;
  core_->handlers = std::move(handlers);
  core_->listen();
  core_->accept();
}

Server::~Server() {
  if (!core_->stopping) core_->shut();
  core_->answering.join();
  core_->io->restart();
  core_->io->run();
}

uint16_t Server::port() const { return core_->port; }
size_t Server::connections() const { return core_->connection_count; }
size_t Server::sockets() const { return core_->socket_count; }

void Server::run(const Context& context) {
  core_->watch(context);
  core_->io->run();
  // What the handlers were asked last is given to them, so that whoever was told of a client is told of its end.
  core_->answering.join();
  core_->io->restart();
  core_->io->run();
}

void Server::stop() {
  asio::post(*core_->io, [core = core_] {
    if (!core->stopping) core->shut();
  });
}

}  // namespace sg::serve
