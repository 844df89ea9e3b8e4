// SPDX-License-Identifier: Apache-2.0
// Reading in a process of its own: every kind of data comes back as it was, and no child takes more than it may.
#include "io/isolated/isolated.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

#include "base/file/file.h"
#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "io/corpus.h"
#include "io/io.h"
#include "io/mesh/unread.h"
#include "io/plausible.h"
#include "support/test.h"

using namespace sg;

namespace {

std::string small_file() {
  const std::string path = test::temp_folder() + "isolated.bin";
  write_file(path, "x");
  return path;
}

std::string error_within(const ChildLimits& limits, const std::function<Data(Context&)>& read) {
  Context context;
  return test::error_of([&] { read_isolated(small_file(), limits, read, context); });
}

Field field(const char* name, Association a, std::vector<float> v, int components = 1) {
  return {name, a, Array::from_vector(std::move(v), components), "m/s", components == 3 ? Role::vectors : Role::scalars};
}

bool same_bytes(const Array& a, const Array& b) {
  const Array p = a.made_packed(), q = b.made_packed();
  return p.type() == q.type() && p.count() == q.count() && p.components() == q.components() &&
         (p.empty() || std::memcmp(p.raw(), q.raw(), p.bytes()) == 0);
}

void check_same(const Field& a, const Field& b) {
  CHECK(a.name == b.name);
  CHECK(a.unit == b.unit);
  CHECK(a.association == b.association);
  CHECK(a.role == b.role);
  CHECK(same_bytes(a.array, b.array));
}

constexpr ChildLimits enough{size_t(1) << 30, 10, 100};

}  // namespace

TEST_CASE("isolated: every kind of mesh, its fields, ghosts, notes and time come back as they were, and so do tables and nested parts") {
  const std::vector<float> xyz{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const Points points{Array::from_vector(xyz, 3), {1e6, 2, 3}};
  std::vector<DatasetPtr> all;
  UniformGrid u;
  u.dims = {2, 2, 1}, u.origin = {1, 2, 3}, u.spacing = {.5, 1, 2}, u.extent_start = {-4, 5, 6};
  DatasetParts p;
  p.mesh = u;
  p.fields.add(field("T", Association::point, {1, 2, 3, 4}));
  p.fields.add(field("v", Association::cell, {1, 2, 3}, 3));
  p.fields.add(field("w", Association::whole, {7, 8}));
  p.point_ghost = Array::from_vector(std::vector<uint8_t>{0, 2, 0, 0});
  p.cell_ghost = Array::from_vector(std::vector<uint8_t>{1});
  p.notes = {{"title", "a \n title"}};
  p.time = 0.25;
  all.push_back(make_dataset(std::move(p)));
  RectilinearGrid r;
  r.x = Array::from_vector(std::vector<double>{0, 1, 3}), r.y = Array::from_vector(std::vector<double>{2, 1}), r.z = r.y;
  all.push_back(make_dataset(r));
  all.push_back(make_dataset(CurvilinearGrid{{2, 2, 1}, points, {1, 2, 3}}));
  UnstructuredMesh g;
  g.points = points, g.cells.fixed = 4, g.cells.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3});
  g.single_type = CellType::tetra;
  all.push_back(make_dataset(g));
  SurfaceMesh s;
  s.points = points;
  s.polygons.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 3, 2, 1, 0}),
  s.polygons.offsets = Array::from_vector(std::vector<int64_t>{0, 3, 7});
  s.vertices.fixed = 1, s.vertices.connectivity = Array::from_vector(std::vector<int32_t>{2});
  all.push_back(make_dataset(s));
  all.push_back(make_dataset(PointCloud{points}));
  AmrGrid a;
  a.levels.resize(2);
  a.levels[0].patches.push_back({{0, 0, 0}, {1, 1, 1}, 0, 0});
  a.levels[1].spacing = {.5, .5, .5};
  a.levels[1].patches.push_back({{0, 0, 0}, {1, 1, 1}, 8, 27});
  all.push_back(make_dataset(a));

  auto inner = std::make_shared<Collection>();
  for (const DatasetPtr& d : all) inner->parts.push_back({std::string(d->kind()), d});
  auto table = std::make_shared<Table>();
  table->columns = {field("x", Association::whole, {1, 2}),
                    {"word", Association::whole, Array::from_vector(std::vector<int32_t>{1, -1}), "", Role::none}};
  table->labels = {{}, {"no", "yes"}};
  auto outer = std::make_shared<Collection>();
  outer->parts = {{"meshes", CollectionPtr(inner)}, {"table", TablePtr(table)}};

  Context context;
  std::vector<std::string> said;
  context.on_log = [&](LogLevel, std::string_view t) { said.emplace_back(t); };
  const Data back = read_isolated(
      small_file(), enough,
      [&](Context& c) {
        c.warn("a word");
        return Data(CollectionPtr(outer));
      },
      context);
  CHECK(said == std::vector<std::string>{"a word"});
  const auto& parts = std::get<CollectionPtr>(back)->parts;
  REQUIRE(parts.size() == 2);
  const auto& meshes = std::get<CollectionPtr>(parts[0].data)->parts;
  REQUIRE(meshes.size() == all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    const Dataset &d = *std::get<DatasetPtr>(meshes[i].data), &e = *all[i];
    CAPTURE(e.kind());
    CHECK(meshes[i].name == e.kind());
    CHECK(d.kind() == e.kind());
    CHECK(summary(d) == summary(e));
    CHECK(d.bounds().lo == e.bounds().lo);
    CHECK(d.bounds().hi == e.bounds().hi);
    CHECK(cell_type_counts(d.mesh()) == cell_type_counts(e.mesh()));
    CHECK(d.notes() == e.notes());
    CHECK(d.time() == e.time());
    CHECK(same_bytes(d.point_ghost(), e.point_ghost()));
    CHECK(same_bytes(d.cell_ghost(), e.cell_ghost()));
    REQUIRE(d.fields().size() == e.fields().size());
    for (size_t k = 0; k < d.fields().size(); ++k) check_same(d.fields()[k], e.fields()[k]);
  }
  CHECK(std::get<DatasetPtr>(meshes[0].data)->as<UniformGrid>()->extent_start == u.extent_start);
  // Arrays that were shared are shared again.
  CHECK(std::get<DatasetPtr>(meshes[2].data)->as<CurvilinearGrid>()->points.xyz.raw() ==
        std::get<DatasetPtr>(meshes[5].data)->as<PointCloud>()->points.xyz.raw());
  const Table& t = *std::get<TablePtr>(parts[1].data);
  CHECK(t.labels == table->labels);
  REQUIRE(t.columns.size() == 2);
  for (size_t k = 0; k < 2; ++k) check_same(t.columns[k], table->columns[k]);
}

