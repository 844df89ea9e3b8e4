// SPDX-License-Identifier: Apache-2.0
// OpenFOAM: one mesh of every shape, written as text and as bytes of every width and order; patches, times, processors, bad input.
#include <fmt/core.h>

#include <algorithm>

#include "case_files.h"
#include "data/cells/cell_topology.h"
#include "io/bytes/inflate.h"
#include "io/openfoam/foam_field.h"
#include "io/openfoam/foam_file.h"

using namespace sg;
using namespace sg::test;

namespace {

struct FoamWriting {
  bool binary = false;
  int label = 4, scalar = 8;
  bool big = false;
};

std::string header(const FoamWriting& w, const std::string& type, const std::string& object) {
  std::string s = "/* a comment { */\nFoamFile\n{\n    version 2.0;\n    format " + std::string(w.binary ? "binary" : "ascii") + ";\n";
  if (w.binary) s += fmt::format("    arch \"{};label={};scalar={}\";\n", w.big ? "MSB" : "LSB", w.label * 8, w.scalar * 8);
  return s + "    class " + type + ";\n    object " + object + ";\n}\n// * * * //\n\n";
}

void put_label(std::string& s, int64_t v, const FoamWriting& w) {
  if (w.label == 8) put_bytes(s, v, w.big);
  else put_bytes(s, int32_t(v), w.big);
}

std::string label_list(const std::vector<int>& v, const FoamWriting& w) {
  std::string s = fmt::format("{}\n(", v.size());
  for (const int x : v)
    if (w.binary) put_label(s, x, w);
    else s += fmt::format("\n{}", x);
  return s + (w.binary ? ")" : "\n)") + "\n";
}

std::string tuple_list(const std::vector<double>& v, size_t k, const FoamWriting& w) {
  std::string s = fmt::format("{}\n(", v.size() / k);
  for (size_t i = 0; i < v.size(); ++i) {
    if (w.binary) {
      if (w.scalar == 8) put_bytes(s, v[i], w.big);
      else put_bytes(s, float(v[i]), w.big);
      continue;
    }
    if (i % k == 0) s += k > 1 ? "\n(" : "\n";
    else s += ' ';
    s += fmt::format("{}", v[i]);
    if (k > 1 && i % k == k - 1) s += ')';
  }
  return s + (w.binary ? ")" : "\n)") + "\n";
}

/// Cells as outward faces; faces of two cells become inner ones.
struct Shape {
  std::vector<double> points;
  std::vector<std::vector<int>> faces;
  std::vector<int> owner, neighbour;
  int cells = 0;

