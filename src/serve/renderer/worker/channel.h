// SPDX-License-Identifier: Apache-2.0
// Messages between two processes over a pair of sockets: JSON with bytes behind it.
#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "base/text/json.h"

namespace sg::serve {

struct ChannelMessage {
  Json head;
  std::string bytes;
};

/// One end. Any number of threads may send, one receives.
class Channel {
 public:
  /// Takes over the descriptor.
  explicit Channel(int socket) : socket_(socket) {}
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  /// False when the other end has gone.
  bool send(const Json& head, const std::string& bytes = {});
  /// Waits; nothing when the other end has gone, or has sent what is no message.
  std::optional<ChannelMessage> receive();
  /// Ends a receive() that waits, and all later ones.
  void shut();

 private:
  const int socket_;
  std::mutex sending_;
};

}  // namespace sg::serve
