// SPDX-License-Identifier: Apache-2.0
#include "scene/show/other_names.h"

#include <map>

#include "base/text/text.h"
#include "pipeline/operation/operation.h"
#include "scene/show/show.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("other names: each leads to something that exists, and none leads to two") {
  std::map<std::string, std::string> seen;
  for (const OtherName& n : other_names()) {
    INFO(n.here);
    const auto parts = words(n.here);
    const std::string flag(parts[0]);
    std::string what(parts.size() > 1 ? parts[1] : "");
    std::erase(what, '\'');
    std::vector<std::string> params;
    for (size_t i = 2; i < parts.size(); ++i) {
      std::string p(parts[i]);
      std::erase(p, '\'');
      if (!p.ends_with("...")) params.push_back(p);
    }
    if (flag == "-f") CHECK_NOTHROW(make_params(find_operation(what), params));
    else if (flag == "--show") CHECK_NOTHROW(find_show(what));
    else CHECK((flag == "--map" || flag == "--legend" || flag == "--picture" || flag == "--camera" || flag == "--note"));
    for (const std::string_view word : words(n.words)) {
      const auto [it, fresh] = seen.emplace(std::string(word), std::string(n.here));
      INFO(word);
      CHECK(fresh);
      CHECK(word == to_lower(word));
    }
  }
}
