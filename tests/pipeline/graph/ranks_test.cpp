// SPDX-License-Identifier: Apache-2.0
// Several ranks, each with its piece, come to what one with the whole comes to.
#include <fmt/format.h>

#include <cmath>

#include "base/all_ranks.h"
#include "data/ranks/over_all.h"
#include "filter/every_mesh.h"
#include "pipeline/graph/graph.h"
#include "scene/choose/scale.h"
#include "support/ranks.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr with_labelled_fields(const DatasetPtr& mesh) {
  DatasetParts parts = mesh->parts();
  const Array xyz = point_positions(mesh->mesh());
  std::vector<float> s, v;
  std::vector<int32_t> labels;
  for (size_t i = 0; i < mesh->point_count(); ++i) {
    const double x = xyz.get(i, 0), y = xyz.get(i, 1), z = xyz.get(i, 2);
    s.push_back(float(i == 17 ? NAN : std::sin(5 * x) * y - 0.8 * z));
    for (const double k : {x, y * y, -z}) v.push_back(float(k));
    labels.push_back(int32_t(std::lround(2 + x + y)));
  }
  std::vector<double> c(mesh->cell_count());
  for (size_t i = 0; i < c.size(); ++i) c[i] = std::cos(double(i * i));
  parts.fields.add({"s", Association::point, Array::from_vector(std::move(s)), "", Role::scalars});
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  parts.fields.add({"labels", Association::point, Array::from_vector(std::move(labels)), "", Role::labels});
  parts.fields.add({"c", Association::cell, Array::from_vector(std::move(c)), "", Role::none});
  return make_dataset(std::move(parts));
}

std::vector<DatasetPtr> shared_meshes() {
  std::vector<DatasetPtr> r;
  for (const MeshKind& k : every_mesh())
    for (const char* name : {"uniform", "tetra", "polyhedron"})
      if (k.name == name) r.push_back(with_labelled_fields(k.make(5, 1)));
  UniformGrid few;  // fewer cells than ranks: some have none
  few.dims = {4, 2, 2};
  r.push_back(with_labelled_fields(make_dataset(Mesh(few))));
  return r;
}

// The result of one operation for each rank; every rank has a graph of its own, as processes have.
std::vector<Data> on_pieces(const DatasetPtr& mesh, const char* operation, const std::vector<std::string>& words, int ranks) {
  std::vector<Data> results(static_cast<size_t>(ranks));
  on_ranks(ranks, [&](int rank, Context& context) {
    Graph g;
    const NodeId node = g.add_operation(operation, words, {g.add_data(mesh)});
    Request piece;
    piece.piece = rank, piece.pieces = ranks;
    results[size_t(rank)] = g.evaluate(node, piece, context);
  });
  return results;
}

Data on_whole(const DatasetPtr& mesh, const char* operation, const std::vector<std::string>& words) {
  Graph g;
  Context context;
  return g.evaluate(g.add_operation(operation, words, {g.add_data(mesh)}), {}, context);
}

std::string difference(const Table& a, const Table& b, double relative) {
  if (a.columns.size() != b.columns.size()) return "columns";
  for (size_t c = 0; c < a.columns.size(); ++c) {
    const Array &x = a.columns[c].array, &y = b.columns[c].array;
    if (x.count() != y.count()) return fmt::format("{} rows, not {}", y.count(), x.count());
    const std::string& name = a.columns[c].name;
    const bool exact = name == "count" || name == "missing" || name == "min" || name == "max" || name == "median" || name == "lo" ||
                       name == "hi" || name.starts_with("quartile");
    for (size_t i = 0; i < x.count(); ++i) {
      const double p = x.get(i), q = y.get(i);
      if (std::isnan(p) && std::isnan(q)) continue;
      if (exact ? p != q : std::abs(p - q) > relative * (1 + std::abs(p))) return fmt::format("{} of row {} is {}, not {}", name, i, q, p);
    }
  }
  return "";
}

}  // namespace

TEST_CASE("ranks: sums, extremes and lists of all are the same on every rank, and alone one's own") {
  CHECK(all_sum(3.5, nullptr) == 3.5);
  CHECK(all_concatenated(std::span<const int>(std::vector<int>{1, 2}), nullptr) == std::vector<int>{1, 2});
  on_ranks(3, [](int rank, Context& context) {
    const Communicator* c = context.communicator;
    CHECK(all_sum(int64_t(rank + 1), c) == 6);
    CHECK(all_least(double(rank), c) == 0);
    CHECK(all_most(double(rank), c) == 2);
    const std::vector<int> mine(size_t(rank), rank);
    CHECK(all_concatenated(std::span<const int>(mine), c) == std::vector<int>{1, 2, 2});
    CHECK(over_all(rank == 1 ? Range{} : Range{double(rank), rank + 1.0}, context) == Range{0, 3});
    CHECK(over_all(rank == 1 ? Box3{} : Box3{{0, double(rank), 0}, {1, 5, 1}}, context) == Box3{{0, 0, 0}, {1, 5, 1}});
  });
  CHECK_THROWS_AS(on_ranks(2,
                           [](int rank, Context& context) {
                             if (rank == 1) fail_data("broken", "rank");
                             all_sum(1, context.communicator);
                           }),
                  Error);
}

