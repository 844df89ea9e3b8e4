// SPDX-License-Identifier: Apache-2.0
// Orders of Lagrange and Bezier cells and rational weights, in XML and legacy files; surfaces and clouds as unstructured grids.
#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string bezier(const std::string& point_data, const std::string& cell_data) {
  return vtu("<Piece NumberOfPoints=\"6\" NumberOfCells=\"1\">" + point_data + cell_data +
             "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 2 0 0 2 1 0 0 1 0 1 0 0 1 1 0</DataArray>"
             "</Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 4 5</DataArray>"
             "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">6</DataArray>"
             "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">77</DataArray></Cells></Piece>");
}

const std::string weights =
    "<PointData RationalWeights=\"w\"><DataArray type=\"Float32\" Name=\"w\" format=\"ascii\">1 1 1 1 0.5 2</DataArray></PointData>";
std::string degrees(const std::string& numbers) {
  return "<CellData HigherOrderDegrees=\"d\"><DataArray type=\"Float64\" Name=\"d\" NumberOfComponents=\"3\" format=\"ascii\">" + numbers +
         "</DataArray></CellData>";
}

}  // namespace

TEST_CASE("vtk xml: orders and weights shape the mesh and stay fields") {
  for (const bool others : {false, true}) {
    ReadOptions o;
    if (others) o.fields = {"something else"};
    const DatasetPtr d = read_text("bezier.vtu", bezier(weights, degrees("2 1 1")), o);
    const auto* m = d->as<UnstructuredMesh>();
    REQUIRE(m);
    CHECK(same(m->weights, numbers<double>({1, 1, 1, 1, 0.5, 2})));
    CHECK(same(m->degrees, numbers<uint8_t>({2, 1, 1}, 3)));
    CHECK(d->fields().find("w", Association::point));
    CHECK(d->fields().find("d", Association::cell));
    write(temp("bezier again.vtu"), d);
    const DatasetPtr again = read(temp("bezier again.vtu"));
    const auto* n = again->as<UnstructuredMesh>();
    CHECK(same(m->weights, n->weights));
    CHECK(same(m->degrees, n->degrees));
  }
  auto error = [&](const std::string& text) { return error_of([&] { read_text("bezier.vtu", text); }); };
  CHECK(error(bezier(weights, degrees("2 1.5 1"))).find("order 1.5") != std::string::npos);
  CHECK(error(bezier(weights, degrees("2 -1 1"))).find("order -1") != std::string::npos);
  CHECK(error(bezier(weights, degrees("2 nan 1"))).find("order") != std::string::npos);
  CHECK(error(bezier("<PointData RationalWeights=\"w\"><DataArray type=\"Float32\" Name=\"w\" format=\"ascii\">1 1 1 inf 0.5 2</DataArray>"
                     "</PointData>",
                     ""))
            .find("finite") != std::string::npos);
  CHECK(error(bezier(
                  "<PointData RationalWeights=\"w\"><DataArray type=\"UInt8\" NumberOfComponents=\"2\" Name=\"w\" format=\"ascii\">1 1 1 1 "
                  "1 1 1 1 1 1 1 1</DataArray></PointData>",
                  ""))
            .find("2 components") != std::string::npos);
}

TEST_CASE("vtk legacy: arrays with the names of orders and weights shape the mesh") {
  const DatasetPtr d =
      read_text("bezier.vtk",
                "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 float\n0 0 0 2 0 0 2 1 0 0 1 0 1 0 0 1 1 "
                "0\nCELLS 1 7\n6 0 1 "
                "2 3 4 5\nCELL_TYPES 1\n77\nPOINT_DATA 6\nFIELD f 1\nRationalWeights 1 6 double\n1 1 1 1 0.5 2\nCELL_DATA 1\nFIELD f "
                "1\nHigherOrderDegrees 3 1 int\n2 1 1\n");
  const auto* m = d->as<UnstructuredMesh>();
  REQUIRE(m);
  CHECK(same(m->weights, numbers<double>({1, 1, 1, 1, 0.5, 2})));
  CHECK(same(m->degrees, numbers<uint8_t>({2, 1, 1}, 3)));
}

TEST_CASE("vtk xml: surfaces and clouds are written as unstructured grids too") {
  DatasetParts p;
  p.mesh = surface_mesh();
  p.fields.add({"k", Association::cell, ramp<int32_t>(8), {}, Role::none});
  const DatasetPtr s = make_dataset(p);
  write(temp("surface.vtu"), s);
  const DatasetPtr u = read(temp("surface.vtu"));
  const auto* m = u->as<UnstructuredMesh>();
  REQUIRE(m);
  CHECK(m->cells.size() == 8);
  const CellType types[] = {CellType::vertex, CellType::vertex,   CellType::vertex, CellType::poly_line,
                            CellType::line,   CellType::triangle, CellType::quad,   CellType::triangle_strip};
  for (size_t i = 0; i < 8; ++i) CHECK(m->type(i) == types[i]);
  CHECK(cells_view(m->cells).point(6, 3) == 6);
  CHECK(cell_type_counts(s->mesh()) == cell_type_counts(u->mesh()));
  CHECK(same(s->fields().require("k").array, u->fields().require("k").array));

  PointCloud cloud;
  cloud.points.xyz = ramp<float>(5, 3);
  cloud.points.origin = {1e7, 0, 0};
  write(temp("cloud.vtu"), make_dataset(cloud));
  const DatasetPtr c = read(temp("cloud.vtu"));
  CHECK(c->as<UnstructuredMesh>()->single_type == CellType::vertex);
  CHECK(c->cell_count() == 5);
  CHECK(c->as<UnstructuredMesh>()->points.at(4) == Vec3(1e7 + 12, 13, 14));
  write(temp("cloud.vtp"), make_dataset(cloud));
  CHECK(read(temp("cloud.vtp"))->as<SurfaceMesh>()->vertices.size() == 5);
}

TEST_CASE("vtk xml: units of fields go into the file and come back, in every encoding") {
  DatasetParts p;
  p.mesh = tetra_mesh(90);
  p.fields.add({"T", Association::point, ramp<float>(93), "K", Role::none});
  p.fields.add({"q", Association::cell, ramp<double>(90, 3), "W/m<2> & \"more\"", Role::none});
  p.fields.add({"whole", Association::whole, numbers<double>({1, 2}), "s", Role::none});
  p.fields.add({"plain", Association::cell, ramp<double>(90), {}, Role::none});
  const DatasetPtr d = make_dataset(p);
  for (const WriteOptions& o : every_option) {
    CAPTURE(std::string(word_of(o.encoding)));
    CAPTURE(std::string(word_of(*o.compression)));
    write(temp("units.vtu"), d, o);
    const DatasetPtr back = read(temp("units.vtu"));
    for (const Field& f : d->fields()) {
      CHECK(back->fields().require(f.name).unit == f.unit);
      CHECK(same(back->fields().require(f.name).array, f.array));
    }
  }
}
