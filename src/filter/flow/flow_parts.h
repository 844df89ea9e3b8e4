// SPDX-License-Identifier: Apache-2.0
// FlowParts: the flow through all parts of a collection as one. PartsCursor: a *flow* (flow_field.h) over them.
#pragma once
#include <vector>

#include "filter/flow/flow_field.h"

namespace sg {

/// Through which meshes of a collection a flow goes: those of the highest cell dimension among those that have the field (with an empty
/// name: the active vectors of the first that has any; `field` then becomes its name). At least one. Node sets, boundary patches and
/// parts without the field are passed over. Throws Error(usage) naming `who` when no part has it, and for tables.
std::vector<DatasetPtr> flow_meshes(const Data& data, std::string& field, std::string_view who);

/// The flow_meshes() of a collection.
class FlowParts {
 public:
  /// `field` as for FlowField, in every part by the name of the first that has it. Throws Error(usage) naming `who` when no part has it,
  /// Error(usage) for tables.
  FlowParts(const Data& data, const std::string& field, std::string_view who, Context& context);
  explicit FlowParts(FlowField field) { fields_.push_back(std::move(field)); }

  const std::vector<FlowField>& fields() const { return fields_; }
  size_t count() const { return fields_.size(); }
  int dimension() const { return fields_.front().dimension(); }
  double largest_speed() const;
  /// Root of the mean square over the points that have a velocity.
  double mean_speed() const;
  Box3 bounds() const;
  const std::string& name() const { return fields_.front().field().name; }

 private:
  std::vector<FlowField> fields_;
};

/// Asks the part of the last answer first, then the others in their order. One per thread.
class PartsCursor {
 public:
  explicit PartsCursor(const FlowParts& parts);

  bool operator()(Vec3 x, double, Vec3& v) { return (*this)(x, v); }
  bool operator()(Vec3 x, Vec3& v);
  bool gradient(Vec3 x, Vec3& v, Mat3& j);
  double cell_length() const { return cursors_[last_].cell_length(); }
  Vec3 snap(Vec3 x);
  /// Of the last answer that was true.
  size_t part() const { return last_; }
  FlowCursor& cursor() { return cursors_[last_]; }

 private:
  std::vector<FlowCursor> cursors_;
  size_t last_ = 0;
  bool flat_ = false;  // lines stay in the surface by themselves, or there is no surface
};

}  // namespace sg
