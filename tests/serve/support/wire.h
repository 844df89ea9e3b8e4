// SPDX-License-Identifier: Apache-2.0
// A client that writes bytes: HTTP and WebSocket frames by hand, so that wrong ones can be sent. Nothing here waits longer than ten
// seconds.
#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sg::test {

struct Reply {
  int status = 0;                              ///< 0: none came
  std::map<std::string, std::string> headers;  ///< names in small letters
  std::string body;
};

struct Frame {
  int opcode = 0;
  bool final = true;
  std::string payload;
  /// Of a close frame; 0 for none.
  int close_code() const { return opcode == 8 && payload.size() >= 2 ? int(uint8_t(payload[0])) << 8 | uint8_t(payload[1]) : 0; }
};

constexpr int text_frame = 1, binary_frame = 2, continuation_frame = 0, close_frame = 8, ping_frame = 9, pong_frame = 10;

class Wire {
 public:
  explicit Wire(uint16_t port, int receive_buffer = 0);
  ~Wire();
  Wire(Wire&& other) noexcept;
  Wire(const Wire&) = delete;

  /// False when the other side has closed.
  bool send(std::string_view bytes);
  /// The next bytes, "" at the end or when nothing comes in time.
  std::string receive(std::chrono::milliseconds longest = std::chrono::seconds(10));
  /// Whether the other side closes in time; what comes before is dropped.
  bool closes(std::chrono::milliseconds longest = std::chrono::seconds(10));
  /// An answer to a request; without its body after HEAD.
  Reply reply(bool has_body = true);
  /// A frame as a client sends it: masked unless told otherwise.
  bool send_frame(int opcode, std::string_view payload, bool final = true, bool masked = true);
  /// The next frame that is no ping; nothing at the end or when none comes in time.
  std::optional<Frame> frame(std::chrono::milliseconds longest = std::chrono::seconds(10));
  /// The next message, its fragments joined; a close frame as it is.
  std::optional<Frame> message(std::chrono::milliseconds longest = std::chrono::seconds(10));
  /// Ends at once, without goodbye (RST).
  void kill();
  int fd() const { return fd_; }

 private:
  bool more(std::chrono::steady_clock::time_point until);
  int fd_ = -1;
  std::string have_;
};

}  // namespace sg::test
