// SPDX-License-Identifier: Apache-2.0
// All sessions of a server.
#pragma once
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "serve/door/session_host.h"
#include "serve/session/session.h"

namespace sg::serve {

/// Makes the session of a file; "": of what the command names.
using MakeSession = std::function<std::shared_ptr<Session>(const std::string& file)>;

/// A session lasts as long as it has windows, and `idle` longer, so that a window which comes back finds it as it was.
class Sessions : public SessionHost {
 public:
  explicit Sessions(MakeSession make, size_t most = 16, std::chrono::minutes idle = std::chrono::minutes(30));
  /// Makes the session of a file before a window asks for it, so that its data are read meanwhile.
  void begin(const std::string& file);
  std::optional<SocketHandler> join(const std::string& file, Rights rights, const std::string& user,
                                    std::shared_ptr<Socket> socket) override;
  std::optional<Saved> saved(const std::string& id) override;

 private:
  struct Held {
    std::shared_ptr<Session> session;
    std::chrono::steady_clock::time_point used;
  };
  void drop_idle();
  Held* held(const std::string& file);  // null: there is no room
  const MakeSession make_;
  const size_t most_;
  const std::chrono::minutes idle_;
  std::mutex mutex_;
  std::map<std::string, Held> sessions_;
};

}  // namespace sg::serve
