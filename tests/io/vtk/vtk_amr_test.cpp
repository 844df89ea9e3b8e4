// SPDX-License-Identifier: Apache-2.0
// Overlapping AMR of VTK: boxes, refined cells, the old dialect, and writing.
#include "io/vtk/vtk_amr.h"
#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

namespace {

AmrGrid two_levels(int dimension = 3) {
  AmrGrid g;
  g.dimension = dimension;
  g.origin = {1, -2, 0.5};
  const long long top = dimension == 3 ? 3 : 0;
  AmrGrid::Level coarse, fine;
  coarse.spacing = {1, 0.5, 2}, coarse.ratio = {1, 1, 1};
  fine.spacing = {0.5, 0.25, dimension == 3 ? 1.0 : 2.0}, fine.ratio = {2, 2, dimension == 3 ? 2 : 1};
  coarse.patches.push_back({{0, 0, 0}, {3, 3, top}, 0, 0});
  const size_t cells = dimension == 3 ? 64 : 16, points = dimension == 3 ? 125 : 25;
  // Coarse cells 1..2 along each axis are covered; of cell 3 along x only a half.
  fine.patches.push_back({{2, 2, dimension == 3 ? 2 : 0}, {6, 5, dimension == 3 ? 5 : 0}, cells, points});
  g.levels = {coarse, fine};
  return g;
}

DatasetPtr amr(int dimension = 3) {
  DatasetParts p;
  p.mesh = two_levels(dimension);
  const size_t cells = cell_count(p.mesh), points = point_count(p.mesh);
  p.fields.add({"rho", Association::cell, ramp<double>(cells, 1, 0.25), {}, Role::none});
  p.fields.add({"u", Association::point, ramp<float>(points, 3), {}, Role::none});
  p.cell_ghost = vtk::refined_cells(std::get<AmrGrid>(p.mesh));
  return make_dataset(std::move(p));
}

void write_patch(const std::string& name, std::array<size_t, 3> dims, Vec3 spacing, Vec3 origin) {
  DatasetParts p;
  UniformGrid g;
  g.dims = dims, g.spacing = spacing, g.origin = origin;
  p.mesh = g;
  p.fields.add({"rho", Association::cell, ramp<double>(cell_count(p.mesh)), {}, Role::none});
  write(temp(name), make_dataset(std::move(p)));
}

}  // namespace

TEST_CASE("amr: cells that the next level covers wholly are refined, half covered ones are not") {
  for (const int dimension : {2, 3}) {
    const AmrGrid g = two_levels(dimension);
    const Array ghost = vtk::refined_cells(g);
    CHECK(ghost.count() == cell_count(Mesh(g)));
    size_t refined = 0;
    for (size_t k = 0; k < (dimension == 3 ? 4 : 1); ++k)
      for (size_t j = 0; j < 4; ++j)
        for (size_t i = 0; i < 4; ++i) {
          const bool inside = i >= 1 && i <= 2 && j >= 1 && j <= 2 && (dimension == 2 || (k >= 1 && k <= 2));
          CHECK(ghost.get(i + 4 * (j + 4 * k)) == (inside ? ghost_refined_cell : 0));
          refined += inside;
        }
    CHECK(refined == (dimension == 3 ? 8 : 4));
    for (size_t i = dimension == 3 ? 64 : 16; i < ghost.count(); ++i) CHECK(ghost.get(i) == 0);
  }
}

TEST_CASE("amr: levels, boxes, fields and ghosts come back as they were written, in two and three dimensions") {
  Context context;
  for (const int dimension : {2, 3}) {
    const DatasetPtr d = amr(dimension);
    write_data(temp("amr.vthb"), d, {VtkEncoding::appended, Compression::zlib}, context);
    const Data data = read_any(temp("amr.vthb"));
    const DatasetPtr back = std::get<DatasetPtr>(data);
    const auto *a = d->as<AmrGrid>(), *b = back->as<AmrGrid>();
    REQUIRE(b);
    CHECK(b->dimension == dimension);
    CHECK(a->origin == b->origin);
    REQUIRE(b->levels.size() == 2);
    for (size_t l = 0; l < 2; ++l) {
      CHECK(a->levels[l].spacing == b->levels[l].spacing);
      CHECK(a->levels[l].ratio == b->levels[l].ratio);
      REQUIRE(a->levels[l].patches.size() == b->levels[l].patches.size());
      CHECK(a->levels[l].patches[0].lo == b->levels[l].patches[0].lo);
      CHECK(a->levels[l].patches[0].hi == b->levels[l].patches[0].hi);
      CHECK(a->levels[l].patches[0].point_offset == b->levels[l].patches[0].point_offset);
    }
    CHECK(same(d->fields().require("rho").array, back->fields().require("rho").array));
    CHECK(same(d->fields().require("u").array, back->fields().require("u").array));
    CHECK(same(d->cell_ghost(), back->cell_ghost()));
  }
  CHECK(error_of([&] { write_data(temp("no.vthb"), samples()[0].dataset, {}, context); }).find("*.vti") != std::string::npos);
  CHECK(error_of([&] { write_data(temp("no.vti"), amr(), {}, context); }).find("*.vthb") != std::string::npos);
}

