// SPDX-License-Identifier: Apache-2.0
// Small operations on fields; the mesh is unchanged.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct SelectParams {
  std::vector<std::string> keep = {}, drop = {};
};
inline void describe(Schema& s, SelectParams& p) {
  s("keep", p.keep, "Names of the fields to keep; default: all.");
  s("drop", p.drop, "Names of the fields to leave out.");
}
/// Keeps only the named fields, wherever they lie (point, cell, whole). Throws Error(usage) for names that do not exist and when
/// neither list is given. No data is copied.
DatasetPtr select(const DatasetPtr& in, const SelectParams& p, Context& ctx);

struct MagnitudeParams {
  FieldName field = {};
  std::string name = "";
};
inline void describe(Schema& s, MagnitudeParams& p) {
  s("field", p.field, "Field of several components; default: the active vectors.").takes({.scalars = false});
  s("name", p.name, "Name of the result; default: the field's name followed by '_magnitude'.");
}
/// Length of each tuple (Euclidean) as an additional field: f64 for 64-bit fields, else f32; same unit; NaN stays.
DatasetPtr magnitude(const DatasetPtr& in, const MagnitudeParams& p, Context& ctx);

struct ScaleFieldParams {
  FieldName field = {};
  double factor = 1, offset = 0;
  std::string name = "";
  std::string unit = "";
};
inline void describe(Schema& s, ScaleFieldParams& p) {
  s("field", p.field, "Field to scale; default: the active scalar.");
  s("factor", p.factor, "Factor on each number.");
  s("offset", p.offset, "Offset added afterwards.");
  s("name", p.name, "Name of the result; default: the field's own, which it replaces.");
  s("unit", p.unit, "Unit of the result, e.g. degC after offset=-273.15; default: the field's own if factor is 1 and offset 0, else none.");
}
/// field * factor + offset, computed in double: f64 for 64-bit fields, else f32. The unit is dropped when the numbers change and no new
/// one is given, because a scaled number with the old unit would be wrong.
DatasetPtr scale_field(const DatasetPtr& in, const ScaleFieldParams& p, Context& ctx);

struct ComponentParams {
  FieldName field = {};
  int component = 0;
  std::string name = "";
};
inline void describe(Schema& s, ComponentParams& p) {
  s("field", p.field, "Field of several components; default: the active vectors.");
  s("component", p.component, "Component to take, counted from 0.").at_least(0);
  s("name", p.name, "Name of the result; default: the field's name followed by '_x', '_y', '_z' or the component's number.");
}
/// One component as an additional field; shares the bytes, same type and unit.
DatasetPtr component(const DatasetPtr& in, const ComponentParams& p, Context& ctx);

}  // namespace sg