  explicit Shape(const std::vector<std::vector<std::vector<int>>>& solids) {
    std::map<std::vector<int>, std::pair<int, std::vector<int>>> seen;
    std::vector<std::vector<int>> inner, outer;
    std::vector<int> inner_owner, outer_owner;
    for (const auto& solid : solids) {
      for (const auto& f : solid) {
        std::vector<int> key = f;
        std::sort(key.begin(), key.end());
        if (const auto at = seen.find(key); at != seen.end()) {
          inner.push_back(at->second.second), inner_owner.push_back(at->second.first), neighbour.push_back(cells);
          seen.erase(at);
        } else {
          seen[key] = {cells, f};
        }
      }
      ++cells;
    }
    for (const auto& [key, f] : seen) outer.push_back(f.second), outer_owner.push_back(f.first);
    faces = inner, owner = inner_owner;
    faces.insert(faces.end(), outer.begin(), outer.end());
    owner.insert(owner.end(), outer_owner.begin(), outer_owner.end());
  }
};

// Hexahedron of corners a..h in the usual order, faces outward.
std::vector<std::vector<int>> hexahedron(int a, int b, int c, int d, int e, int f, int g, int h) {
  return {{a, d, c, b}, {e, f, g, h}, {a, b, f, e}, {b, c, g, f}, {c, d, h, g}, {d, a, e, h}};
}

// Two cubes along x, a pyramid on the first, a tetrahedron on the pyramid, a wedge on the second, and a cube with a split face.
const Shape& shape() {
  static const Shape s = [] {
    std::vector<std::vector<int>> split = hexahedron(2, 16, 17, 5, 8, 18, 19, 11);
    split.erase(split.begin() + 3);
    split.push_back({16, 17, 19}), split.push_back({16, 19, 18});
    Shape r({hexahedron(0, 1, 4, 3, 6, 7, 10, 9),
             hexahedron(1, 2, 5, 4, 7, 8, 11, 10),
             {{6, 9, 10, 7}, {6, 7, 12}, {7, 10, 12}, {10, 9, 12}, {9, 6, 12}},
             {{12, 7, 6}, {13, 6, 7}, {13, 7, 12}, {13, 12, 6}},
             {{4, 5, 11, 10}, {4, 10, 14}, {5, 15, 11}, {4, 14, 15, 5}, {10, 11, 15, 14}},
             split});
    r.points = {0, 0, 0, 1, 0, 0, 2,   0,   0, 0,   1,  0, 1, 1, 0,   2, 1, 0,   0, 0, 1, 1, 0, 1, 2, 0, 1, 0, 1, 1,
                1, 1, 1, 2, 1, 1, 0.5, 0.5, 2, 0.5, -1, 2, 1, 2, 0.5, 2, 2, 0.5, 3, 0, 0, 3, 1, 0, 3, 0, 1, 3, 1, 1};
    return r;
  }();
  return s;
}

size_t outer_faces() { return shape().faces.size() - shape().neighbour.size(); }

std::string faces_file(const FoamWriting& w) {
  if (w.binary) {
    std::vector<int> begin{0}, ids;
    for (const auto& f : shape().faces) {
      ids.insert(ids.end(), f.begin(), f.end());
      begin.push_back(int(ids.size()));
    }
    return header(w, "faceCompactList", "faces") + label_list(begin, w) + "\n" + label_list(ids, w);
  }
  std::string s = header(w, "faceList", "faces") + fmt::format("{}\n(\n", shape().faces.size());
  for (const auto& f : shape().faces) {
    s += fmt::format("{}(", f.size());
    for (const int p : f) s += fmt::format("{} ", p);
    s += ")\n";
  }
  return s + ")\n";
}

std::string field_file(const FoamWriting& w, const std::string& type, const std::string& name, const std::string& inner,
                       const std::string& boundary) {
  return header(w, type, name) + "dimensions [1 -1 -2 0 0 0 0];\n\ninternalField " + inner + ";\n\nboundaryField\n{\n" + boundary + "}\n";
}

std::vector<double> counted(size_t n, double from) {
  std::vector<double> v(n);
  for (size_t i = 0; i < n; ++i) v[i] = from + double(i);
  return v;
}

CaseFiles foam_case(const FoamWriting& w) {
  const size_t walls = outer_faces() - 5;
  const std::string mesh = "constant/polyMesh/", none;
  CaseFiles c;
  c["case.foam"] = "";
  c[mesh + "points"] = header(w, "vectorField", "points") + tuple_list(shape().points, 3, w);
  c[mesh + "faces"] = faces_file(w);
  c[mesh + "owner"] = header(w, "labelList", "owner") + label_list(shape().owner, w);
  c[mesh + "neighbour"] = header(w, "labelList", "neighbour") + label_list(shape().neighbour, w);
  c[mesh + "boundary"] = header({}, "polyBoundaryMesh", "boundary") +
                         fmt::format(
                             "2\n(\n walls {{ type wall; inGroups List<word> 1(wall); nFaces {}; startFace {}; }}\n"
                             " outlet {{ type patch; nFaces 5; startFace {}; }}\n)\n",
                             walls, shape().neighbour.size(), shape().neighbour.size() + walls);
  c[mesh + "cellZones"] =
      header(w, "regIOobject", "cellZones") + "1\n(\nsolid { type cellZone; cellLabels List<label> " + label_list({1, 4}, w) + "; }\n)\n";
  const std::string p_list = "nonuniform List<scalar> " + tuple_list(counted(6, 10), 1, w);
  c["10/p"] =
      field_file(w, "volScalarField", "p", p_list,
                 "walls { type zeroGradient; }\n outlet { type fixedValue; refValue nonuniform List<scalar> " +
                     tuple_list(counted(5, 50), 1, w) + "; value nonuniform List<scalar> " + tuple_list(counted(5, 100), 1, w) + "; }\n");
  c["10/U"] =
      field_file(w, "volVectorField", "U", "uniform (1 2 -3)",
                 "\"(wa|xy).*\" { type fixedValue; value uniform (0 0 0); }\n \"out.*\" { type calculated; value uniform (7 8 9); }\n");
  c["10/sigma"] = field_file(
      w, "volSymmTensorField", "sigma", "nonuniform List<symmTensor> " + tuple_list(counted(36, 0), 6, w),
      "wall { type fixedValue; value uniform (1 2 3 4 5 6); }\n outlet { type empty; value nonuniform List<symmTensor> 0(); }\n");
  c["10/D"] =
      field_file(w, "pointVectorField", "D", "nonuniform List<vector> " + tuple_list(shape().points, 3, w), "walls { type calculated; }\n");
  c["10/phi"] = field_file(w, "surfaceScalarField", "phi", "uniform 1", "");
  c["10/note"] = "no file of OpenFOAM";
  c["9/p"] = field_file(w, "volScalarField", "p", "uniform 4.5",
                        "walls { type zeroGradient; }\noutlet { type fixedValue; value $internalField; }\n");
  return c;
}

double volume_of_faces(const UnstructuredMesh& m, size_t cell) {
  const auto at = m.polyhedron_faces.view<int64_t>();
  const CellsView f = cells_view(m.faces);
  double volume = 0;
  for (auto k = size_t(at[cell]); k < size_t(at[cell + 1]); ++k)
    for (size_t i = 1; i + 1 < f.size(k); ++i) {
      const Vec3 a = m.points.at(size_t(f.point(k, 0))), b = m.points.at(size_t(f.point(k, i))), c = m.points.at(size_t(f.point(k, i + 1)));
      volume += dot(a, cross(b, c)) / 6;
    }
  return volume;
}

}  // namespace

