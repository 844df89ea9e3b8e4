// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/graph.h"
#include "pipeline/file/read_part.h"
#include "pipeline/graph/some_file.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "base/file/file.h"
#include "pipeline/operation/test_operations.h"
#include "support/test.h"

using namespace sg;
using test::first;
using test::runs;
using test::some_file;
using test::value_at;

namespace {

struct Reads {
  std::mutex mutex;
  std::vector<std::pair<ReadOptions, Request>> seen;
  std::weak_ptr<const Dataset> last;
};

/// Test operations, and a reader that makes a line with the fields T, p, q without looking into the file.
GraphOptions line_options(uint64_t cache_limit = 1 << 20, Reads* reads = nullptr) {
  test::reset_runs();
  GraphOptions o;
  o.operations = test::counted_operations();
  o.cache_limit = cache_limit;
  o.read = [reads](const std::string&, const ReadOptions& r, const Request& request, Context&) -> Data {
    const DatasetPtr d = test::line_of(8, r.fields.empty() ? std::vector<std::string>{"T", "p", "q"} : r.fields);
    if (reads) {
      std::lock_guard lock(reads->mutex);
      reads->seen.emplace_back(r, request);
      reads->last = d;
    }
    return d;
  };
  return o;
}

}  // namespace

TEST_CASE("graph: a chain gives the numbers of its operations") {
  Graph g(line_options());
  Context context;
  const NodeId n = g.add_operation("scale", {"by=3"}, {g.add_operation("ramp", {"start=1"})});
  const Data d = g.evaluate(n, {}, context);
  CHECK(first(d) == 3);
  CHECK(value_at(d, 7) == 24);
}

TEST_CASE("graph: what the cache holds is not run again") {
  Graph g(line_options());
  Context context;
  const NodeId ramp = g.add_operation("ramp"), a = g.add_operation("scale", {"by=3"}, {ramp}), b = g.add_operation("scale", {"by=4"}, {a});
  g.evaluate(b, {}, context);
  CHECK(runs("scale") == 2);
  g.evaluate(b, {}, context);
  g.evaluate(a, {}, context);
  CHECK(test::all_runs() == 3);
  g.evaluate(g.add_operation("scale", {"by=5"}, {a}), {}, context);  // a change at the end leaves the rest
  CHECK(runs("ramp") == 1);
  CHECK(runs("scale") == 3);
}

TEST_CASE("graph: two nodes with equal keys are one, and a diamond's top runs once, without any cache") {
  Graph g(line_options(0));
  Context context;
  const NodeId r1 = g.add_operation("ramp", {"n=4"}), r2 = g.add_operation("ramp", {"n=4"}, {}, "again");
  const NodeId left = g.add_operation("scale", {"by=2"}, {r1}), right = g.add_operation("scale", {"by=5"}, {r2});
  const NodeId twin = g.add_operation("scale", {"by=2.0"}, {r2});
  const NodeId sum = g.add_operation("add", {}, {left, right}), same = g.add_operation("add", {}, {left, twin}),
               top = g.add_operation("add", {}, {sum, same});
  CHECK(value_at(g.evaluate(top, {}, context), 1) == 2 + 5 + 2 + 2);
  CHECK(runs("ramp") == 1);
  CHECK(runs("scale") == 2);
  CHECK(runs("add") == 3);
}

TEST_CASE("graph: several sinks share one evaluation") {
  Graph g(line_options(0));
  Context context;
  const NodeId ramp = g.add_operation("ramp"), a = g.add_operation("scale", {"by=2"}, {ramp}),
               b = g.add_operation("scale", {"by=3"}, {ramp});
  const std::vector<Target> targets{{a, {}}, {b, {}}, {ramp, {}}, {a, {}}};
  const std::vector<Data> out = g.evaluate(targets, context);
  REQUIRE(out.size() == 4);
  CHECK(value_at(out[0], 1) == 2);
  CHECK(value_at(out[1], 1) == 3);
  CHECK(value_at(out[2], 1) == 1);
  CHECK(std::get<DatasetPtr>(out[3]) == std::get<DatasetPtr>(out[0]));
  CHECK(test::all_runs() == 3);
  CHECK(g.evaluate(std::span<const Target>(), context).empty());
}

