// SPDX-License-Identifier: Apache-2.0
#include "serve/guard/visitors.h"

#include "serve/guard/token.h"

namespace sg::serve {

namespace {
constexpr size_t most_secrets = 4096;
}

Visitors::Visitors(std::vector<User> users) : users_(std::move(users)), token_(users_.empty() ? new_token() : "") {}

std::optional<std::string> Visitors::enter(std::string_view token) {
  const std::lock_guard lock(mutex_);
  std::optional<Visitor> visitor;
  if (users_.empty()) {
    if (!used_ && same_secret(token, token_)) {
      used_ = true;
      visitor = Visitor{"", Rights::edit};
    }
  } else {
    const std::string hash = token_hash(token);
    for (const User& user : users_)
      if (same_secret(user.hash, hash)) visitor = Visitor{user.name, user.rights};
  }
  if (!visitor) return {};
  if (known_.size() == most_secrets) known_.pop_back();
  known_.push_front({new_token(), *visitor});
  return known_.front().secret;
}

std::optional<Visitor> Visitors::visitor(std::string_view secret) const {
  const std::lock_guard lock(mutex_);
  std::optional<Visitor> found;
  for (const Known& known : known_)
    if (same_secret(known.secret, secret)) found = known.visitor;
  return found;
}

}  // namespace sg::serve