TEST_CASE("openfoam: a mesh of all shapes reads the same as text and as bytes of any width and order") {
  const FoamWriting forms[] = {{}, {true, 4, 8, false}, {true, 8, 8, false}, {true, 4, 4, false}, {true, 8, 4, true}, {true, 4, 8, true}};
  for (const FoamWriting& w : forms) {
    CAPTURE(w.binary);
    CAPTURE(w.label);
    CAPTURE(w.scalar);
    CAPTURE(w.big);
    const Data data = read_any(write_case(fmt::format("foam{}{}{}{}", w.binary, w.label, w.scalar, w.big), foam_case(w)) + "case.foam");
    const auto all = leaves(data);
    REQUIRE(all.size() == 3);
    CHECK(all[0].first == "internalMesh");
    CHECK(all[1].first == "boundary/walls");
    CHECK(all[2].first == "boundary/outlet");
    const Dataset& d = *all[0].second;
    const auto* m = d.as<UnstructuredMesh>();
    REQUIRE(m);
    REQUIRE(d.cell_count() == 6);
    const CellType types[] = {CellType::hexahedron, CellType::hexahedron, CellType::pyramid,
                              CellType::tetra,      CellType::wedge,      CellType::polyhedron};
    const CellsView v = cells_view(m->cells);
    for (size_t c = 0; c < 6; ++c) {
      CAPTURE(c);
      CHECK(m->type(c) == types[c]);
      if (c == 5) continue;
      // Base counter-clockwise as seen from above: three edges at the first corner are right-handed.
      auto at = [&](size_t k) { return m->points.at(size_t(v.point(c, k))); };
      const size_t base = c < 3 ? 4 : 3;
      CHECK(dot(cross(at(1) - at(0), at(base - 1) - at(0)), at(base) - at(0)) > 0);
    }
    CHECK(volume_of_faces(*m, 5) == doctest::Approx(1));
    CHECK(m->points.xyz.type() == (w.binary && w.scalar == 8 ? ElementType::f64 : ElementType::f32));

    const Field& p = d.fields().require("p", Association::cell);
    CHECK(p.unit == "kg/(m s^2)");
    CHECK(p.array.get(5) == 15);
    CHECK(d.fields().require("U").array.get(3, 2) == -3);
    const Array& sigma = d.fields().require("sigma").array;  // the file lists xx xy xz yy yz zz
    CHECK(sigma.get(1, 0) == 6);
    CHECK(sigma.get(1, 1) == 9);
    CHECK(sigma.get(1, 2) == 11);
    CHECK(sigma.get(1, 3) == 7);
    CHECK(sigma.get(1, 4) == 10);
    CHECK(sigma.get(1, 5) == 8);
    CHECK(d.fields().require("D", Association::point).array.get(13, 1) == -1);
    CHECK(d.fields().find("phi") == nullptr);
    CHECK(d.fields().require("cellZone").array.get(4) == 0);
    CHECK(d.fields().require("cellZone").array.get(0) == -1);
    CHECK(d.time() == 10);

    const Dataset &walls = *all[1].second, &outlet = *all[2].second;
    CHECK(walls.cell_count() == outer_faces() - 5);
    CHECK(outlet.fields().require("p").array.get(4) == 104);
    const Field& wall_p = walls.fields().require("p");
    for (size_t f = 0; f < walls.cell_count(); ++f) CHECK(wall_p.array.get(f) == 10 + shape().owner[shape().neighbour.size() + f]);
    CHECK(walls.fields().require("U").array.get(0, 0) == 0);
    CHECK(outlet.fields().require("U").array.get(0, 2) == 9);
    CHECK(walls.fields().require("sigma").array.get(0, 1) == 4);
    CHECK(outlet.fields().require("sigma").array.get(0, 0) >= 0);
    // Points of a patch are those of the mesh, and so are their values.
    const Array& displaced = outlet.fields().require("D", Association::point).array;
    const auto* surface = outlet.as<SurfaceMesh>();
    for (size_t i = 0; i < displaced.count(); ++i) CHECK(displaced.get(i, 0) == surface->points.at(i).x);
  }
}