TEST_CASE("graph: with limit 0 intermediates die with their last consumer") {
  Reads reads;
  Graph g(line_options(0, &reads));
  Context context;
  const NodeId read = g.add_read(some_file());
  const NodeId a = g.add_operation("scale", {"by=2"}, {read}), b = g.add_operation("scale", {"by=3"}, {a}),
               c = g.add_operation("scale", {"by=4"}, {b});
  std::vector<bool> alive;
  test::on_run = [&](const std::string&, Context&) { alive.push_back(!reads.last.expired()); };
  const Data d = g.evaluate(c, {}, context);
  CHECK(alive == std::vector<bool>{true, false, false});
  CHECK(reads.last.expired());
  CHECK(g.cache().size() == 0);

  // Two consumers: it lives until the second has run.
  alive.clear();
  const NodeId x = g.add_operation("scale", {"by=7"}, {read}), y = g.add_operation("scale", {"by=8"}, {read});
  g.evaluate(g.add_operation("scale", {"by=10"}, {g.add_operation("add", {}, {x, y})}), {}, context);
  CHECK(alive == std::vector<bool>{true, true, false, false});
  test::on_run = nullptr;
}

TEST_CASE("graph: the cache keeps intermediates up to its limit") {
  Reads reads;
  Graph g(line_options(1 << 20, &reads));
  Context context;
  const NodeId n = g.add_operation("scale", {"field=T"}, {g.add_read(some_file())});
  g.evaluate(n, Request::only({"T"}), context);
  CHECK_FALSE(reads.last.expired());
  CHECK(g.cache().bytes() == 2 * 64);
  g.cache().set_limit(64);
  CHECK(reads.last.expired());
}

TEST_CASE("graph: the request reaches the reader with only the fields that are needed") {
  Reads reads;
  Graph g(line_options(0, &reads));
  Context context;
  const NodeId read = g.add_read(some_file());
  const NodeId scaled = g.add_operation("scale", {"field=T"}, {read});
  auto asked = [&](NodeId node, Request request) {
    reads.seen.clear();
    g.evaluate(node, request, context);
    REQUIRE(reads.seen.size() == 1);
    return reads.seen[0].first;
  };
  CHECK(asked(scaled, {}).fields.empty());
  CHECK(asked(scaled, Request::only({"p"})).fields == std::vector<std::string>{"T", "p"});
  CHECK(asked(g.add_operation("pick", {"field=T"}, {read}), {}).fields == std::vector<std::string>{"T"});
  CHECK(asked(g.add_operation("whole", {}, {scaled}), Request::only({"p"})).fields == std::vector<std::string>{"T", "p"});
  CHECK(asked(g.add_operation("scale", {}, {read}), Request::only({"p"})).fields.empty());  // chooses the field itself
  CHECK(asked(read, Request::only({"q", "T"})).fields == std::vector<std::string>{"T", "q"});
  CHECK(asked(read, Request::only({})).header_only);
  CHECK_FALSE(asked(read, {}).header_only);

  ReadOptions chosen;
  chosen.fields = {"T", "q"};
  const NodeId some = g.add_read(some_file(), chosen);
  CHECK(asked(some, {}).fields == std::vector<std::string>{"T", "q"});
  CHECK(asked(some, Request::only({"p", "q"})).fields == std::vector<std::string>{"q"});
  CHECK(asked(some, Request::only({"p"})).fields == std::vector<std::string>{"T", "q"});
}

