// SPDX-License-Identifier: Apache-2.0
#include "serve/guard/host_check.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"

namespace sg::serve {

namespace {

constexpr std::string_view plain = "http://", secure = "https://";

std::string_view usual_port(std::string_view origin) { return origin.starts_with(secure) ? ":443" : ":80"; }

// Letters, digits, '-' and '.', or what an IPv6 address in brackets has; then perhaps a port.
bool is_host(std::string_view host) {
  size_t end = 0;
  if (host.starts_with('[')) {
    end = host.find(']');
    if (end == host.npos || end < 3 || host.substr(1, end - 1).find_first_not_of("0123456789abcdef:.") != host.npos) return false;
    ++end;
  } else {
    end = std::min(host.find(':'), host.size());
    const std::string_view name = host.substr(0, end);
    if (name.empty() || name[0] == '.' || name.back() == '.' ||
        name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-.") != name.npos)
      return false;
  }
  if (end == host.size()) return true;
  if (host[end] != ':') return false;
  const auto port = parse_int(host.substr(end + 1));
  return port && *port > 0 && *port < 65536 && host.substr(end + 1) == fmt::format("{}", *port);
}

}  // namespace

bool is_loopback(std::string_view address) { return address == "::1" || address.starts_with("127."); }

HostCheck::HostCheck(const std::string& address, uint16_t port, const std::vector<std::string>& public_origins) {
  for (const std::string& origin : public_origins) {
    const bool known = origin.starts_with(plain) || origin.starts_with(secure);
    if (!known || !is_host(std::string_view(origin).substr(origin.find("//") + 2)))
      fail_usage(fmt::format("'{}' is no origin", origin), "public origin",
                 "as a browser writes it, in small letters: https://view.example.org");
    add(origin);
  }
  // Where all addresses are listened to, any of them may be meant, and none is known to be ours.
  const bool every = address == "0.0.0.0" || address == "::";
  if (!every) add(fmt::format("{}{}:{}", plain, address.find(':') == address.npos ? address : "[" + address + "]", port));
  if (every || is_loopback(address))
    for (const char* name : {"127.0.0.1", "localhost", "[::1]"}) add(fmt::format("{}{}:{}", plain, name, port));
}

void HostCheck::add(const std::string& given) {
  std::string origin = given;
  if (origin.ends_with(usual_port(origin))) origin.resize(origin.rfind(':'));
  const std::string host = origin.substr(origin.find("//") + 2);
  if (!origin_of_.emplace(host, origin).second) return;
  origins_.push_back(origin);
  const bool has_port = host.back() != ']' && host.rfind(':') != host.npos;
  if (!has_port) origin_of_.emplace(host + std::string(usual_port(origin)), origin);
}

std::optional<std::string> HostCheck::origin_of(std::string_view host) const {
  const auto found = origin_of_.find(to_lower(host));
  if (found == origin_of_.end()) return {};
  return found->second;
}

bool HostCheck::is_ours(std::string_view host, std::string_view origin) const {
  const auto ours = origin_of(host);
  return ours && *ours == origin;
}

}  // namespace sg::serve
