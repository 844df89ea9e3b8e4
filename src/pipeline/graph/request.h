// SPDX-License-Identifier: Apache-2.0
// Request: what the consumer needs of a result. It is rewritten on its way up the graph, so that a reader loads only that.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/vec.h"

namespace sg {

/// A result may hold more than requested, never less. The default requests everything.
struct Request {
  bool all_fields = true;
  std::vector<std::string> fields;  ///< without all_fields: the names needed, sorted, each once; none = the mesh alone
  std::optional<double> time;       ///< sources with a parameter `time` that the user left open follow it
  std::optional<Box3> region;       ///< only this part of space is needed
  int piece = 0, pieces = 1;        ///< part of the work when several processes share it
  int ghost_levels = 0;             ///< layers of cells around that part, marked as ghosts

  static Request only(const std::vector<std::string>& names);
  /// These fields of what `r` asks for.
  static Request only(const std::vector<std::string>& names, Request r);
  friend bool operator==(const Request&, const Request&) = default;
};

/// Adds a field name, keeping the order; no effect with all_fields.
void add_field(Request& request, const std::string& name);
/// True when one result can serve both: they differ only in fields.
bool can_merge(const Request& a, const Request& b);
/// The fields of both.
Request merged(Request a, const Request& b);
/// "fields=T,p time=2": the parts that differ from the default; "everything" when none does.
std::string request_text(const Request& request);

}  // namespace sg