TEST_CASE("graph: a field that the user chose must be in the file, one that a filter makes need not") {
  GraphOptions o = line_options(0);
  o.read = [](const std::string&, const ReadOptions& r, const Request&, Context&) -> Data {
    std::vector<std::string> have;
    for (const char* name : {"T", "p"})
      if (r.fields.empty() || std::find(r.fields.begin(), r.fields.end(), name) != r.fields.end()) have.push_back(name);
    return test::line_of(4, have);
  };
  Graph g(o);
  Context context;
  ReadOptions chosen;
  chosen.fields = {"T", "presure"};
  const NodeId bad = g.add_read(some_file(), chosen), good = g.add_read(some_file());
  CHECK(test::error_of([&] {
          g.evaluate(bad, {}, context);
        }).find("graph.raw: there is no field 'presure' in the file (while reading (step 1))") != std::string::npos);
  CHECK(first(g.evaluate(bad, Request::only({"T"}), context)) == 0);  // not needed, so not looked for
  CHECK(first(g.evaluate(g.add_operation("scale", {"field=T"}, {good}), Request::only({"T_gradient"}), context)) == 0);
  o.field_names = [](const std::string&, const ReadOptions&) { return std::optional(std::vector<std::string>{"T", "pressure"}); };
  Graph named(o);
  const NodeId again = named.add_read(some_file(), chosen);
  CHECK(test::error_of([&] { named.evaluate(again, {}, context); }).find("did you mean 'pressure'?") != std::string::npos);
}

TEST_CASE("graph: branches that need different fields share one read with the fields of both") {
  Reads reads;
  Graph g(line_options(0, &reads));
  Context context;
  const NodeId read = g.add_read(some_file());
  const std::vector<Target> targets{{g.add_operation("pick", {"field=T"}, {read}), {}}, {g.add_operation("pick", {"field=q"}, {read}), {}}};
  g.evaluate(targets, context);
  REQUIRE(reads.seen.size() == 1);
  CHECK(reads.seen[0].first.fields == std::vector<std::string>{"T", "q"});
}

TEST_CASE("graph: time, region and piece reach a reader that knows them, and separate its results") {
  Reads reads;
  Graph g(line_options(1 << 20, &reads));
  Context context;
  const NodeId read = g.add_read(some_file()), scaled = g.add_operation("scale", {}, {read});
  Request r;
  r.time = 2, r.region = Box3{{0, 0, 0}, {1, 1, 1}}, r.piece = 1, r.pieces = 2;
  g.evaluate(read, r, context);
  CHECK(*reads.seen.at(0).second.time == 2);
  CHECK(reads.seen.at(0).second.region->hi.x == 1);
  CHECK(reads.seen.at(0).second.piece == 1);
  Request later = r;
  later.time = 3;
  const std::vector<Target> both{{read, r}, {read, later}};
  g.evaluate(both, context);
  CHECK(reads.seen.size() == 2);
  CHECK(g.key(scaled, r) != g.key(scaled, later));
  Request anywhere = r;
  anywhere.region.reset();
  CHECK(g.key(scaled, r) == g.key(scaled, anywhere));  // a filter that says nothing needs all of its input
  Request whole = anywhere;
  whole.piece = 0, whole.pieces = 1;
  CHECK(g.key(scaled, r) != g.key(scaled, whole));  // of whose result a piece is cut
}

TEST_CASE("graph: a source follows the time asked for unless its own is stated") {
  Graph g(line_options());
  Context context;
  Request r;
  r.time = 2.5;
  const NodeId open = g.add_operation("moment"), fixed = g.add_operation("moment", {"time=7"});
  CHECK(first(g.evaluate(g.add_operation("scale", {"by=2"}, {open}), r, context)) == 5);
  CHECK(first(g.evaluate(open, {}, context)) == -1);
  CHECK(first(g.evaluate(fixed, r, context)) == 7);
  CHECK(g.key(open, r) != g.key(open));
  CHECK(g.key(fixed, r) == g.key(fixed));
  Request seven;
  seven.time = 7;
  CHECK(g.key(open, seven) == g.key(fixed));
}

