// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/file/file.h"
#include "data/dataset.h"
#include "pipeline/graph/graph.h"
#include "pipeline/graph/series_input.h"
#include "pipeline/graph/some_file.h"
#include "pipeline/operation/operation_table.h"
#include "pipeline/operation/test_operations.h"
#include "support/test.h"

using namespace sg;
using test::some_file;

namespace {

struct SumParams {
  std::string times;
  std::optional<double> time;
};
void describe(Schema& s, SumParams& p) {
  s("times", p.times, "Times of the series.");
  s("time", p.time, "Moment shown; default: the last.");
}

/// What the operation saw: times, first values, and how many steps lived at once.
struct Seen {
  std::vector<double> times, values;
  std::optional<double> time;
  size_t most_alive = 0, others = 0;
} seen;

DatasetPtr sum(const Series& series, const std::vector<Data>& others, const SumParams& p, Context&) {
  seen = {};
  seen.times = series.times, seen.time = p.time, seen.others = others.size();
  std::vector<std::weak_ptr<const Dataset>> all;
  Data before;
  for (size_t i = 0; i < series.times.size(); ++i) {
    Data step = series.load(i);
    seen.values.push_back(test::first(step));
    all.push_back(std::get<DatasetPtr>(step));
    size_t alive = 0;
    for (const auto& w : all) alive += !w.expired();
    seen.most_alive = std::max(seen.most_alive, alive);
    if (all.size() > 4) all.erase(all.begin());
    before = std::move(step);
  }
  return test::line_of(2);
}

DatasetPtr alone(const Series& series, const SumParams& p, Context& context) { return sum(series, {}, p, context); }

std::span<const Operation> table() {
  static const std::vector<Operation> all = [] {
    std::vector<Operation> ops(test::counted_operations().begin(), test::counted_operations().end());
    ops.push_back(SG_FILTER(sum, SumParams, sum, "flow", "Looks at every step.", takes_further(kinds::meshes | kinds::table)));
    ops.push_back(SG_FILTER(alone, SumParams, alone, "flow", "Looks at every step."));
    return ops;
  }();
  return all;
}

/// A reader of files with the times 0, 10, 20, whose T starts at the time asked for (-1: none).
GraphOptions series_options(uint64_t cache = 1 << 24) {
  test::reset_runs();
  GraphOptions o;
  o.operations = table();
  o.cache_limit = cache;
  o.times = [](const std::string& path, const ReadOptions&, Context&) {
    return path.find("still") != path.npos   ? std::vector<double>()
           : path.find("other") != path.npos ? std::vector<double>{0, 10}
                                             : std::vector<double>{0, 10, 20};
  };
  o.read = [](const std::string&, const ReadOptions& r, const Request&, Context&) -> Data {
    std::vector<double> v(8, r.step >= 0 ? 100.0 + double(r.step) : r.time.value_or(-1));
    FieldSet fields;
    fields.add({"T", Association::point, Array::from_vector(std::move(v)), "", Role::none});
    return make_dataset(test::line_of(8)->mesh(), fields);
  };
  return o;
}

}  // namespace

TEST_CASE("series: an operation sees all times of a file, through the filters between") {
  Graph g(series_options());
  Context context;
  const NodeId read = g.add_read(some_file("moving.raw")), scaled = g.add_operation("scale", {"by=3"}, {read});
  g.evaluate(g.add_operation("alone", {}, {scaled}), {}, context);
  CHECK(seen.times == std::vector<double>{0, 10, 20});
  CHECK(seen.values == std::vector<double>{0, 30, 60});
  CHECK(!seen.time);
}

TEST_CASE("series: a source of any time takes the times of the parameter") {
  Graph g(series_options());
  Context context;
  const NodeId moment = g.add_operation("moment"), scaled = g.add_operation("scale", {"by=2"}, {moment});
  g.evaluate(g.add_operation("alone", {"times=1:3:5"}, {scaled}), {}, context);
  CHECK(seen.values == std::vector<double>{2, 3, 4, 5, 6});
  g.evaluate(g.add_operation("alone", {"times=4,8"}, {scaled}), {}, context);
  CHECK(seen.values == std::vector<double>{8, 16});
  const NodeId open = g.add_operation("alone", {}, {scaled});
  CHECK(test::error_of([&] { g.evaluate(open, {}, context); }).find("times=FIRST:LAST:COUNT") != std::string::npos);
  const NodeId bad = g.add_operation("alone", {"times=1:x:5"}, {scaled});
  CHECK(test::error_of([&] { g.evaluate(bad, {}, context); }).find("not a list of times") != std::string::npos);
}

TEST_CASE("series: a time asked for goes to the operation, not to what lies above") {
  Graph g(series_options());
  Context context;
  const NodeId node = g.add_operation("alone", {}, {g.add_read(some_file("moving.raw"))});
  Request r;
  r.time = 10;
  g.evaluate(node, r, context);
  CHECK(seen.time == 10);
  CHECK(seen.times.size() == 3);
  r.time = 20;
  CHECK(g.key(node, r) != g.key(node));
}

TEST_CASE("series: times that the file does not have are refused") {
  Graph g(series_options());
  Context context;
  const NodeId read = g.add_read(some_file("moving.raw"));
  g.evaluate(g.add_operation("alone", {"times=10,20"}, {read}), {}, context);
  CHECK(seen.values == std::vector<double>{10, 20});
  const NodeId bad = g.add_operation("alone", {"times=10,15"}, {read});
  CHECK(test::error_of([&] { g.evaluate(bad, {}, context); }).find("no step at the time 15") != std::string::npos);
}