TEST_CASE("amr: the dialect before version 1.0 reads: groups, refinement ratios, no spacing") {
  write_patch("old_0.vti", {5, 5, 5}, {1, 1, 1}, {0, 0, 0});
  write_patch("old_1.vti", {5, 5, 5}, {0.25, 0.25, 0.25}, {1, 1, 1});
  write_file(temp("old.vtm"),
             "<VTKFile type=\"vtkHierarchicalBoxDataSet\" version=\"0.1\"><vtkHierarchicalBoxDataSet>"
             "<RefinementRatio level=\"0\" refinement=\"4\"/>"
             "<DataSet group=\"0\" dataset=\"0\" amr_box=\"0 3 0 3 0 3\" file=\"old_0.vti\"/>"
             "<DataSet group=\"1\" dataset=\"0\" amr_box=\"4 7 4 7 4 7\" file=\"old_1.vti\"/>"
             "</vtkHierarchicalBoxDataSet></VTKFile>");
  const Data data = read_any(temp("old.vtm"));
  const DatasetPtr d = std::get<DatasetPtr>(data);
  const auto* g = d->as<AmrGrid>();
  REQUIRE(g);
  CHECK(g->levels[1].ratio == std::array<int, 3>{4, 4, 4});
  CHECK(g->origin == Vec3(0, 0, 0));
  CHECK(d->cell_ghost().get(21) == ghost_refined_cell);
  CHECK(d->cell_ghost().get(20) == 0);
}

TEST_CASE("amr: boxes that do not fit, odd ratios and missing patches are refused") {
  write_patch("ok.vti", {5, 5, 5}, {1, 1, 1}, {0, 0, 0});
  write_patch("fine.vti", {5, 5, 5}, {0.4, 0.4, 0.4}, {0, 0, 0});
  write(temp("tri.vti"), samples()[0].dataset);
  auto error = [&](const std::string& body) {
    write_file(temp("bad.vthb"),
               "<VTKFile type=\"vtkOverlappingAMR\" version=\"1.1\"><vtkOverlappingAMR origin=\"0 0 0\" "
               "grid_description=\"XYZ\">" +
                   body + "</vtkOverlappingAMR></VTKFile>");
    return error_of([&] { read_any(temp("bad.vthb")); });
  };
  auto block = [](int level, const std::string& box, const std::string& file) {
    return "<Block level=\"" + std::to_string(level) + "\" spacing=\"1 1 1\"><DataSet index=\"0\" amr_box=\"" + box + "\" file=\"" + file +
           "\"/></Block>";
  };
  CHECK(error(block(0, "0 4 0 3 0 3", "ok.vti")).find("ok.vti") != std::string::npos);
  CHECK(error(block(0, "0 3 0 3 0 3", "gone.vti")).find("gone.vti") != std::string::npos);
  CHECK(error(block(0, "0 3 0 3", "ok.vti")).find("amr_box") != std::string::npos);
  CHECK(error(block(0, "0 9223372036854775807 0 3 0 3", "ok.vti")).find("amr_box") != std::string::npos);
  CHECK(error(block(0, "-9223372036854775808 3 0 3 0 3", "ok.vti")).find("amr_box") != std::string::npos);
  CHECK(error(block(99, "0 3 0 3 0 3", "ok.vti")).find("level 99") != std::string::npos);
  CHECK(error(block(0, "0 3 0 3 0 3", "ok.vti") + block(1, "0 3 0 3 0 3", "fine.vti")).find("2.5") != std::string::npos);
  CHECK(error(block(0, "0 2 0 1 0 0", "tri.vti")).find("tri.vti") != std::string::npos);
}

TEST_CASE("amr: a file cut or changed anywhere reads or gives an Error") {
  Context context;
  write_data(temp("amrcut.vthb"), amr(), {VtkEncoding::appended, Compression::none}, context);
  const std::string text(MappedFile(temp("amrcut.vthb")).text());
  size_t errors = 0;
  auto attempt = [&](const std::string& t) {
    write_file(temp("amrcut.vthb"), t);
    try {
      read_any(temp("amrcut.vthb"));
    } catch (const Error& e) {
      ++errors;
      CHECK(e.kind() == ErrorKind::data);
    }
  };
  for (size_t i = 1; i < 64; ++i) attempt(text.substr(0, text.size() * i / 64));
  CHECK(errors == 63);
  for (size_t i = 0; i < text.size(); ++i)
    for (const int flip : {1, 0x10, 0x80}) {
      std::string bent = text;
      bent[i] = char(bent[i] ^ flip);
      attempt(bent);
    }
  CHECK(errors > 300);
}

TEST_CASE("amr: the real box dataset has the levels and ranges that VTK reports" * doctest::skip(no_data())) {
  const Data data = read_any(data_file("meshes/amr/HierarchicalBoxDataset/HierarchicalBoxDataset.v1.1.vthb"));
  const DatasetPtr d = std::get<DatasetPtr>(data);
  const auto* g = d->as<AmrGrid>();
  REQUIRE(g);
  REQUIRE(g->levels.size() == 4);
  const size_t boxes[] = {1, 8, 40, 32};
  for (size_t l = 0; l < 4; ++l) CHECK(g->levels[l].patches.size() == boxes[l]);
  CHECK(d->cell_count() == 2556);
  CHECK(g->levels[0].spacing.x == 0.83333331347);
  for (size_t i = 0; i < 36; ++i) CHECK(d->cell_ghost().get(i) == ghost_refined_cell);  // all of level 0
  const FieldStats all = field_stats(d->fields().require("TestX").array);
  CHECK(all.range[0].hi == doctest::Approx(1.9999998807907104).epsilon(1e-12));
  const Data old = read_any(data_file("meshes/amr/chombo3d/chombo3d.vtm"));
  const DatasetPtr chombo = std::get<DatasetPtr>(old);
  REQUIRE(chombo->as<AmrGrid>());
  CHECK(chombo->as<AmrGrid>()->levels.size() == 3);
  CHECK(chombo->bounds().hi == Vec3(8, 8, 8));
}