TEST_CASE("openfoam: packed files, times in order of their numbers, fields and looks") {
  CaseFiles files = foam_case({});
  for (const char* name : {"constant/polyMesh/points", "constant/polyMesh/faces", "10/p"}) {
    const std::string bytes = files[name];
    const auto packed = pack_gzip({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()});
    files.erase(name);
    files[std::string(name) + ".gz"] = std::string(reinterpret_cast<const char*>(packed.data()), packed.size());
  }
  const std::string root = write_case("foam_gz", files);
  CHECK(leaf(read_any(root), 0)->fields().require("p").array.get(2) == 12);
  Context context;
  CHECK(file_times(root, {}, context) == std::vector<double>{9, 10});
  ReadOptions o;
  o.step = 0;
  const Data first = read_any(root, o);
  CHECK(leaf(first, 0)->fields().require("p").array.get(2) == 4.5);
  CHECK(leaf(first, 2)->fields().require("p").array.get(0) == 4.5);
  CHECK(leaf(first, 0)->fields().find("U") == nullptr);
  ReadOptions one;
  one.fields = {"U"};
  CHECK(leaf(read_any(root, one), 0)->fields().size() == 1);
  ReadOptions look;
  look.header_only = true;
  const Data quick = read_any(root, look);
  CHECK(leaf(quick, 0)->fields().require("sigma").components() == 6);
  CHECK(leaf(quick, 1)->fields().require("p").array.count() == outer_faces() - 5);
  CHECK(leaf(quick, 0)->fields().require("p").array.stride_bytes() == 0);
}

