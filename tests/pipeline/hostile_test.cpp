// SPDX-License-Identifier: Apache-2.0
// Every operation of this build with what nobody means to give it: it answers or throws sg::Error, soon, without asking for gigabytes.
// Minutes of work: skipped unless SG_HOSTILE_ALL is set, or SG_HOSTILE_ONLY to the name of one operation, which tells each case before it.
#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <ctime>
#include <fstream>

#include "data/dataset.h"
#include "pipeline/operation.h"
#include "support/test.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SG_SHADOW_MEMORY 1
#endif

using namespace sg;

namespace {

// Within its life the process may have one gigabyte more than before.
class MemoryFence {
 public:
  MemoryFence() {
#ifndef SG_SHADOW_MEMORY
    getrlimit(RLIMIT_AS, &before_);
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit fence = before_;
    fence.rlim_cur = std::min<rlim_t>(before_.rlim_max, pages * 4096 + (size_t(1) << 30));
    setrlimit(RLIMIT_AS, &fence);
#endif
  }
  ~MemoryFence() {
#ifndef SG_SHADOW_MEMORY
    setrlimit(RLIMIT_AS, &before_);
#endif
  }

 private:
  rlimit before_{};
};

struct Input {
  std::string name;
  Data data;
};

enum class Values { none, plain, nan };

// A scalar, a vector, a symmetric tensor, labels: on points and on cells.
DatasetPtr with(Mesh mesh, Values values) {
  const DatasetPtr bare = make_dataset(std::move(mesh));
  if (values == Values::none) return bare;
  FieldSet fields;
  for (const Association a : {Association::point, Association::cell}) {
    const size_t n = a == Association::point ? bare->point_count() : bare->cell_count();
    auto field = [&](const char* name, int components, Role role) {
      std::vector<double> v(n * size_t(components));
      for (size_t i = 0; i < v.size(); ++i) v[i] = values == Values::nan ? NAN : std::sin(0.7 * double(i) + components) + 0.2;
      fields.add({name, a, Array::from_vector(std::move(v), components), "", role});
    };
    field("s", 1, a == Association::point ? Role::scalars : Role::none);
    field("v", 3, a == Association::point ? Role::vectors : Role::none);
    field("t", 6, a == Association::point ? Role::tensors : Role::none);
    field("m", 9, Role::none);
    std::vector<int32_t> labels(n);
    for (size_t i = 0; i < n; ++i) labels[i] = int32_t(i * 7 % 5);
    fields.add({"labels", a, Array::from_vector(std::move(labels)), "", Role::labels});
  }
  return make_dataset(bare->mesh(), std::move(fields));
}

UniformGrid box(size_t nx, size_t ny, size_t nz) {
  UniformGrid g;
  g.dims = {nx, ny, nz};
  g.spacing = {0.5, 0.25, 0.125};
  return g;
}

Points points_of(std::vector<double> xyz) { return {Array::from_vector(std::move(xyz), 3), {}}; }

UnstructuredMesh tetrahedra(std::vector<double> xyz, std::vector<int32_t> ids) {
  UnstructuredMesh m;
  m.points = points_of(std::move(xyz));
  m.cells = {Array::from_vector(std::move(ids)), {}, 4};
  m.single_type = CellType::tetra;
  return m;
}

SurfaceMesh surface(std::vector<double> xyz, std::vector<int32_t> triangles, std::vector<int32_t> lines = {}) {
  SurfaceMesh m;
  m.points = points_of(std::move(xyz));
  if (!triangles.empty()) m.polygons = {Array::from_vector(std::move(triangles)), {}, 3};
  if (!lines.empty()) m.lines = {Array::from_vector(std::move(lines)), {}, 2};
  return m;
}

CurvilinearGrid curved(size_t n, double scale, double bad) {
  CurvilinearGrid g;
  g.dims = {n, n, n};
  std::vector<double> xyz;
  for (size_t i = 0; i < n * n * n; ++i)
    for (const size_t c : {i % n, i / n % n, i / n / n}) xyz.push_back(scale * double(c));
  if (bad != 0) xyz[4] = bad;
  g.points = points_of(std::move(xyz));
  return g;
}

const std::vector<double> corners{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};

std::vector<Input> inputs() {
  std::vector<Input> r;
  auto add = [&](std::string name, auto mesh, Values values) { r.push_back({std::move(name), with(Mesh(std::move(mesh)), values)}); };
  for (const Values v : {Values::none, Values::plain, Values::nan}) {
    const std::string what = v == Values::none ? "bare " : v == Values::nan ? "NaN " : "";
    add(what + "grid", box(4, 4, 4), v);
    add(what + "flat grid", box(5, 4, 1), v);
    add(what + "tetrahedra", tetrahedra(corners, {0, 1, 2, 3, 1, 2, 3, 4}), v);
    add(what + "surface", surface(corners, {0, 1, 2, 0, 1, 3, 1, 2, 4}), v);
    add(what + "lines", surface(corners, {}, {0, 1, 1, 2, 3, 4}), v);
    add(what + "cloud", PointCloud{points_of(corners)}, v);
    add(what + "point", PointCloud{points_of({1, 2, 3})}, v);
    add(what + "grid of a point", box(1, 1, 1), v);
    add(what + "grid of a cell", box(2, 2, 2), v);
    add(what + "tetrahedron", tetrahedra(corners, {0, 1, 2, 3}), v);
    add(what + "triangle", surface(corners, {0, 1, 2}), v);
    add(what + "line without length", surface({1, 1, 1, 1, 1, 1}, {}, {0, 1}), v);
    add(what + "collapsed grid", curved(3, 0, 0), v);
    add(what + "empty cloud", PointCloud{points_of({})}, v);
    add(what + "empty surface", surface({}, {}), v);
    add(what + "empty tetrahedra", tetrahedra({}, {}), v);
    add(what + "points without cells", tetrahedra(corners, {}), v);
  }
  add("huge grid", curved(3, 1e300, 0), Values::plain);
  add("tiny grid", curved(3, 1e-300, 0), Values::plain);
  add("grid with a NaN place", curved(3, 1, NAN), Values::plain);
  add("grid with an infinite place", curved(3, 1, HUGE_VAL), Values::plain);
  r.push_back({"empty collection", CollectionPtr(std::make_shared<Collection>())});
  r.push_back({"empty table", TablePtr(std::make_shared<Table>())});
  return r;
}

const std::vector<const char*> hostile_numbers{"0", "-1", "1e300", "-1e300", "1e-300", "nan", "inf", "2147483647", "9223372036854775807"};

std::vector<std::string> hostile_words(const ParamDecl& d) {
  std::vector<std::string> r;
  auto add = [&](std::string value) { r.push_back(d.name + "=" + value); };
  if (std::get_if<bool*>(&d.ref)) add("true"), add("false");
  else if (std::get_if<FieldName*>(&d.ref))
    for (const char* name : {"s", "v", "t", "m", "labels", "nothing"}) add(name);
  else if (!d.choices_.empty())
    for (const std::string& choice : d.choices_) add(choice);
  else if (std::get_if<std::string*>(&d.ref) || std::get_if<std::vector<std::string>*>(&d.ref))
    for (const char* text : {"s", "v", "nothing", "1e300", "x+*", "-1:nan:3", "0:1:999999999"}) add(text);
  else if (std::get_if<Vec3*>(&d.ref) || std::get_if<std::optional<Vec3>*>(&d.ref))
    for (const char* v : {"0,0,0", "nan,0,0", "1e300,-1e300,1e300", "1e-300,0,0", "inf,inf,inf"}) add(v);
  else if (std::get_if<std::vector<double>*>(&d.ref) || std::get_if<std::vector<int64_t>*>(&d.ref))
    for (const char* v : {"0", "-1,-1,-1", "0,0,0,0,0,0", "1e300,1e300,1e300", "nan,nan,nan", "2147483647,2147483647,2147483647",
                          "1,0,1,0,1,0", "0,1,0,1,0,1", "9223372036854775807"})
      add(v);
  else
    for (const char* n : hostile_numbers)
      if (d.name != "step" || std::string_view(n) != "1e-300") add(n);  // takes the many steps that it asks for
  return r;
}

size_t refused, answered;

// One operation alone, each case told before it runs: where does it crash?
const char* only() { return std::getenv("SG_HOSTILE_ONLY"); }

bool not_asked() { return !only() && !std::getenv("SG_HOSTILE_ALL"); }

// Runs it; what it does besides answering or throwing sg::Error is a failed check.
void stays_calm(const Operation& o, const std::string& what, const std::function<Data(Context&)>& run) {
  if (only()) fmt::print(stderr, "{}\n", what);  // tells where it fell
  const std::clock_t start = std::clock();       // of the processor: other programs may be at work
  std::string failure;
  try {
    Context context;
    run(context);
    ++answered;
  } catch (const Error& e) {
    ++refused;
    if (std::string_view(e.what()).empty() || e.kind() == ErrorKind::internal) failure = fmt::format("an internal error: {}", e.what());
  } catch (const std::exception& e) {
    failure = fmt::format("{}: {}", typeid(e).name(), e.what());
  }
  const double took = double(std::clock() - start) / CLOCKS_PER_SEC;
#ifndef SG_SHADOW_MEMORY
  if (took > 2) failure += fmt::format(" took {:.1f} s", took);
#endif
  if (!failure.empty()) FAIL_CHECK(fmt::format("{}: {}: {}", o.name, what, failure));
}

bool wanted(const Operation& o) { return !only() || o.name == only(); }

// Words before the hostile one: pictures and grids of default size take too long.
std::vector<std::string> words_for(const Operation& o, const std::string& word) {
  std::vector<std::string> r;
  const ParamSet params = o.make_params();
  const ParamDecl* size = params.schema.find("size");
  if (size && std::get_if<int*>(&size->ref) && !word.starts_with("size=")) r.push_back("size=8");
  if (!word.empty()) r.push_back(word);
  return r;
}

std::vector<Data> enough(const Operation& o, const Data& data, bool most) {
  const int n = std::max(1, most && o.max_inputs > o.min_inputs ? o.min_inputs + 1 : o.min_inputs);
  return std::vector<Data>(size_t(n), data);
}

bool answers(const Operation& o, const Data& data) {
  try {
    Context context;
    run_operation(o, enough(o, data, false), words_for(o, {}), context);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

TEST_CASE("operations: none crashes, hangs or asks for gigabytes on meshes that are empty, bare, of one cell, of NaN, huge or tiny" *
          doctest::skip(not_asked())) {
  const std::vector<Input> all = inputs();
  const MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source || !wanted(o)) continue;
    for (const Input& in : all)
      for (const bool most : {false, true}) {
        if (most && o.max_inputs == o.min_inputs) continue;
        stays_calm(o, in.name, [&](Context& c) { return run_operation(o, enough(o, in.data, most), words_for(o, {}), c); });
      }
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: none crashes, hangs or asks for gigabytes for numbers that are huge, negative or NaN, and words of any kind" *
          doctest::skip(not_asked())) {
  const Data grid = with(box(4, 4, 4), Values::plain), flat = with(box(5, 4, 1), Values::plain),
             skin = with(surface(corners, {0, 1, 2, 0, 1, 3, 1, 2, 4}), Values::plain);
  const MemoryFence fence;
  refused = answered = 0;
  for (const Operation& o : operations()) {
    if (!wanted(o)) continue;
    const ParamSet params = o.make_params();
    const Data* data = nullptr;
    for (const ParamDecl& d : params.schema.decls())
      for (const std::string& word : hostile_words(d)) {
        if (o.kind == OperationKind::source) {
          stays_calm(o, word, [&](Context& c) { return run_operation(o, {}, words_for(o, word), c); });
          continue;
        }
        if (!data)
          for (const Data* candidate : {&grid, &flat, &skin})
            if (answers(o, *candidate)) {
              data = candidate;
              break;
            }
        if (!data) data = &grid;
        stays_calm(o, word, [&](Context& c) { return run_operation(o, enough(o, *data, false), words_for(o, word), c); });
      }
  }
  MESSAGE(answered << " answered, " << refused << " refused");
}

TEST_CASE("operations: those that take a time series stand any number of steps, times that do not rise, and steps unlike each other" *
          doctest::skip(not_asked())) {
  const std::vector<Input> all = inputs();
  const Data grid = with(box(4, 4, 4), Values::plain), flat = with(box(5, 4, 1), Values::plain);
  const MemoryFence fence;
  struct Case {
    std::string name;
    std::vector<double> times;
    std::vector<Data> steps;
  };
  std::vector<Case> cases{{"no step", {}, {}},
                          {"one step", {3}, {grid}},
                          {"equal times", {1, 1, 1}, {grid, grid, grid}},
                          {"falling times", {2, 1, 0}, {grid, grid, grid}},
                          {"NaN times", {0, NAN, 2}, {grid, grid, grid}},
                          {"infinite times", {0, 1, HUGE_VAL}, {grid, grid, grid}},
                          {"huge times", {-1e300, 0, 1e300}, {grid, grid, grid}},
                          {"tiny steps", {0, 1e-300, 2e-300}, {grid, grid, grid}},
                          {"grids unlike", {0, 1, 2}, {grid, flat, grid}}};
  for (const Input& in : all) {
    cases.push_back({in.name + " at all times", {0, 1, 2}, {in.data, in.data, in.data}});
    cases.push_back({in.name + " at last", {0, 1}, {grid, in.data}});
  }
  for (const Operation& o : operations()) {
    if (!o.run_series || !wanted(o)) continue;
    for (const Case& c : cases) {
      const Series series{c.times, [&](size_t i) { return c.steps.at(i); }};
      for (const bool second : {false, true})
        stays_calm(o, c.name, [&](Context& context) {
          const ParamSet params = make_params(o, words_for(o, {}));
          return o.run_series(series, second ? std::vector<Data>{grid} : std::vector<Data>{}, params, context);
        });
    }
    const Series moving{{0, 1, 2}, [&](size_t) { return grid; }};
    const ParamSet names = o.make_params();
    for (const ParamDecl& d : names.schema.decls())
      for (const std::string& word : hostile_words(d)) {
        stays_calm(o, word, [&](Context& context) {
          const ParamSet params = make_params(o, words_for(o, word));
          return o.run_series(moving, {}, params, context);
        });
      }
  }
}
