// SPDX-License-Identifier: Apache-2.0
// Bytes that stay the same as long as the program runs, as answers.
#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "serve/http/request.h"

namespace sg::serve {

class StaticBody {
 public:
  StaticBody(std::string bytes, std::string type);
  /// Compressed where the browser takes that, 304 where it has the same already. `cache`: the Cache-Control.
  HttpResponse answer(const HttpRequest& request, const char* cache) const;

 private:
  std::string type_, tag_;
  std::shared_ptr<const std::string> plain_, packed_;  ///< packed: null where it is no smaller
};

}  // namespace sg::serve
