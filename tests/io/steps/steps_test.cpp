// SPDX-License-Identifier: Apache-2.0
// Series written step by step.
#include "io/steps/steps.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "io/io_files.h"

using namespace sg;

namespace {

constexpr const char* grids[] = {"a_{n}.vti", "a.pvd", "a.ome.zarr", "a.vtkhdf"};

/// The name under which it is read.
std::string read_as(const std::string& path) {
  const size_t at = path.find("_{n}");
  return at == path.npos ? path : path.substr(0, at) + path.substr(at + 4) + ".series";
}

// 7 x 5 x 3 points whose field "p" is x + 10 t.
DatasetPtr grid_at(double t) {
  UniformGrid g;
  g.dims = {7, 5, 3};
  g.origin = {1, 2, 3}, g.spacing = {0.5, 0.25, 2};
  std::vector<float> p;
  for (size_t i = 0; i < 105; ++i) p.push_back(float(double(i % 7) * 0.5 + 10 * t));
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"p", Association::point, Array::from_vector(std::move(p)), "K", Role::scalars});
  return make_dataset(std::move(parts));
}

// Points along a line, one more for each step, in a cell each where `cells`; a point field, a cell field.
DatasetPtr growing(size_t n, bool cells) {
  std::vector<float> xyz;
  std::vector<double> s, c;
  std::vector<int32_t> ids, starts{0};
  for (size_t i = 0; i < n; ++i) {
    xyz.insert(xyz.end(), {float(i), 0, 0}), s.push_back(double(i * n)), c.push_back(double(n) - double(i));
    if (i + 1 < n) ids.insert(ids.end(), {int32_t(i), int32_t(i) + 1}), starts.push_back(int32_t(ids.size()));
  }
  DatasetParts parts;
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  if (cells) m.lines.connectivity = Array::from_vector(std::move(ids)), m.lines.offsets = Array::from_vector(std::move(starts));
  if (cells) c.resize(n - 1), parts.fields.add({"c", Association::cell, Array::from_vector(std::move(c)), "", Role::none});
  parts.fields.add({"s", Association::point, Array::from_vector(std::move(s)), "m", Role::none});
  if (cells) parts.mesh = std::move(m);
  else parts.mesh = PointCloud{std::move(m.points)};
  return make_dataset(std::move(parts));
}

std::vector<double> times_of(const std::string& path) {
  Context context;
  return file_times(path, {}, context);
}
DatasetPtr step_of(const std::string& path, int64_t step) {
  ReadOptions o;
  o.step = step;
  return test::read_file(path, o);
}

}  // namespace

TEST_CASE("steps: what was added can be read at once, and is what was written") {
  for (const char* name : grids) {
    CAPTURE(name);
    const std::string path = test::fresh_folder("steps_added") + name;
    Context context;
    const auto writer = write_steps(path, {{0.5, 1, 1.5}, "r", false}, {}, context);
    CHECK(writer->done() == 0);
    for (size_t k = 0; k < 3; ++k) {
      writer->add(grid_at(0.5 + 0.5 * double(k)), context);
      CHECK(times_of(read_as(path)).size() == k + 1);
    }
    writer->finish();
    CHECK(times_of(read_as(path)) == std::vector<double>{0.5, 1, 1.5});
    for (size_t k = 0; k < 3; ++k) {
      const DatasetPtr d = step_of(read_as(path), int64_t(k)), expected = grid_at(0.5 + 0.5 * double(k));
      CHECK(d->time() == 0.5 + 0.5 * double(k));
      CHECK(d->bounds() == expected->bounds());
      CHECK(test::same_array(d->fields().require("p").array, expected->fields().require("p").array));
    }
  }
}

TEST_CASE("steps: a writer that is killed leaves its steps, and the next one goes on behind them") {
  for (const char* name : grids) {
    CAPTURE(name);
    const std::string path = test::fresh_folder("steps_killed") + name;
    const StepsPlan plan{{0, 1, 2, 3}, "r", false};
    // Its plug-in and its threads are the parent's: it must be there before.
    Context context;
    write_steps(test::fresh_folder("steps_before") + name, {{0}, "", false}, {}, context)->add(grid_at(0), context);
    const pid_t child = ::fork();
    if (child == 0) {
      set_thread_count(1);
      const auto writer = write_steps(path, plan, {}, context);
      writer->add(grid_at(0), context), writer->add(grid_at(1), context);
      ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));
    CHECK(times_of(read_as(path)) == std::vector<double>{0, 1});
    StepsPlan on = plan;
    on.resume = true;
    const auto writer = write_steps(path, on, {}, context);
    REQUIRE(writer->done() == 2);
    writer->add(grid_at(2), context), writer->add(grid_at(3), context);
    writer->finish();
    CHECK(times_of(read_as(path)) == std::vector<double>{0, 1, 2, 3});
    for (int k = 0; k < 4; ++k)
      CHECK(test::same_array(step_of(read_as(path), k)->fields().require("p").array, grid_at(k)->fields().require("p").array));
  }
}

