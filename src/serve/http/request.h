// SPDX-License-Identifier: Apache-2.0
// One request and its answer, as values: what stands between the connections and those who answer.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sg::serve {

using Query = std::vector<std::pair<std::string, std::string>>;

/// What a request asks for; the headers that are looked at, "" where they are missing.
struct HttpRequest {
  std::string method;  ///< "GET", "HEAD"
  std::string path;    ///< decoded once: "/files.json"
  Query query;         ///< decoded once, in the order of the request
  std::string host, origin, cookie;
  std::string fetch_site;       ///< Sec-Fetch-Site: what a browser says of who asks
  std::string accept_encoding;  ///< as sent
  std::string if_none_match;    ///< as sent

  /// The value of the first word of that name in the query; null when there is none.
  const std::string* word(std::string_view name) const {
    for (const auto& [key, value] : query)
      if (key == name) return &value;
    return nullptr;
  }
};

struct HttpResponse {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::vector<std::pair<std::string, std::string>> headers;  ///< each name once; in place of the server's own
  std::string body;
  /// In place of `body` where it is not null: bytes that several answers share.
  std::shared_ptr<const std::string> shared_body;
  std::string_view bytes() const { return shared_body ? std::string_view(*shared_body) : std::string_view(body); }
};

}  // namespace sg::serve