TEST_CASE("series: files with and without time stand together; different times do not") {
  Graph g(series_options());
  Context context;
  const NodeId moving = g.add_read(some_file("moving.raw")), still = g.add_read(some_file("still.raw")),
               other = g.add_read(some_file("other.raw"));
  g.evaluate(g.add_operation("alone", {}, {g.add_operation("add", {}, {moving, still})}), {}, context);
  CHECK(seen.values == std::vector<double>{-1, 9, 19});
  const NodeId bad = g.add_operation("alone", {}, {g.add_operation("add", {}, {moving, other})});
  CHECK(test::error_of([&] { g.evaluate(bad, {}, context); }).find("files of one series must have the same times") != std::string::npos);
}

TEST_CASE("series: a file whose step the user chose, and given data, are one step") {
  Graph g(series_options());
  Context context;
  ReadOptions third;
  third.step = 2;
  g.evaluate(g.add_operation("alone", {}, {g.add_read(some_file("moving.raw"), third)}), {}, context);
  CHECK(seen.values == std::vector<double>{102});
  g.evaluate(g.add_operation("alone", {}, {g.add_data(test::line_of(4))}), {}, context);
  CHECK(seen.times == std::vector<double>{0});
  const Operation& op = find_operation("sum", table());
  run_operation(op, {test::line_of(4), test::line_of(2)}, {}, context);
  CHECK(seen.others == 1);
}

TEST_CASE("series: what hangs on no time is made once, the rest passes by the cache") {
  Graph g(series_options());
  Context context;
  const NodeId fixed = g.add_operation("scale", {"by=3"}, {g.add_operation("ramp", {"n=4"})});
  const NodeId both = g.add_operation("add", {}, {g.add_operation("moment"), fixed});
  const NodeId node = g.add_operation("alone", {"times=0:9:10"}, {both});
  g.evaluate(node, {}, context);
  CHECK(test::runs("ramp") == 1);
  CHECK(test::runs("scale") == 1);
  CHECK(test::runs("moment") == 10);
  CHECK(test::runs("add") == 10);
  g.evaluate(node, {}, context);
  CHECK(test::runs("add") == 10);  // the result itself is kept
  CHECK(g.cache().size() <= 3);
}

TEST_CASE("series: of 1,000 steps two are alive at once") {
  Graph g(series_options(1 << 30));
  Context context;
  const NodeId scaled = g.add_operation("scale", {}, {g.add_operation("moment")});
  g.evaluate(g.add_operation("alone", {"times=0:999:1000"}, {scaled}), {}, context);
  CHECK(seen.times.size() == 1000);
  CHECK(seen.values.back() == 1998);
  CHECK(seen.most_alive == 2);
}

TEST_CASE("series: further inputs are plain, and a result above may serve both") {
  Graph g(series_options());
  Context context;
  const NodeId read = g.add_read(some_file("moving.raw"));
  const NodeId node = g.add_operation("sum", {}, {read, g.add_operation("measure", {}, {read})});
  const NodeId next = g.add_operation("scale", {}, {node});
  g.evaluate(next, {}, context);
  CHECK(seen.others == 1);
  CHECK(seen.values == std::vector<double>{0, 10, 20});
}

TEST_CASE("series: the plan says what runs for each time, and keys hold parameters and input") {
  Graph g(series_options());
  const NodeId moment = g.add_operation("moment"), scaled = g.add_operation("scale", {}, {moment});
  const NodeId a = g.add_operation("alone", {"times=0:9:10"}, {scaled}), b = g.add_operation("alone", {"times=0:9:11"}, {scaled}),
               c = g.add_operation("alone", {"times=0:9:10"}, {moment});
  CHECK(g.key(a) != g.key(b));
  CHECK(g.key(a) != g.key(c));
  const Target t{a, {}};
  const auto plan = g.plan({&t, 1});
  REQUIRE(plan.size() == 3);
  CHECK(plan[0].state == PlannedStep::State::each_time);
  CHECK(plan[1].state == PlannedStep::State::each_time);
  CHECK(plan[2].state == PlannedStep::State::run);
  CHECK(g.explain(a).find("each time") != std::string::npos);
  CHECK(test::all_runs() == 0);
}

TEST_CASE("times: lists, so many of them, and steps") {
  CHECK(parse_times("0,1,2.5", "x") == std::vector<double>{0, 1, 2.5});
  CHECK(parse_times("0:10:6", "x") == std::vector<double>{0, 2, 4, 6, 8, 10});
  const std::vector<double> steps = parse_times("0:5:0.04", "x");
  REQUIRE(steps.size() == 126);
  CHECK(steps[1] == 0.04);
  CHECK(steps.back() == doctest::Approx(5));
  CHECK(parse_times("1:2:0.7", "x") == std::vector<double>{1, 1.7});
  for (const char* wrong : {"0:5:0", "0:5:-0.5", "5:0:0.5", "0:1e300:0.5", "0:5:nan", "0:5:inf", "a:5:0.5", "0:inf:0.5"})
    CHECK_THROWS_AS(parse_times(wrong, "x"), Error);
}
