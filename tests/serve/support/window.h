// SPDX-License-Identifier: Apache-2.0
// A window without a browser: what a session sends it is kept, and waited for.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "base/text/json.h"
#include "serve/session/session.h"

namespace sg::test {

struct Shot {
  Json header;
  std::string bytes;
};

class Window {
 public:
  Window(serve::Session& session, serve::Rights rights = serve::Rights::edit);
  ~Window();
  /// Single quotes stand for double ones.
  void say(std::string message);
  void close();

  /// The next message of that kind, those of other kinds before it left out. Fails the test after 60 seconds.
  Json next(const std::string& is);
  /// The next picture, which counts as shown.
  Shot next_frame();
  /// Pictures up to the final one, which is the last.
  std::vector<Shot> frames();
  /// Messages that are there now.
  size_t waiting() const;
  /// Pictures count as shown only when this is true.
  bool shows = true;

 private:
  class Wire;
  std::shared_ptr<Wire> wire_;
  serve::SocketHandler handler_;
};

}  // namespace sg::test