TEST_CASE("steps: another series is not gone on with, and a longer plan is") {
  for (const char* name : grids) {
    CAPTURE(name);
    const std::string path = test::fresh_folder("steps_other") + name;
    Context context;
    {
      const auto writer = write_steps(path, {{0, 1}, "r", true}, {}, context);  // nothing is there yet
      writer->add(grid_at(0), context), writer->add(grid_at(1), context);
      writer->finish();
    }
    CHECK_THROWS_AS(write_steps(path, {{0, 1}, "s", true}, {}, context), Error);
    CHECK_THROWS_AS(write_steps(path, {{0, 2}, "r", true}, {}, context), Error);
    CHECK_THROWS_AS(write_steps(path, {{0}, "r", true}, {}, context), Error);
    CHECK(times_of(read_as(path)) == std::vector<double>{0, 1});
    CHECK(write_steps(path, {{0, 1, 2}, "r", true}, {}, context)->done() == 2);
    CHECK(write_steps(path, {{0, 1}, "r", false}, {}, context)->done() == 0);
  }
}

TEST_CASE("steps: meshes that change from step to step") {
  for (const char* name : {"a_{n}.vtp", "a.pvd", "a.vtkhdf"})
    for (const bool cells : {true, false}) {
      CAPTURE(name);
      CAPTURE(cells);
      const std::string path = test::fresh_folder("steps_meshes") + name;
      Context context;
      const auto writer = write_steps(path, {{0, 1, 2, 3}, "r", false}, {}, context);
      // One stays as it is: its cells are stored once.
      const size_t sizes[] = {4, 7, 7, 2};
      for (const size_t n : sizes) writer->add(growing(n, cells), context);
      writer->finish();
      for (size_t k = 0; k < 4; ++k) {
        const DatasetPtr d = step_of(read_as(path), int64_t(k)), expected = growing(sizes[k], cells);
        REQUIRE(d->point_count() == sizes[k]);
        if (cells) CHECK(d->cell_count() == expected->cell_count());
        CHECK(d->bounds() == expected->bounds());
        for (const Field& f : expected->fields()) CHECK(test::same_array(d->fields().require(f.name).array, f.array));
      }
    }
}

TEST_CASE("steps: what a series cannot hold") {
  const std::string folder = test::fresh_folder("steps_refused");
  Context context;
  CHECK_THROWS_WITH_AS(write_steps(folder + "a.ply", {{0, 1}, "", false}, {}, context), doctest::Contains("a_{n}.ply"), Error);
  CHECK_THROWS_AS(write_steps(folder + "a.pvd", {{}, "", false}, {}, context), Error);
  CHECK_THROWS_WITH_AS(write_steps(folder + "a.pvd", {{1, 1}, "", false}, {}, context), doctest::Contains("comes after"), Error);
  CHECK_THROWS_WITH_AS(write_steps(folder + "a.ome.zarr", {{0, 1, 3}, "", false}, {}, context), doctest::Contains("far apart"), Error);
  CHECK_THROWS_AS(write_steps(folder + "a_{n}.nothing", {{0}, "", false}, {}, context), Error);
  // A field that comes later.
  const auto writer = write_steps(folder + "a.vtkhdf", {{0, 1}, "", false}, {}, context);
  writer->add(growing(3, false), context);
  CHECK_THROWS_AS(writer->add(growing(3, true), context), Error);
}

TEST_CASE("steps: an index of numbered files, as others write it") {
  const std::string folder = test::fresh_folder("steps_index");
  Context context;
  write_data(folder + "b.vti", grid_at(1), {}, context);
  write_data(folder + "c.vti", grid_at(2), {}, context);
  write_file(folder + "x.vti.series",
             R"({"file-series-version": "1.0", "files": [{"name": "b.vti", "time": 0.25}, {"name": "c.vti", "time": 8}]})");
  CHECK(times_of(folder + "x.vti.series") == std::vector<double>{0.25, 8});
  CHECK(step_of(folder + "x.vti.series", 1)->fields().require("p").array.get(0) == 20);
  write_file(folder + "y.vti.series", R"({"file-series-version": "1.0", "files": ["b.vti", "c.vti"]})");
  CHECK(times_of(folder + "y.vti.series") == std::vector<double>{0, 1});
  for (const char* bad : {R"({"file-series-version": "1.0"})", R"({"file-series-version": "1.0", "files": [{"time": 1}]})",
                          R"({"file-series-version": "1.0", "files": ["z.vti.series"]})", R"({"file-series-version")"}) {
    write_file(folder + "z.vti.series", bad);
    CHECK_THROWS_AS(test::read_file(folder + "z.vti.series"), Error);
  }
}
