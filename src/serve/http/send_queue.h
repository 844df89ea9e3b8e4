// SPDX-License-Identifier: Apache-2.0
// What waits for one client: filled from any thread, emptied by that of the connections.
#pragma once
#include <deque>
#include <functional>
#include <mutex>
#include <optional>

#include "serve/http/server.h"

namespace sg::serve {

class SendQueue : public Socket {
 public:
  struct Message {
    bool text = true;
    std::shared_ptr<const std::string> bytes;
  };
  /// At most so many bytes wait.
  explicit SendQueue(size_t most) : most_(most) {}

  bool send_text(std::string text) override;
  bool send_binary(std::shared_ptr<const std::string> bytes) override;
  size_t waiting() const override;
  bool open() const override;
  void close(std::string reason) override;

  // For the connection.
  /// Called from any thread whenever one of the below has changed.
  void on_change(std::function<void()> wake);
  std::optional<Message> front() const;
  void pop();
  /// What close() was told, once nothing waits any more.
  std::optional<std::string> goodbye() const;
  /// More than may wait was sent.
  bool overrun() const;
  /// The client has gone.
  void end();

 private:
  bool send(Message message);
  void wake();
  const size_t most_;
  mutable std::mutex mutex_;
  std::function<void()> wake_;
  std::deque<Message> queue_;
  size_t waiting_ = 0;
  bool open_ = true, overrun_ = false;
  std::optional<std::string> goodbye_;
};

}  // namespace sg::serve
