// SPDX-License-Identifier: Apache-2.0
// XDMF as codes wrote it for versions 1 and 2: older names of elements and attributes, permuted cells, selections, times.
#include <fmt/core.h>

#include "io/io_files.h"

using namespace sg;
using test::contains;
using test::refusal;

namespace {

std::string whole(const std::string& domain, const std::string& head = "") {
  return "<?xml version=\"1.0\"?>\n" + head + "<Xdmf>\n<Domain>\n" + domain + "\n</Domain>\n</Xdmf>\n";
}
DatasetPtr read_old(const std::string& domain, const std::string& head = "") { return test::read_text("old.xmf", whole(domain, head)); }

std::string data(const std::string& dims, const std::string& text, const std::string& more = "DataType=\"Int\"") {
  return "<DataStructure Format=\"XML\" Dimensions=\"" + dims + "\" " + more + ">" + text + "</DataStructure>\n";
}

const std::string corners =
    "<Geometry Type=\"XYZ\">" + data("4 3", "0 0 0 1 0 0 1 1 0 0 1 1", "DataType=\"Float\" Precision=\"8\"") + "</Geometry>\n";
const std::string two_triangles =
    "<Topology Type=\"Triangle\" NumberOfElements=\"2\" BaseOffset=\"1\">" + data("2 3", "1 2 3 1 3 4") + "</Topology>\n";

std::vector<int64_t> points_of_cell(const DatasetPtr& d, size_t cell) {
  const CellsView c = cells_view(d->as<UnstructuredMesh>()->cells);
  std::vector<int64_t> ids;
  for (size_t k = 0; k < c.size(cell); ++k) ids.push_back(c.point(cell, k));
  return ids;
}

std::vector<double> values_of(const DatasetPtr& d, const char* name) {
  const Field& f = d->fields().require(name);
  std::vector<double> v;
  for (size_t i = 0; i < f.array.count(); ++i) v.push_back(f.array.get(i));
  return v;
}

}  // namespace

TEST_CASE("xdmf 1: DataStructure, Type for all kinds, and what is selected by DataTransform") {
  const DatasetPtr d =
      read_old("<Grid Name=\"sphere\">" + two_triangles + corners +
               "<Attribute Type=\"Scalar\" Center=\"Node\" Name=\"x\"><DataTransform Dimensions=\"4 1\" Type=\"HyperSlab\">" +
               data("3 2", "0 0 1 3 4 1", "") +
               "<DataStructure Reference=\"/Xdmf/Domain/Grid/Geometry/DataStructure\"/></DataTransform></Attribute>" +
               "<Attribute Type=\"Scalar\" Center=\"Node\" Name=\"sum\"><DataTransform Dimensions=\"4\" Function=\"$0 + $1\">" +
               data("4", "1 2 3 4", "Type=\"Float\"") + data("4", "10 20 30 40", "Type=\"Int\"") + "</DataTransform></Attribute></Grid>");
  CHECK(d->cell_count() == 2);
  CHECK(points_of_cell(d, 1) == std::vector<int64_t>{0, 2, 3});
  CHECK(d->bounds().hi == Vec3(1, 1, 1));
  CHECK(values_of(d, "x") == std::vector<double>{0, 1, 1, 0});
  CHECK(values_of(d, "sum") == std::vector<double>{11, 22, 33, 44});
}

TEST_CASE("xdmf 2: single values by their coordinates") {
  const auto picked = [](const std::string& places) {
    return "<Grid>" + two_triangles + corners + "<Attribute Name=\"c\"><DataItem ItemType=\"Coordinates\" Dimensions=\"4\">" +
           data("4 2", places, "") + data("2 3", "0 1 2 3 4 5") + "</DataItem></Attribute></Grid>";
  };
  CHECK(values_of(read_old(picked("1 2 0 0 1 0 0 1")), "c") == std::vector<double>{5, 0, 3, 1});
  CHECK(contains(refusal("old.xmf", whole(picked("1 3 0 0 1 0 0 1"))), "selects index 3 of 3"));
  CHECK(contains(refusal("old.xmf", whole(picked("-1 0 0 0 1 0 0 1"))), "negative"));
}