TEST_CASE("graph: all mistakes are told together before anything runs") {
  GraphOptions o = line_options();
  o.field_names = [](const std::string&, const ReadOptions&) { return std::optional(std::vector<std::string>{"T", "p"}); };
  Graph g(o);
  Context context;
  const NodeId ramp = g.add_operation("ramp", {"n=0", "strat=1"}), given = g.add_data(test::line_of(4, {"temperature"}), "", "input");
  const NodeId a = g.add_operation("sclae", {}, {ramp}), b = g.add_operation("scale", {"mode=fnacy", "by=1e9"}, {a}, "big");
  const NodeId c = g.add_operation("scale", {"field=temprature"}, {given}),
               d = g.add_operation("scale", {"field=P"}, {g.add_read(some_file())});
  const NodeId e = g.add_read(test::temp_folder() + "absent.vti"), f = g.add_operation("add", {}, {b});
  const NodeId all = g.add_operation("join", {}, {a, b, c, d, e, f});
  const std::string text = test::error_of([&] { g.evaluate(all, {}, context); });
  for (const char* part : {"7 errors:", "step 1: ramp n: '0' is not in range", "did you mean 'start'?",
                           "step 3: unknown operation 'sclae'; did you mean 'scale'?",
                           "step 'big': scale mode: 'fnacy' is not one of the choices; did you mean 'fancy'?",
                           "scale by: '1e9' is not in range: it must be from -1000 to 1000",
                           "step 5: scale field: field 'temprature' not found; did you mean 'temperature'?",
                           "scale field: field 'P' not found", "absent.vti: no such file", "add: takes 2 inputs, not 1"})
    CHECK_MESSAGE(text.find(part) != std::string::npos, part << " in " << text);
  CHECK(test::all_runs() == 0);
  CHECK(test::error_of([&] { g.validate(); }) == text);
  CHECK(g.mistakes().size() == 7);
}

TEST_CASE("graph: mistakes in steps that are not needed do not stop the others") {
  Graph g(line_options());
  Context context;
  const NodeId good = g.add_operation("ramp");
  g.add_operation("rmap");
  CHECK(first(g.evaluate(good, {}, context)) == 0);
  CHECK(test::error_of([&] { g.validate(); }).find("step 2: unknown operation 'rmap'") == 0);
  CHECK(test::error_of([&] { g.evaluate(7, {}, context); }) == "there is no step 8");
  const NodeId bad = g.add_operation("scale", {}, {9}), extra = g.add_operation("ramp", {}, {good});
  CHECK(test::error_of([&] { g.evaluate(bad, {}, context); }).find("input 10 is not an earlier step") != std::string::npos);
  CHECK(test::error_of([&] { g.evaluate(extra, {}, context); }).find("is a source and takes no input") != std::string::npos);
}

TEST_CASE("graph: a missing file alone is an error of data, beside wrong words one of usage") {
  Graph g(line_options());
  Context context;
  const NodeId absent = g.add_read(test::temp_folder() + "absent.vti"), wrong = g.add_operation("scale", {"by=x"}, {absent});
  auto kind = [&](NodeId n) {
    try {
      g.evaluate(n, {}, context);
    } catch (const Error& e) {
      return e.kind();
    }
    return ErrorKind::internal;
  };
  CHECK(kind(absent) == ErrorKind::data);
  CHECK(kind(wrong) == ErrorKind::usage);
}

TEST_CASE("graph: a chain too long for the stack is refused") {
  Graph g(line_options());
  Context context;
  NodeId n = g.add_operation("ramp");
  for (int i = 0; i < 999; ++i) n = g.add_operation("whole", {}, {n});
  CHECK(first(g.evaluate(n, {}, context)) == 0);
  n = g.add_operation("whole", {}, {n});
  CHECK(test::error_of([&] { g.evaluate(n, {}, context); }).find("longer than 1000") != std::string::npos);
}

TEST_CASE("graph: an error names the step, and the part of a collection") {
  Graph g(line_options());
  Context context;
  const NodeId ramp = g.add_operation("ramp", {}, {}, "line"), both = g.add_operation("join", {}, {ramp, ramp});
  const NodeId bad = g.add_operation("fail", {}, {both}), end = g.add_operation("scale", {}, {bad});
  CHECK(test::error_of([&] { g.evaluate(end, {}, context); }) ==
        "fail: cannot do that (while in part 'part0', while running 'fail' (step 3))");
  CHECK(runs("scale") == 0);
}

TEST_CASE("graph: without a reader of its own it reads files by read_data") {
  GraphOptions o = line_options();
  o.read = nullptr;
  Graph g(o);
  Context context;
  const NodeId read = g.add_read(some_file("nothing.unknown"));
  const std::string text = test::error_of([&] { g.evaluate(read, {}, context); });
  CHECK(text.find("has an unknown format") != std::string::npos);
  CHECK(text.find("while reading (step 1)") != std::string::npos);
}

