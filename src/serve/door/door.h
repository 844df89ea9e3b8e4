// SPDX-License-Identifier: Apache-2.0
// The way in: who asks, from where, and for what (docs/protocol.md, docs/security.md). `sightglass view` and `serve` make one.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "serve/door/session_host.h"
#include "serve/guard/users.h"
#include "serve/http/server.h"

namespace sg::serve {

struct DoorOptions {
  ServerOptions server;
  /// `serve`: those who have tokens of their own, which count any number of times. None: one token that counts once, with all rights
  /// (`view`).
  std::vector<User> users;
  /// `serve`: the folder that clients choose files in. "": they choose none.
  std::string folder;
  /// What the browser has in its address line when it does not ask for this machine itself: "https://view.example.org". Of a reverse proxy.
  std::vector<std::string> public_origins;
};

class Door {
 public:
  /// Listens from now on. `host` lives longer. Throws Error(usage) for options that cannot be.
  Door(const DoorOptions& options, SessionHost& host);
  ~Door();
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  uint16_t port() const;
  /// "http://127.0.0.1:8234/", of the first public origin where there is one.
  std::string address() const;
  /// address() with the token that counts once, to be opened by the user's browser; address() alone when there are users.
  std::string address_with_token() const;
  /// As Server::run and Server::stop.
  void run(const Context& context);
  void stop();
  /// As Server::connections and Server::sockets.
  size_t connections() const;
  size_t sockets() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace sg::serve
