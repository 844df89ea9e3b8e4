// SPDX-License-Identifier: Apache-2.0
// Who has been let in: tokens in, secrets of cookies out.
#pragma once
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "serve/guard/users.h"

namespace sg::serve {

struct Visitor {
  std::string user;  ///< "" for the one whose token counts once
  Rights rights = Rights::edit;
};

class Visitors {
 public:
  /// Without users there is one token, which counts once.
  explicit Visitors(std::vector<User> users);

  /// The token that counts once; "" with users.
  const std::string& token() const { return token_; }
  /// A new secret for whoever has that token; nothing for a wrong one and for one that has counted. Of more than 4096 secrets the oldest
  /// are forgotten.
  std::optional<std::string> enter(std::string_view token);
  std::optional<Visitor> visitor(std::string_view secret) const;

 private:
  struct Known {
    std::string secret;
    Visitor visitor;
  };
  const std::vector<User> users_;
  const std::string token_;
  mutable std::mutex mutex_;
  bool used_ = false;
  std::list<Known> known_;  ///< the newest first
};

}  // namespace sg::serve
