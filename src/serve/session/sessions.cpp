// SPDX-License-Identifier: Apache-2.0
#include "serve/session/sessions.h"

#include <algorithm>

namespace sg::serve {

Sessions::Sessions(MakeSession make, size_t most, std::chrono::minutes idle) : make_(std::move(make)), most_(most), idle_(idle) {}

void Sessions::drop_idle() {
  const auto now = std::chrono::steady_clock::now();
  for (auto& [file, held] : sessions_)
    if (held.session->clients() > 0) held.used = now;
  std::erase_if(sessions_, [&](const auto& s) { return now - s.second.used > idle_; });
  if (sessions_.size() < most_) return;
  // Room for one more: the one that was left longest ago.
  auto oldest = sessions_.end();
  for (auto it = sessions_.begin(); it != sessions_.end(); ++it)
    if (it->second.session->clients() == 0 && (oldest == sessions_.end() || it->second.used < oldest->second.used)) oldest = it;
  if (oldest != sessions_.end()) sessions_.erase(oldest);
}

Sessions::Held* Sessions::held(const std::string& file) {
  auto found = sessions_.find(file);
  if (found == sessions_.end()) {
    drop_idle();
    if (sessions_.size() >= most_) return nullptr;
    found = sessions_.emplace(file, Held{make_(file), {}}).first;
  }
  found->second.used = std::chrono::steady_clock::now();
  return &found->second;
}

void Sessions::begin(const std::string& file) {
  const std::lock_guard lock(mutex_);
  held(file);
}

std::optional<SocketHandler> Sessions::join(const std::string& file, Rights rights, const std::string& user,
                                            std::shared_ptr<Socket> socket) {
  const std::lock_guard lock(mutex_);
  Held* const h = held(file);
  if (!h) return std::nullopt;
  return h->session->join(rights, user, std::move(socket));
}

std::optional<Saved> Sessions::saved(const std::string& id) {
  const std::lock_guard lock(mutex_);
  for (const auto& [file, held] : sessions_)
    if (auto saved = held.session->saved(id)) return saved;
  return std::nullopt;
}

}  // namespace sg::serve
