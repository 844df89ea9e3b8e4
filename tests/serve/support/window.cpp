// SPDX-License-Identifier: Apache-2.0
#include "serve/support/window.h"

#include <algorithm>
#include <chrono>

#include "support/test.h"

namespace sg::test {

class Window::Wire : public serve::Socket {
 public:
  bool send_text(std::string text) override {
    const std::lock_guard lock(mutex);
    texts.push_back(parse_json(text, "message"));
    came.notify_all();
    return open_;
  }
  bool send_binary(std::shared_ptr<const std::string> bytes) override {
    const std::lock_guard lock(mutex);
    size_t head = 0;
    for (size_t i = 0; i < 4; ++i) head |= size_t(uint8_t((*bytes)[i])) << 8 * i;
    frames.push_back({parse_json(std::string_view(*bytes).substr(4, head), "frame"), bytes->substr(4 + head)});
    came.notify_all();
    return open_;
  }
  size_t waiting() const override { return 0; }
  bool open() const override { return open_; }
  void close(std::string) override { open_ = false; }

  template <class T>
  std::optional<T> take(std::deque<T>& from, const std::function<bool(const T&)>& wanted) {
    std::unique_lock lock(mutex);
    std::optional<T> found;
    came.wait_for(lock, std::chrono::seconds(60), [&] {
      while (!from.empty() && !found) {
        if (wanted(from.front())) found = from.front();
        from.pop_front();
      }
      return found.has_value();
    });
    return found;
  }

  mutable std::mutex mutex;
  std::condition_variable came;
  std::deque<Json> texts;
  std::deque<Shot> frames;
  bool open_ = true;
};

Window::Window(serve::Session& session, serve::Rights rights)
    : wire_(std::make_shared<Wire>()), handler_(session.join(rights, "someone", wire_)) {}
Window::~Window() { close(); }

void Window::close() {
  if (handler_.on_close) handler_.on_close();
  handler_ = {};
}

void Window::say(std::string message) {
  std::replace(message.begin(), message.end(), '\'', '"');
  handler_.on_text(message);
}

Json Window::next(const std::string& is) {
  const auto found = wire_->take<Json>(wire_->texts, [&](const Json& m) { return m["is"].text() == is; });
  INFO("waiting for ", is);
  REQUIRE(found);
  return *found;
}

Shot Window::next_frame() {
  const auto found = wire_->take<Shot>(wire_->frames, [](const Shot&) { return true; });
  REQUIRE_MESSAGE(found, "no picture came");
  if (shows) say("{'do':'shown','view':" + std::to_string(int(found->header["view"].number())) + "}");
  return *found;
}

std::vector<Shot> Window::frames() {
  std::vector<Shot> all;
  do all.push_back(next_frame());
  while (!all.back().header["final"].boolean());
  return all;
}

size_t Window::waiting() const {
  const std::lock_guard lock(wire_->mutex);
  return wire_->frames.size();
}

}  // namespace sg::test