TEST_CASE("isolated: values that were not read cost nothing on the way, however many there are") {
  Context context;
  const size_t n = size_t(1) << 11;
  const Data back = read_isolated(
      small_file(), {size_t(64) << 20, 10, 100},
      [&](Context&) {
        DatasetParts p;
        UniformGrid u;
        u.dims = {n, n, n};
        p.mesh = u;
        p.fields.add({"rho", Association::point, unread_values(ElementType::f64, n * n * n), "", Role::none});
        return Data(make_dataset(std::move(p)));
      },
      context);
  const Array a = std::get<DatasetPtr>(back)->fields().require("rho").array;
  CHECK(a.count() == n * n * n);
  CHECK(std::isnan(a.get(n * n * n - 1)));
}

TEST_CASE(
    "isolated: a child that computes, waits or takes memory without end is ended, and the error names the file, the limit and its word") {
  const auto begin = std::chrono::steady_clock::now();
  const std::string computes = error_within({enough.memory, 0.5, 100}, [](Context&) -> Data {
    for (volatile bool on = true; on;) {
    }
    return {};
  });
  CHECK(computes.find("isolated.bin") != std::string::npos);
  CHECK(computes.find("s of processor time") != std::string::npos);
  CHECK(computes.find("SIGHTGLASS_READ_SECONDS") != std::string::npos);
  const std::string waits = error_within({enough.memory, 10, 0.3}, [](Context&) -> Data {
    for (;;) ::pause();
  });
  CHECK(waits.find("s of wall-clock time") != std::string::npos);
  CHECK(waits.find("SIGHTGLASS_READ_SECONDS") != std::string::npos);
  const std::string takes = error_within({size_t(64) << 20, 10, 100}, [](Context&) -> Data {
    std::vector<std::vector<char>> all;
    for (;;) all.emplace_back(size_t(4) << 20, 'x');
  });
  CHECK(takes.find("more memory than the 64.0 MiB") != std::string::npos);
  CHECK(takes.find("--memory") != std::string::npos);
  const std::string array = error_within({size_t(64) << 20, 10, 100}, [](Context&) -> Data {
    std::byte* to = nullptr;
    Array::make_raw(ElementType::f64, size_t(1) << 24, 1, &to);
    return {};
  });
  CHECK(array.find("not enough memory") != std::string::npos);
  const std::string dies = error_within(enough, [](Context&) -> Data { std::abort(); });
  CHECK(dies.find("the library that reads it failed") != std::string::npos);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 20);
}

