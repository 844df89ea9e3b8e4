// SPDX-License-Identifier: Apache-2.0
// By which names a server may be asked, and which pages may open its sockets. A name that leads to this machine is not enough: the page of
// a stranger can have one (DNS rebinding).
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sg::serve {

/// Whether a server that listens there is reached from this machine alone: "127.0.0.1", "::1".
bool is_loopback(std::string_view address);

class HostCheck {
 public:
  /// `address`: where it listens. `public_origins`: "https://view.example.org", as a browser writes them. Throws Error(usage) for what is
  /// no origin.
  HostCheck(const std::string& address, uint16_t port, const std::vector<std::string>& public_origins);

  /// The origin that pages have which were asked for by that Host header; nothing when the name is not one of ours. Its letters may be
  /// large or small, and the port may be missing where it is the usual one.
  std::optional<std::string> origin_of(std::string_view host) const;
  /// Whether a request with that Origin comes from a page of ours that was asked for by `host`.
  bool is_ours(std::string_view host, std::string_view origin) const;
  /// Origins by which the server is asked, the first for the user: public ones, else the address.
  const std::vector<std::string>& origins() const { return origins_; }

 private:
  void add(const std::string& origin);
  std::vector<std::string> origins_;
  std::map<std::string, std::string, std::less<>> origin_of_;  ///< by Host
};

}  // namespace sg::serve
