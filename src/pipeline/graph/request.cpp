// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/request.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"

namespace sg {

Request Request::only(std::vector<std::string> names) {
  Request r;
  r.all_fields = false;
  for (const std::string& n : names) add_field(r, n);
  return r;
}

void add_field(Request& request, const std::string& name) {
  if (request.all_fields) return;
  const auto at = std::lower_bound(request.fields.begin(), request.fields.end(), name);
  if (at == request.fields.end() || *at != name) request.fields.insert(at, name);
}

bool can_merge(const Request& a, const Request& b) {
  return a.time == b.time && a.region == b.region && a.piece == b.piece && a.pieces == b.pieces && a.ghost_levels == b.ghost_levels;
}

Request merged(Request a, const Request& b) {
  if (b.all_fields) a.all_fields = true, a.fields.clear();
  for (const std::string& n : b.fields) add_field(a, n);
  return a;
}

std::string request_text(const Request& r) {
  std::string text;
  auto add = [&](const std::string& part) { text += (text.empty() ? "" : " ") + part; };
  if (!r.all_fields) {
    std::string names;
    for (const std::string& n : r.fields) names += (names.empty() ? "" : ",") + n;
    add("fields=" + (names.empty() ? "none" : names));
  }
  if (r.time) add("time=" + exact_number(*r.time));
  if (r.region) {
    std::string box;
    for (const double v : {r.region->lo.x, r.region->lo.y, r.region->lo.z, r.region->hi.x, r.region->hi.y, r.region->hi.z})
      box += (box.empty() ? "" : ",") + exact_number(v);
    add("region=" + box);
  }
  if (r.pieces != 1 || r.piece != 0) add(fmt::format("piece={}/{}", r.piece, r.pieces) + (r.ghost_levels ? fmt::format("/{}", r.ghost_levels) : ""));
  return text.empty() ? "everything" : text;
}

}  // namespace sg
