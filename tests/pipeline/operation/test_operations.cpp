// SPDX-License-Identifier: Apache-2.0
#include "pipeline/operation/test_operations.h"

#include "base/error.h"
#include "pipeline/operation/operation_table.h"

namespace sg::test {

namespace {
std::mutex mutex;
std::map<std::string, int> counts;

void ran(const std::string& name, Context& context) {
  {
    std::lock_guard lock(mutex);
    ++counts[name];
  }
  if (on_run) on_run(name, context);
}

DatasetPtr with_field(const DatasetPtr& d, const std::string& name, const std::function<double(double)>& f) {
  const Field& in = d->fields().require(name);
  std::vector<double> v(in.array.count());
  for (size_t i = 0; i < v.size(); ++i) v[i] = f(in.array.get(i));
  DatasetParts parts = d->parts();
  parts.fields.add({name, in.association, Array::from_vector(std::move(v)), "", Role::none});
  return make_dataset(std::move(parts));
}

struct RampParams {
  int64_t n = 8;
  double start = 0;
};
void describe(Schema& s, RampParams& p) {
  s("n", p.n, "Number of points.").positive();
  s("start", p.start, "First value.").unit("m");
}
DatasetPtr ramp(const RampParams& p, Context& context) {
  ran("ramp", context);
  return with_field(line_of(size_t(p.n)), "T", [&](double v) { return v + p.start; });
}

struct MomentParams {
  std::optional<double> time;
};
void describe(Schema& s, MomentParams& p) { s("time", p.time, "Moment; default: the one asked for."); }
DatasetPtr moment(const MomentParams& p, Context& context) {
  ran("moment", context);
  return with_field(line_of(4), "T", [&](double v) { return v + p.time.value_or(-1); });
}

struct ScaleParams {
  FieldName field;
  double by = 2;
  std::string mode = "plain";
};
void describe(Schema& s, ScaleParams& p) {
  s("field", p.field, "Field to scale; default: the active scalar.");
  s("by", p.by, "Factor.").range(-1000, 1000).unit("@field");
  s("mode", p.mode, "How.").choices({"plain", "fancy"});
}
DatasetPtr scale(const DatasetPtr& d, const ScaleParams& p, Context& context) {
  ran("scale", context);
  const std::string name = p.field.empty() ? d->fields().active()->name : p.field.name;
  return with_field(d, name, [&](double v) { return v * p.by; });
}

struct NoParams {};
void describe(Schema&, NoParams&) {}

DatasetPtr add(const DatasetPtr& a, const DatasetPtr& b, const NoParams&, Context& context) {
  ran("add", context);
  return with_field(a, "T", [&, i = size_t(0)](double v) mutable { return v + b->fields().require("T").array.get(i++); });
}

Data join(const std::vector<Data>& in, const NoParams&, Context& context) {
  ran("join", context);
  auto c = std::make_shared<Collection>();
  for (size_t i = 0; i < in.size(); ++i) c->parts.push_back({"part" + std::to_string(i), in[i]});
  return CollectionPtr(c);
}

Data whole(const Data& in, const NoParams&, Context& context) {
  ran("whole", context);
  return in;
}

DatasetPtr fail(const DatasetPtr&, const NoParams&, Context& context) {
  ran("fail", context);
  fail_data("cannot do that", "fail");
}

TablePtr measure(const DatasetPtr& d, const NoParams&, Context& context) {
  ran("measure", context);
  auto t = std::make_shared<Table>();
  t->columns.push_back({"n", Association::whole, Array::from_vector<double>({double(d->point_count())}), "", Role::none});
  return t;
}

DatasetPtr drop(const DatasetPtr& d, const NoParams&, Context& context) {
  ran("drop", context);
  return d->point_count() > 4 ? d : nullptr;
}
}  // namespace

std::function<void(const std::string&, Context&)> on_run;

int runs(const std::string& name) {
  std::lock_guard lock(mutex);
  return counts[name];
}
int all_runs() {
  std::lock_guard lock(mutex);
  int n = 0;
  for (const auto& [name, count] : counts) n += count;
  return n;
}
void reset_runs() {
  std::lock_guard lock(mutex);
  counts.clear();
  on_run = nullptr;
}

std::span<const Operation> counted_operations() {
  static constexpr Operation table[] = {
      SG_SOURCE(ramp, RampParams, ramp, "A line of points with a rising field."),
      SG_SOURCE(moment, MomentParams, moment, "A line at a moment."),
      SG_FILTER(scale, ScaleParams, scale, "scalar", "Multiplies a field.", op_version<3>),
      SG_FILTER(pick, ScaleParams, scale, "scalar", "Scales and needs nothing else.", needs_only_named_fields),
      SG_FILTER(add, NoParams, add, "scalar", "Adds the fields of two lines.", finds_fields("T")),
      SG_FILTER(join, NoParams, join, "parts", "Makes one collection.", op_inputs<1, -1>),
      SG_FILTER(whole, NoParams, whole, "parts", "Passes everything on."),
      SG_FILTER(drop, NoParams, drop, "parts", "Drops short lines."),
      SG_FILTER(fail, NoParams, fail, "parts", "Fails."),
      SG_FILTER(measure, NoParams, measure, "stats", "Counts points."),
  };
  return table;
}

DatasetPtr line_of(size_t n, const std::vector<std::string>& fields) {
  UniformGrid g;
  g.dims = {n, 1, 1};
  FieldSet set;
  for (const std::string& name : fields) {
    std::vector<double> v(n);
    for (size_t i = 0; i < n; ++i) v[i] = double(i);
    set.add({name, Association::point, Array::from_vector(std::move(v)), "", Role::none});
  }
  return make_dataset(g, set);
}

double value_at(const Data& data, size_t i, const std::string& field) {
  return single_dataset(data, "test")->fields().require(field).array.get(i);
}
double first(const Data& data, const std::string& field) { return value_at(data, 0, field); }

}  // namespace sg::test
