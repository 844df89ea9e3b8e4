// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/sources/field_source.h"

#include <fmt/core.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "filter/probe/probe.h"

namespace sg::fluid {

namespace {

constexpr const char* who = "smoke_from";

const Field& checked(const Field& f, const char* word) {
  if (f.components() != 1 || f.association == Association::whole)
    fail_usage(fmt::format("'{}' is no scalar field of points or cells", f.name), fmt::format("{} {}", who, word), "name one that is");
  return f;
}

}  // namespace

SourceFields source_fields(const Dataset& data, const SmokeFromParams& p) {
  const Field* const f = p.field.empty() ? data.fields().active(1) : &data.fields().require(p.field.name);
  if (!f) fail_usage("the mesh has no scalar field", who, "name one: field=NAME");
  const Field& density = checked(*f, "field");
  if (p.temperature_field.empty()) return {&density, &density};
  return {&density, &checked(data.fields().require(p.temperature_field.name), "temperature_field")};
}

SmokeInput field_source(const DatasetPtr& data, const SourceFields& fields, const MacGrid& g, Context& context) {
  // Under names of our own, which tell point and cell fields apart.
  DatasetParts parts = data->parts();
  const Field* const wanted[] = {fields.density, fields.temperature};
  parts.fields = {};
  for (const char* name : {"0", "1"}) {
    Field f = *wanted[name[0] - '0'];
    f.name = name;
    parts.fields.add(std::move(f));
  }
  UniformGrid middles;
  middles.dims = g.cells, middles.spacing = g.h * Vec3(1, 1, 1);
  middles.origin = g.origin + 0.5 * g.h * Vec3(1, 1, g.flat() ? 0 : 1);
  Context quiet(context, 0, 0);
  quiet.on_log = nullptr;  // that most of the air lies outside is no news
  const DatasetPtr at = probe(make_dataset(middles), make_dataset(std::move(parts)), {}, quiet);
  const Array& valid = at->fields().require("valid").array;
  SmokeInput input;
  size_t some = 0, negative = 0;
  for (std::vector<double>* to : {&input.density, &input.temperature}) {
    const Array& values = at->fields().require(to == &input.density ? "0" : "1").array;
    to->resize(values.count());
    for (size_t i = 0; i < values.count(); ++i) {
      double v = valid.get(i) != 0 ? values.get(i) : NAN;
      if (std::isinf(v)) fail_data(fmt::format("field '{}' is infinite", wanted[to != &input.density]->name), who, "replace that (calc)");
      if (to == &input.density && v < 0) v = 0, ++negative;
      some += !std::isnan(v);
      (*to)[i] = v;
    }
  }
  if (some == 0)
    fail_usage("no middle of a cell of the air lies in the data", who,
               "ask for bounds that hold them, or a larger size; solid cells are needed in a solid box");
  if (negative > 0)
    context.warn(fmt::format("smoke_from: '{}' is negative in {} cells, which counts as 0", fields.density->name, negative));
  return input;
}

}  // namespace sg::fluid