TEST_CASE("openfoam: processors are parts, and pieces take their share of them") {
  CaseFiles files{{"d.foam", ""}};
  for (const char* p : {"processor0", "processor1", "processor10", "processor2"})
    for (const auto& [name, bytes] : foam_case({}))
      if (name != "case.foam") files[std::string(p) + "/" + name] = bytes;
  const std::string path = write_case("foam_processors", files) + "d.foam";
  auto names = [&](int piece, int pieces) {
    ReadOptions o;
    o.piece = piece, o.pieces = pieces;
    std::vector<std::string> r;
    const Data data = read_any(path, o);
    for (const auto& part : std::get<CollectionPtr>(data)->parts) r.push_back(part.name);
    return r;
  };
  CHECK(names(0, 1) == std::vector<std::string>{"processor0", "processor1", "processor2", "processor10"});
  CHECK(names(0, 2) == std::vector<std::string>{"processor0", "processor1"});
  CHECK(names(1, 2) == std::vector<std::string>{"processor2", "processor10"});
  CHECK(leaves(read_any(path)).size() == 12);
}

TEST_CASE("openfoam: regions are parts of their own, and points that move come from the last time folder that has them") {
  CaseFiles files = foam_case({});
  for (const auto& [name, bytes] : foam_case({}))
    if (name.starts_with("constant/")) files["constant/solid/" + name.substr(9)] = bytes;
  std::vector<double> moved = shape().points;
  for (size_t i = 0; i < moved.size(); i += 3) moved[i] += 100;
  files["9/polyMesh/points"] = header({}, "vectorField", "points") + tuple_list(moved, 3, {});
  const Data data = read_any(write_case("foam_regions", files));
  const auto all = leaves(data);
  REQUIRE(all.size() == 6);
  CHECK(all[0].first == "defaultRegion/internalMesh");
  CHECK(all[3].first == "solid/internalMesh");
  CHECK(all[0].second->bounds().lo.x == 100);
  CHECK(all[3].second->bounds().lo.x == 0);
  CHECK(all[3].second->fields().find("p") == nullptr);
}

TEST_CASE("openfoam: a field that hangs on a macro is left out with a warning, or refused when it was asked for") {
  CaseFiles files = foam_case({});
  files["10/k"] = field_file({}, "volScalarField", "k", "uniform $turbulentKE", "#includeEtc \"caseDicts/setConstraintTypes\"\n");
  files["10/q"] = header({}, "volScalarField", "q") + "#include \"initial\"\ndimensions [0 0 0 0 0 0 0];\nboundaryField {}\n";
  const std::string root = write_case("foam_macro", files);
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view text) { said += std::string(text) + "\n"; };
  const Data data = read_data(root, {}, context);
  CHECK(leaf(data, 0)->fields().find("k") == nullptr);
  CHECK(leaf(data, 0)->fields().find("p") != nullptr);
  CHECK(contains(said, "field 'k' is left out"));
  CHECK(contains(said, "'#include' is not expanded"));
  ReadOptions o;
  o.fields = {"q"};
  CHECK(contains(error_of([&] { read_any(root, o); }), "'#include' is not expanded"));
}