TEST_CASE("xdmf: the order of points in cells, and cells without a list") {
  const auto quad = [](const std::string& more, const std::string& list) {
    return "<Grid><Topology Type=\"Quadrilateral\" NumberOfElements=\"1\" " + more + ">" + list + "</Topology>" + corners + "</Grid>";
  };
  const DatasetPtr turned = read_old(quad("Order=\"3 0 1 2\"", data("1 4", "3 2 1 0")));
  CHECK(points_of_cell(turned, 0) == std::vector<int64_t>{0, 3, 2, 1});
  CHECK(points_of_cell(read_old(quad("", "")), 0) == std::vector<int64_t>{0, 1, 2, 3});
  CHECK(contains(refusal("old.xmf", whole(quad("Order=\"3 0 1 1\"", data("1 4", "3 2 1 0")))), "has Order=\"3 0 1 1\""));
  CHECK(contains(refusal("old.xmf", whole(quad("Order=\"1 0\"", data("1 4", "3 2 1 0")))), "each of 0 to 3 once"));
  CHECK(contains(refusal("old.xmf", whole("<Grid><Topology Type=\"Triangle\" NumberOfElements=\"2\"/>" + corners + "</Grid>")),
                 "4 point ids for 2 cells"));
}

TEST_CASE("xdmf: mixed cells count their points from a base") {
  const DatasetPtr d = read_old("<Grid><Topology Type=\"Mixed\" NumberOfElements=\"2\" BaseOffset=\"1\">" + data("9", "4 1 2 3 2 3 2 3 4") +
                                "</Topology>" + corners + "</Grid>");
  CHECK(points_of_cell(d, 0) == std::vector<int64_t>{0, 1, 2});
  CHECK(points_of_cell(d, 1) == std::vector<int64_t>{1, 2, 3});
}

TEST_CASE("xdmf: any letter case, entities in attributes, and nodes by NumberOfElements") {
  const std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE xdmf SYSTEM \"Xdmf.dtd\" [\n<!ENTITY n \"2\">\n]>\n<xdmf>\n<domain>\n<grid name=\"g\" "
      "gridtype=\"uniform\">\n"
      "<topology topologytype=\"3dcorectmesh\" numberofelements=\"&n; &n; 3\"/>\n<geometry geometrytype=\"origin_dxdydz\">" +
      data("3", "0 0 0") + data("3", "1 1 2") +
      "</geometry>\n<attribute name=\"T\" center=\"cell\"><dataitem format=\"xml\" numbertype=\"uchar\" dimensions=\"1 1 &n;\">7 9"
      "</dataitem></attribute>\n</grid>\n</domain>\n</xdmf>\n";
  const DatasetPtr d = test::read_text("old.dat2", text);
  REQUIRE(d->as<UniformGrid>());
  CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{3, 2, 2});
  CHECK(d->as<UniformGrid>()->spacing.x == 2);
  CHECK(d->fields().require("T", Association::cell).array.type() == ElementType::u8);
  CHECK(values_of(d, "T") == std::vector<double>{7, 9});
}

TEST_CASE("xdmf: times as start, step and count, as a range, as a list in the attribute") {
  const auto times = [](const std::string& time, const std::string& own = "") {
    const std::string grid = "<Grid>" + own + two_triangles + corners + "</Grid>";
    Context context;
    return file_times(test::temp_file("old.xmf", whole("<Grid GridType=\"Collection\" CollectionType=\"temporal\">" + time + grid + grid +
                                                       grid + "</Grid>")),
                      {}, context);
  };
  CHECK(times("<Time Type=\"HyperSlab\">" + data("3", "2 0.5 3", "Type=\"Float\"") + "</Time>") == std::vector<double>{2, 2.5, 3});
  CHECK(times("<Time TimeType=\"Range\">" + data("2", "1 5", "Type=\"Float\"") + "</Time>") == std::vector<double>{1, 3, 5});
  CHECK(times("<Time TimeType=\"list\" Value=\"4 5 7\"/>") == std::vector<double>{4, 5, 7});
  CHECK(times("", "<Time TimeType=\"Range\" Value=\"2 3\"/>") == std::vector<double>{2, 2, 2});
  CHECK(contains(test::error_of([&] { times("<Time TimeType=\"Range\"/>"); }), "has no DataItem"));
}

TEST_CASE("xdmf 1: cut and damaged files are read or refused") {
  const std::string text = whole("<Grid>" + two_triangles + corners +
                                 "<Attribute Type=\"Scalar\" Name=\"c\"><DataItem ItemType=\"Coordinates\" Dimensions=\"4\">" +
                                 data("4 2", "1 2 0 0 1 0 0 1", "") + data("2 3", "0 1 2 3 4 5") + "</DataItem></Attribute></Grid>");
  CHECK(test::cut_and_damage("damaged.xmf", text) >= 62);
}