TEST_CASE("ranks: statistics, histograms and integrals of pieces are those of the whole, on every rank") {
  for (const DatasetPtr& mesh : shared_meshes())
    for (const auto& [name, words] : {std::pair<const char*, std::vector<std::string>>{"statistics", {}},
                                      {"histogram", {"field=s", "bins=7"}},
                                      {"histogram", {"field=c", "bins=5"}},
                                      {"integrate", {}}}) {
      const TablePtr whole = std::get<TablePtr>(on_whole(mesh, name, words));
      for (const int ranks : {1, 2, 3, 7}) {
        CAPTURE(name);
        CAPTURE(mesh->kind());
        CAPTURE(ranks);
        for (const Data& one : on_pieces(mesh, name, words, ranks)) CHECK(difference(*whole, *std::get<TablePtr>(one), 1e-12) == "");
      }
    }
}

TEST_CASE("ranks: isovalues, bands, planes and thresholds that nobody states are chosen from all pieces") {
  for (const DatasetPtr& mesh : shared_meshes())
    for (const auto& [name, words] : {std::pair<const char*, std::vector<std::string>>{"contour", {"field=s"}},
                                      {"clip", {"field=s"}},
                                      {"clip", {}},
                                      {"slice", {}},
                                      {"otsu", {"field=s"}}}) {
      CAPTURE(name);
      CAPTURE(mesh->kind());
      Context context;
      Graph g;
      const auto size = [&](const Data& d) {
        const DatasetPtr set = single_dataset(d, "test");
        if (set->cell_count() == 0) return 0.0;
        const TablePtr t = std::get<TablePtr>(on_whole(set, "integrate", {}));
        return t->columns[3].array.get(0);
      };
      const Data whole = on_whole(mesh, name, words);
      for (const int ranks : {1, 2, 3, 7}) {
        double all = 0;
        for (const Data& one : on_pieces(mesh, name, words, ranks)) {
          all += size(one);
          if (std::string_view(name) == "otsu")
            CHECK(single_dataset(one, "test")->fields().require("otsu thresholds").array.get(0) ==
                  single_dataset(whole, "test")->fields().require("otsu thresholds").array.get(0));
        }
        CHECK(all == doctest::Approx(size(whole)).epsilon(1e-6));
      }
    }
}

TEST_CASE("ranks: the colours of a field are the same on every rank as those of the whole") {
  for (const DatasetPtr& mesh : shared_meshes())
    for (const char* name : {"s", "v", "labels", "c"}) {
      Context alone;
      const ColorScale whole = choose_scale(*mesh, mesh->fields().require(name), {}, alone);
      for (const int ranks : {1, 2, 3, 7})
        on_ranks(ranks, [&](int rank, Context& context) {
          Graph g;
          Request piece;
          piece.piece = rank, piece.pieces = ranks;
          const DatasetPtr d = single_dataset(g.evaluate(g.add_data(mesh), piece, context), "test");
          const ColorScale s = choose_scale(*d, d->fields().require(name), {}, context);
          CHECK(s.lo == whole.lo);
          CHECK(s.hi == whole.hi);
          CHECK(s.labels == whole.labels);
          CHECK(s.map.name == whole.map.name);
        });
    }
}

TEST_CASE("ranks: what needs the whole is made by each rank alone, and counted once") {
  const DatasetPtr mesh = shared_meshes()[0];
  on_ranks(3, [&](int rank, Context& context) {
    Graph g;
    const NodeId table = g.add_operation("integrate", {}, {g.add_data(mesh)});
    const NodeId node = g.add_operation("table_to_points", {"x=integral", "y=mean"}, {table});  // it needs the whole table
    Request piece;
    piece.piece = rank, piece.pieces = 3;
    const DatasetPtr points = single_dataset(g.evaluate(node, piece, context), "test");
    const Field& measure = points->fields().require("measure");
    for (size_t i = 0; i < points->point_count(); ++i) CHECK(measure.array.get(i) == doctest::Approx(8));
  });
}
