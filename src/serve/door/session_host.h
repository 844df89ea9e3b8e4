// SPDX-License-Identifier: Apache-2.0
// What the door hands a client to once it has been let in.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "serve/guard/rights.h"
#include "serve/http/server.h"

namespace sg::serve {

/// A picture that has been saved, as the browser stores it.
struct Saved {
  std::string name;  ///< of the file that the browser makes: "head.png"
  std::string type;  ///< "image/png"
  std::shared_ptr<const std::string> bytes;
};

/// Both are called by one thread, one at a time (Handlers).
class SessionHost {
 public:
  virtual ~SessionHost() = default;
  /// The session of a file, a new one where nobody has opened it. `file`: absolute and confined below the served folder, a file, a folder
  /// of data or several files as a series; "": what the command line names. Nothing when there is no room for another session: the client
  /// gets 503. What it throws is answered 500 with its text.
  virtual std::optional<SocketHandler> join(const std::string& file, Rights rights, const std::string& user,
                                            std::shared_ptr<Socket> socket) = 0;
  /// What was saved under that id, which is as long as a token and as hard to guess.
  virtual std::optional<Saved> saved(const std::string& id) = 0;
};

}  // namespace sg::serve