TEST_CASE("isolated: parallel loops run on the child's one thread") {
  Context context;
  const Data back = read_isolated(
      small_file(), enough,
      [](Context&) -> Data {
        std::vector<float> v(1000);
        parallel_for(v.size(), 10, [&](size_t b, size_t e) {
          for (size_t i = b; i < e; ++i) v[i] = float(i);
        });
        auto t = std::make_shared<Table>();
        t->columns.push_back({"v", Association::whole, Array::from_vector(std::move(v)), "", Role::none});
        return TablePtr(t);
      },
      context);
  CHECK(std::get<TablePtr>(back)->columns[0].array.get(999) == 999);
}

TEST_CASE("isolated: what reading may take grows with the file, and with what the user says") {
  const ChildLimits small = reading_limits(100), large = reading_limits(size_t(1) << 30);
  CHECK(small.memory <= size_t(1) << 30);
  CHECK(large.memory >= size_t(100) << 30);
  CHECK(large.processor > 1000);
  ::setenv("SIGHTGLASS_READ_SECONDS", "5000", 1);
  CHECK(reading_limits(100).processor == 5000);
  ::unsetenv("SIGHTGLASS_READ_SECONDS");
  CHECK(reading_limits(100).processor == small.processor);
  set_memory_limit(size_t(8) << 30);
  CHECK(reading_limits(100).memory > size_t(16) << 30);
  CHECK(plausible_memory(100) == size_t(8) << 30);
  set_memory_limit(0);
  CHECK(reading_limits(100).memory == small.memory);
  const std::string error = test::error_of([] { check_plausible(uint64_t(3) << 30, 1000, "small.gz"); });
  CHECK(error.find("small.gz") != std::string::npos);
  CHECK(error.find("3.0 GiB") != std::string::npos);
  CHECK(error.find("--memory 4G") != std::string::npos);
  check_plausible(uint64_t(3) << 30, uint64_t(1) << 30, "large.gz");
}

TEST_CASE("netcdf, cgns, tiff: files are opened in processes of their own alone") {
  const auto faults_of_children = [] {
    rusage u{};
    ::getrusage(RUSAGE_CHILDREN, &u);
    return u.ru_minflt;
  };
  for (const std::string plugin : {"netcdf", "cgns", "tiff"}) {
    if (test::missing(plugin)) continue;
    CAPTURE(plugin);
    size_t n = 0;
    test::for_seeds(plugin, [&](test::Seed& seed, const std::string&) {
      if (n++ > 3) return;
      const long before = faults_of_children();
      CHECK(seed.read(seed.bytes()) == "");
      CHECK(faults_of_children() > before);
    });
    CHECK(n > 0);
  }
}

TEST_CASE("isolated: a lock that another thread holds when the child begins stays locked there, so the child begins again") {
  std::mutex lock;
  std::atomic<bool> held = false;
  std::thread other([&] {
    const std::lock_guard guard(lock);
    held = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  });
  while (!held) std::this_thread::yield();
  Context context;
  const auto begin = std::chrono::steady_clock::now();
  const Data data = read_isolated(
      small_file(), enough,
      [&](Context&) -> Data {
        const std::lock_guard guard(lock);
        auto t = std::make_shared<Table>();
        t->columns.push_back({"x", Association::whole, Array::from_vector(std::vector<double>{7}), "", Role::none});
        return TablePtr(t);
      },
      context);
  other.join();
  CHECK(std::get<TablePtr>(data)->columns[0].array.get(0) == 7);
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
}