TEST_CASE("graph: pieces of a request are cut behind a format that has none") {
  const std::string path = test::temp_folder() + "pieces.raw";
  write_file(path, std::string(8 * 3 * 3, 'x'));
  GraphOptions o = line_options();
  o.read = nullptr;
  Graph g(o);
  ReadOptions brick;
  brick.raw_dims = {8, 3, 3}, brick.raw_type = "u8";
  const NodeId read = g.add_read(path, brick);
  Context context;
  size_t cells = 0;
  for (int i = 0; i < 3; ++i) {
    Request piece;
    piece.piece = i, piece.pieces = 3;
    cells += std::get<DatasetPtr>(g.evaluate(read, piece, context))->cell_count();
  }
  CHECK(cells == 7 * 2 * 2);
}

TEST_CASE("read_part: a region of space names the points of the cells that it meets") {
  UniformGrid u;
  u.dims = {11, 5, 1};
  u.spacing = {0.5, 1, 1};
  const auto r = lattice_region(u, Box3{{1.2, -HUGE_VAL, 0}, {1.6, HUGE_VAL, 0}});
  REQUIRE(r);
  CHECK(r->lo == std::array<size_t, 3>{2, 0, 0});
  CHECK(r->hi == std::array<size_t, 3>{4, 4, 0});
  RectilinearGrid down{Array::from_vector(std::vector<double>{9, 4, 1, 0}),
                       Array::from_vector(std::vector<double>{0}),
                       Array::from_vector(std::vector<double>{0}),
                       {0, 0, 0}};
  const auto d = lattice_region(down, Box3{{2, -1, -1}, {3, 1, 1}});
  REQUIRE(d);
  CHECK(d->lo[0] == 1);
  CHECK(d->hi[0] == 2);
  u.direction.m[0][0] = 0, u.direction.m[0][1] = 1, u.direction.m[1][0] = -1, u.direction.m[1][1] = 0;
  CHECK_FALSE(lattice_region(u, Box3{{0, 0, 0}, {1, 1, 1}}));
}

TEST_CASE("graph: cancelling stops between steps") {
  Graph g(line_options());
  Context context;
  NodeId n = g.add_operation("ramp");
  for (int i = 0; i < 4; ++i) n = g.add_operation("scale", {"by=" + std::to_string(i + 2)}, {n});
  test::on_run = [&](const std::string&, Context& inner) {
    if (runs("scale") == 2) {
      context.cancel();
      CHECK(inner.cancelled());
    }
  };
  try {
    g.evaluate(n, {}, context);
    FAIL("not cancelled");
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::cancelled);
  }
  CHECK(test::all_runs() == 3);
  test::on_run = nullptr;
  Context again;
  CHECK(value_at(g.evaluate(n, {}, again), 1) == 120);  // goes on from what was done
  CHECK(test::all_runs() == 5);
}

TEST_CASE("graph: progress rises from 0 to 1 over the steps") {
  Graph g(line_options());
  Context context;
  std::vector<double> seen;
  std::string doing;
  context.on_progress = [&](double f, std::string_view text) { seen.push_back(f), doing += std::string(text) + ";"; };
  test::on_run = [&](const std::string&, Context& inner) { inner.progress(0.5, "half"); };
  const NodeId a = g.add_operation("ramp"), b = g.add_operation("scale", {}, {a});
  g.evaluate(b, {}, context);
  CHECK(seen == std::vector<double>{0, 0.25, 0.5, 0.75, 1});
  CHECK(doing == "running 'ramp' (step 1);half;running 'scale' (step 2);half;done;");
  test::on_run = nullptr;
}

