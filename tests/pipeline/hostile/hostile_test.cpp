// SPDX-License-Identifier: Apache-2.0
// Every operation of this build with what nobody means to give it: it answers or throws sg::Error, soon, without asking for gigabytes.
// SG_HOSTILE_ALL=1: also curved solids of many nodes, and series of every mesh. SG_HOSTILE_ONLY=OPERATION: that one alone, all
// of its cases, each told before it runs and with its time.
#include <algorithm>

#include "pipeline/hostile/hostile_inputs.h"

#include <fmt/format.h>

#include "filter/probe/cell_slabs.h"
#include "pipeline/hostile/hostile_watch.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

bool all_asked() { return hostile::only() || std::getenv("SG_HOSTILE_ALL"); }
bool tells() { return hostile::only() || std::getenv("SG_HOSTILE_TELL"); }
bool wanted(const Operation& o) { return !hostile::only() || o.name == hostile::only(); }

size_t refused, answered;

// Runs it; what it does besides answering or throwing sg::Error is a failed check.
void stays_calm(const Operation& o, const std::string& what, const std::function<Data(Context&)>& run) {
  static size_t turn = 0;  // slow: every fourth case
  if (hostile::shadow_memory && !all_asked() && turn++ % 4 != 0) return;
  if (tells()) fmt::print(stderr, "{}: {}", o.name, what);  // where it fell
  const std::clock_t start = std::clock();                  // of the processor: other programs may be at work
  std::string failure;
  try {
    Context context;
    run(context);
    ++answered;
  } catch (const Error& e) {
    ++refused;
    if (tells()) fmt::print(stderr, " [{}]", e.what());
    if (std::string_view(e.what()).empty() || e.kind() == ErrorKind::internal) failure = fmt::format("an internal error: {}", e.what());
  } catch (const std::exception& e) {
    failure = fmt::format("{}: {}", typeid(e).name(), e.what());
  }
  const double took = double(std::clock() - start) / CLOCKS_PER_SEC;
  if (tells()) fmt::print(stderr, ": {:.2f} s\n", took);
  if (took > hostile::seconds(5)) failure += fmt::format(" took {:.1f} s", took);
  if (!failure.empty()) FAIL_CHECK(fmt::format("{}: {}: {}", o.name, what, failure));
}

// Words before the hostile one: pictures, grids and numbers of particles of default size take too long.
std::vector<std::string> words_for(const Operation& o, const std::string& word) {
  std::vector<std::string> r;
  const ParamSet params = o.make_params();
  for (const char* name : {"size", "resolution", "density"}) {
    const ParamDecl* d = params.schema.find(name);
    const bool surface_texture = d && d->name == "density" && !params.schema.find("resolution");
    const bool takes = d && (d->ref.type() == ParamType::integer || surface_texture);
    if (takes && !word.starts_with(d->name + "=")) r.push_back(d->name + "=8");
  }
  if (o.name.ends_with("_surface") && params.schema.find("spacing") && !word.starts_with("spacing=")) r.push_back("spacing=0.1");
  if (params.schema.find("most_points") && !word.starts_with("most_points=")) r.push_back("most_points=10000");
  if (!word.empty()) r.push_back(word);
  return r;
}

std::vector<Data> enough(const Operation& o, const Data& data, bool most) {
  const int n = std::max(1, most && o.max_inputs > o.min_inputs ? o.min_inputs + 1 : o.min_inputs);
  return std::vector<Data>(size_t(n), data);
}

// The first of the plain inputs that it answers.
const Data& suitable(const Operation& o) {
  for (const hostile::Input& in : hostile::plain_inputs()) try {
      Context context;
      run_operation(o, enough(o, in.data, false), words_for(o, {}), context);
      return in.data;
    } catch (const Error&) {
      continue;
    }
  return hostile::plain_inputs()[0].data;
}

std::vector<std::string> words_of(const Operation& o) {
  std::vector<std::string> r;
  const ParamSet params = o.make_params();
  for (const ParamDecl& d : params.schema.decls())
    for (std::string& word : hostile::words(d)) r.push_back(std::move(word));
  return r;
}

}  // namespace