TEST_CASE("openfoam: errors say what is wrong and where") {
  auto refused = [](const std::string& which, const std::string& from, const std::string& to) {
    CaseFiles files = foam_case({});
    std::string& s = files[which];
    const size_t at = s.find(from);
    REQUIRE(at != std::string::npos);
    s.replace(at, from.size(), to);
    return error_of([&] { read_any(write_case("foam_bad", files) + "case.foam"); });
  };
  const std::string mesh = "constant/polyMesh/";
  CHECK(contains(refused(mesh + "points", "FoamFile", "Foam"), "FoamFile header"));
  CHECK(contains(refused(mesh + "points", "20\n(", "2147483648\n("), "does not fit"));
  CHECK(contains(refused(mesh + "points", "(1 0 0)", "(1 x 0)"), "not a list of 20 values"));
  CHECK(contains(refused(mesh + "faces", "4(", "3("), "of a face was expected"));
  CHECK(contains(refused(mesh + "owner", "\n0\n", "\n99\n"), "belongs to cell 99"));
  CHECK(contains(refused(mesh + "owner", "\n0\n", "\n-7\n"), "belongs to cell -7"));
  CHECK(contains(refused(mesh + "faces", "(1 ", "(77 "), "the point 77, but there are 20"));
  CHECK(contains(refused(mesh + "boundary", "nFaces 5", "nFaces 6"), "patch 'outlet'"));
  CHECK(contains(refused("10/p", "nonuniform List<scalar> 6", "nonuniform List<scalar> 5"), "expected"));
  CHECK(contains(refused("10/U", "(1 2 -3)", "(1 2)"), "is not a number"));
  CHECK(contains(refused("10/p", "internalField", "internal"), "has no internalField"));
  CHECK(contains(refused("10/p", "[1 -1", "[a -1"), "dimensions must be seven numbers"));
  const std::string missing = [] {
    CaseFiles files = foam_case({});
    files.erase("constant/polyMesh/faces");
    return error_of([&] { read_any(write_case("foam_missing", files)); });
  }();
  CHECK(contains(missing, "lacks the file 'faces'"));
  CHECK(contains(error_of([] { read_any(write_case("foam_none", {{"a.foam", ""}}) + "a.foam"); }), "has no mesh"));
  CHECK(contains(error_of([] { read_any(write_case("foam_odd", {{"a.stl", ""}}) + "a.stl"); }), "is empty"));
}

TEST_CASE("openfoam: damaged files give an error or a valid mesh") {
  for (const FoamWriting& w : {FoamWriting{}, FoamWriting{true, 8, 8, false}}) {
    const CaseFiles files = foam_case(w);
    const std::string name = fmt::format("foam_damage{}", w.binary);
    CHECK(cut_and_damage_case(name, files, "constant/polyMesh/points", "case.foam") > 55);
    CHECK(cut_and_damage_case(name, files, "constant/polyMesh/faces", "case.foam") > 55);
    CHECK(cut_and_damage_case(name, files, "constant/polyMesh/owner", "case.foam") > 55);
    cut_and_damage_case(name, files, "constant/polyMesh/boundary", "case.foam");
    cut_and_damage_case(name, files, "10/p", "case.foam");
  }
}

TEST_CASE("openfoam: long lists of text read the same on one thread and on eight") {
  std::string text = header({}, "vectorField", "points") + "60000\n(\n";
  for (int i = 0; i < 60000; ++i) text += fmt::format("({} {} {:.3f})\n", i, -i, i * 0.25);
  text += ")\n";
  const std::string path = temp_file("long_points", text);
  auto read = [&] {
    openfoam::FoamFile f(path);
    return f.tuples(3, "points");
  };
  const Array one = with_threads(1, read), many = with_threads(8, read);
  CHECK(same_array(one, many));
  CHECK(one.get(59999, 1) == -59999);
  CHECK(one.get(4, 2) == 1);
}

TEST_CASE("openfoam: names of patches by pattern, and units from exponents") {
  using openfoam::pattern_fits;
  CHECK(pattern_fits(".*", ""));
  CHECK(pattern_fits("wall.*", "wall_1"));
  CHECK(pattern_fits("(in|out)let", "outlet"));
  CHECK(pattern_fits(".*(in|out).*", "myoutlet"));
  CHECK_FALSE(pattern_fits("(in|out)let", "inletx"));
  CHECK_FALSE(pattern_fits("w.ll", "wl"));
  CHECK_FALSE(pattern_fits("a*a*a*a*a*a*b", std::string(150, 'a')));
  const double velocity[] = {0, 1, -1, 0, 0, 0, 0}, pressure[] = {1, -1, -2, 0, 0, 0, 0}, rate[] = {0, 0, -1, 0, 0, 0, 0};
  CHECK(openfoam::unit_name(velocity) == "m/s");
  CHECK(openfoam::unit_name(pressure) == "kg/(m s^2)");
  CHECK(openfoam::unit_name(rate) == "1/s");
  CHECK(openfoam::unit_name({}) == "");
}