TEST_CASE("graph: eight threads evaluating at once run each step once and get the same") {
  Graph g(line_options());
  const NodeId ramp = g.add_operation("ramp", {"n=1000"});
  std::vector<NodeId> sinks;
  for (int i = 0; i < 8; ++i) {
    const NodeId a = g.add_operation("scale", {"by=" + std::to_string(2 + i % 2)}, {ramp});
    sinks.push_back(g.add_operation("add", {}, {a, ramp}));
  }
  test::on_run = [](const std::string&, Context&) { std::this_thread::sleep_for(std::chrono::milliseconds(5)); };
  std::vector<double> values(8);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < 8; ++i)
    threads.emplace_back([&, i] {
      Context context;
      values[i] = value_at(g.evaluate(sinks[i], {}, context), 1);
    });
  for (std::thread& t : threads) t.join();
  for (size_t i = 0; i < 8; ++i) CHECK(values[i] == double(3 + i % 2));
  CHECK(runs("ramp") == 1);
  CHECK(runs("scale") == 2);
  CHECK(runs("add") == 2);
  test::on_run = nullptr;
}

TEST_CASE("graph: graphs that share a cache share results") {
  GraphOptions o = line_options();
  o.cache = std::make_shared<Cache>(1 << 20);
  Graph a(o), b(o);
  Context context;
  a.evaluate(a.add_operation("ramp"), {}, context);
  b.evaluate(b.add_operation("ramp"), {}, context);
  CHECK(runs("ramp") == 1);
  CHECK(&a.cache() == &b.cache());
}

TEST_CASE("graph: explain shows the plan and runs nothing") {
  Reads reads;
  Graph g(line_options(1 << 20, &reads));
  Context context;
  const NodeId head = g.add_read(some_file(), {}, "head"), bone = g.add_operation("scale", {"field=T"}, {head}, "bone");
  const NodeId end = g.add_operation("scale", {"field=T", "by=3"}, {bone});
  const std::string before = g.explain(end, Request::only({"p"}));
  CHECK(test::all_runs() == 0);
  CHECK(reads.seen.empty());
  CHECK(before.find("head  read 'graph.raw'") != std::string::npos);
  CHECK(before.find("~3.9 KiB") != std::string::npos);
  CHECK(before.find("fields=T,p") != std::string::npos);
  CHECK(before.find(key_text(g.key(head, Request::only({"T", "p"}))).substr(0, 8)) != std::string::npos);
  CHECK(before.find("3 of 3 steps run") != std::string::npos);

  const Target target{end, {}};
  std::vector<PlannedStep> plan = g.plan({&target, 1});
  REQUIRE(plan.size() == 3);
  CHECK(plan[0].bytes == 4000);
  CHECK(plan[0].seconds == doctest::Approx(4000 / 2e9));
  CHECK(plan[1].seconds == doctest::Approx(8000 / 2e9));
  CHECK(plan[2].name == "3");

  g.evaluate(bone, {}, context);
  plan = g.plan({&target, 1});
  CHECK(plan[0].state == PlannedStep::State::cached);
  CHECK(plan[0].bytes == 3 * 64);  // exact now
  CHECK(plan[1].state == PlannedStep::State::cached);
  CHECK(plan[1].seconds == 0);
  CHECK(plan[2].state == PlannedStep::State::run);
  CHECK(g.explain(end).find("1 of 3 steps run") != std::string::npos);
  g.cache().set_limit(3 * 64);  // the read goes; nobody needs it while its consumer stays
  plan = g.plan({&target, 1});
  CHECK(plan[0].state == PlannedStep::State::not_needed);
  CHECK(plan[1].state == PlannedStep::State::cached);
}

TEST_CASE("graph: an operation may state its own estimate") {
  std::vector<Operation> table(test::counted_operations().begin(), test::counted_operations().end());
  table[0].estimate = [](const ParamSet& p, std::span<const uint64_t> in) {
    CHECK(in.empty());
    return Estimate{uint64_t(std::get<int64_t>(p.schema.find("n")->ref.get())) * 8, 2.5};
  };
  GraphOptions o = line_options();
  o.operations = table;
  Graph g(o);
  const NodeId n = g.add_operation("scale", {}, {g.add_operation("ramp", {"n=1000000"})});
  const std::string text = g.explain(n);
  CHECK(text.find("~7.6 MiB") != std::string::npos);
  CHECK(text.find("~2.5 s") != std::string::npos);
}