TEST_CASE("operations: none crashes, hangs or asks for gigabytes on meshes that are empty, bare, of one cell, of NaN, huge or tiny") {
  hostile::inputs();
  const hostile::MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source || !wanted(o)) continue;
    for (const hostile::Input& in : hostile::inputs())
      for (const bool most : {false, true}) {
        if ((most && o.max_inputs == o.min_inputs) || (in.slow && !all_asked())) continue;
        stays_calm(o, in.name, [&](Context& c) { return run_operation(o, enough(o, in.data, most), words_for(o, {}), c); });
      }
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: none crashes, hangs or asks for gigabytes when its inputs are unlike, and some of them empty") {
  hostile::unlike_inputs();
  const hostile::MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source || !wanted(o) || o.max_inputs == 1) continue;
    for (const hostile::Input& first : hostile::unlike_inputs())
      for (const hostile::Input& second : hostile::unlike_inputs()) {
        std::vector<Data> data{first.data, second.data};
        while (int(data.size()) < o.min_inputs) data.push_back(first.data);
        stays_calm(o, first.name + " and " + second.name, [&](Context& c) { return run_operation(o, data, words_for(o, {}), c); });
      }
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: none crashes, hangs or asks for gigabytes for numbers that are huge, negative or NaN, and words of any kind") {
  hostile::plain_inputs();
  const hostile::MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (!wanted(o)) continue;
    const bool source = o.kind == OperationKind::source;
    const std::vector<Data> data = source ? std::vector<Data>() : enough(o, suitable(o), false);
    for (const std::string& word : words_of(o))
      stays_calm(o, word, [&](Context& c) { return run_operation(o, data, words_for(o, word), c); });
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: those that take a time series stand any number of steps, times that do not rise, and steps unlike each other") {
  const std::vector<hostile::Times> cases = hostile::series(all_asked());
  const Data grid = hostile::plain_inputs()[0].data;
  const hostile::MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (!o.run_series || !wanted(o)) continue;
    for (const hostile::Times& c : cases) {
      const Series series{c.times, [&](size_t i) { return c.steps.at(i); }};
      for (const bool second : {false, true})
        stays_calm(o, c.name, [&](Context& context) {
          const ParamSet params = make_params(o, words_for(o, {}));
          return o.run_series(series, second ? std::vector<Data>{grid} : std::vector<Data>{}, params, context);
        });
    }
    const Series moving{{0, 1, 2}, [&](size_t) { return grid; }};
    for (const std::string& word : words_of(o))
      stays_calm(o, word, [&](Context& context) {
        const ParamSet params = make_params(o, words_for(o, word));
        return o.run_series(moving, {}, params, context);
      });
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("glyph_points: a cloud with fields on cells that it does not have has no middles of cells") {
  DatasetParts parts;
  parts.mesh = PointCloud{{Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3), {}}};
  parts.fields.add({"v", Association::cell, Array::from_vector(std::vector<float>{}, 3), "", Role::vectors});
  Context context;
  const Data middles = run_operation(find_operation("glyph_points"), {make_dataset(std::move(parts))}, {"mode=cells"}, context);
  CHECK(single_dataset(middles, "test")->point_count() == 0);
}

TEST_CASE("sampling: an interval with an end that is NaN holds no points of a grid, nor does one beyond it") {
  const auto empty = [](double from, double to) {
    ptrdiff_t lo = 0, hi = 0;
    GridScan::points_in(from, to, 8, lo, hi);
    CHECK(lo >= 0);
    CHECK(hi < 8);
    return lo > hi;
  };
  CHECK(empty(NAN, 3));
  CHECK(empty(2, NAN));
  CHECK(empty(NAN, NAN));
  CHECK(empty(NAN, HUGE_VAL));
  CHECK(empty(8, HUGE_VAL));
  CHECK(empty(-HUGE_VAL, -1));
  CHECK(!empty(-HUGE_VAL, HUGE_VAL));
  CHECK(GridScan::within(NAN, 1, 7) == 1);
  CHECK(GridScan::within(9, 1, 7) == 7);
  CHECK(GridScan::within(-9, 1, 7) == 1);
  CHECK(GridScan::within(3, 1, 7) == 3);
}

TEST_CASE("fronts: seeds so close together that there are millions of them are refused, with what would be right") {
  const Data grid = hostile::plain_inputs()[0].data;
  const struct {
    const char* operation;
    std::vector<std::string> words;
  } cases[] = {{"path_surface", {"from=0,0,0", "to=1,0,0", "spacing=1e-9"}},
               {"streak_surface", {"from=0,0,0", "to=1e9,0,0", "spacing=1"}},
               {"time_surface", {"center=0,0,0", "size=1e9,1e9", "spacing=0.1"}},
               {"time_surface", {"center=0,0,0", "size=1e9,1", "spacing=0.01"}}};
  for (const auto& c : cases) {
    CAPTURE(c.operation);
    const Operation& o = find_operation(c.operation);
    Context context;
    std::string said;
    try {
      o.run_series({{0, 1}, [&](size_t) { return grid; }}, {}, make_params(o, c.words), context);
    } catch (const Error& e) {
      said = e.what();
    }
    CHECK(said.find("seeds are too many") != said.npos);
    CHECK(said.find("use a larger spacing") != said.npos);
  }
}
