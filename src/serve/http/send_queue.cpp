// SPDX-License-Identifier: Apache-2.0
#include "serve/http/send_queue.h"

#include <algorithm>

namespace sg::serve {

namespace {
// An empty message takes memory, too.
size_t cost_of(const SendQueue::Message& message) { return message.bytes->size() + 64; }
}  // namespace

bool SendQueue::send_text(std::string text) { return send({true, std::make_shared<const std::string>(std::move(text))}); }

bool SendQueue::send_binary(std::shared_ptr<const std::string> bytes) { return send({false, std::move(bytes)}); }

bool SendQueue::send(Message message) {
  bool sent = true;
  {
    const std::lock_guard lock(mutex_);
    if (!open_ || !message.bytes) return false;
    if (cost_of(message) > most_ - std::min(most_, waiting_)) {
      overrun_ = true;
      open_ = sent = false;
    } else {
      waiting_ += cost_of(message);
      queue_.push_back(std::move(message));
    }
  }
  wake();
  return sent;
}

size_t SendQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_;
}

bool SendQueue::open() const {
  const std::lock_guard lock(mutex_);
  return open_;
}

void SendQueue::close(std::string reason) {
  {
    const std::lock_guard lock(mutex_);
    if (!open_) return;
    open_ = false;
    goodbye_ = std::move(reason);
  }
  wake();
}

void SendQueue::on_change(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
}

void SendQueue::wake() {
  std::function<void()> wake;
  {
    const std::lock_guard lock(mutex_);
    wake = wake_;
  }
  if (wake) wake();
}

std::optional<SendQueue::Message> SendQueue::front() const {
  const std::lock_guard lock(mutex_);
  if (queue_.empty()) return {};
  return queue_.front();
}

void SendQueue::pop() {
  const std::lock_guard lock(mutex_);
  if (queue_.empty()) return;
  waiting_ -= cost_of(queue_.front());
  queue_.pop_front();
}

std::optional<std::string> SendQueue::goodbye() const {
  const std::lock_guard lock(mutex_);
  return queue_.empty() ? goodbye_ : std::nullopt;
}

bool SendQueue::overrun() const {
  const std::lock_guard lock(mutex_);
  return overrun_;
}

void SendQueue::end() {
  const std::lock_guard lock(mutex_);
  open_ = false;
  queue_.clear();
  waiting_ = 0;
  wake_ = {};
}

}  // namespace sg::serve
