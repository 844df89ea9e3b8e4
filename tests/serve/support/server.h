// SPDX-License-Identifier: Apache-2.0
// A server that runs in a thread of its own, with sessions that repeat what they are told.
#pragma once
#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "serve/door/door.h"
#include "serve/support/wire.h"

namespace sg::test {

/// Repeats every text; "pictures N": N binary messages of 1 MiB each; "close"; "throw".
class EchoHost : public serve::SessionHost {
 public:
  struct Joined {
    std::string file, user;
    serve::Rights rights;
  };
  std::optional<serve::SocketHandler> join(const std::string& file, serve::Rights rights, const std::string& user,
                                           std::shared_ptr<serve::Socket> socket) override;
  std::optional<serve::Saved> saved(const std::string& id) override;

  std::function<std::optional<serve::Saved>(const std::string& id)> on_saved;
  std::atomic<int> messages{0}, closed{0};
  std::atomic<bool> full{false};
  std::vector<Joined> joined() const;
  std::shared_ptr<serve::Socket> last_socket() const;

 private:
  mutable std::mutex mutex_;
  std::vector<Joined> joined_;
  std::shared_ptr<serve::Socket> last_;
};

class RunningServer {
 public:
  explicit RunningServer(serve::DoorOptions options = {});
  ~RunningServer();

  /// The lines of a request as a browser of this machine sends it; `more` are further headers with their line ends.
  std::string request(const std::string& target, const std::string& more = "", const std::string& method = "GET") const;
  Reply get(const std::string& target, const std::string& more = "") const;
  /// "Cookie: sightglass_PORT=...\r\n", by the token that counts once or by one given.
  std::string enter(const std::string& token = "");
  std::string origin() const { return "http://127.0.0.1:" + std::to_string(port); }
  /// A request for a WebSocket. `more` has the cookie; `origin` "": none is sent.
  std::string upgrade(const std::string& target, const std::string& more, const std::string& origin) const;
  /// A WebSocket with the server's answer behind it; 101 is required unless told otherwise.
  Wire socket(const std::string& cookie, const std::string& target = "/socket", int receive_buffer = 0) const;
  /// The number after "token=".
  std::string token() const;
  void stop();

  EchoHost host;
  serve::Door door;
  const uint16_t port;
  Context context;

 private:
  std::thread thread_;
};

/// Whether something becomes true within ten seconds.
bool becomes(const std::function<bool()>& is);

}  // namespace sg::test
