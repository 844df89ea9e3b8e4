// SPDX-License-Identifier: Apache-2.0
// Files that name other files: .vtm, .pvd.
#include <filesystem>

#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

namespace {

Data read_in_temp(const std::string& name, const ReadOptions& options = {}) {
  Context context;
  return read_data(temp(name), options, context);
}

const Collection& parts_of(const Data& d) {
  REQUIRE(std::holds_alternative<CollectionPtr>(d));
  return *std::get<CollectionPtr>(d);
}

std::vector<std::string> names_of(const Data& d) {
  std::vector<std::string> r;
  for_each_dataset(d, [&](const std::string& name, const DatasetPtr&) { r.push_back(name); });
  return r;
}

std::string vtm(const std::string& body) {
  return "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet>" + body + "</vtkMultiBlockDataSet></VTKFile>";
}
std::string pvd(const std::string& body) {
  return "<VTKFile type=\"Collection\" version=\"0.1\"><Collection>" + body + "</Collection></VTKFile>";
}

DatasetPtr tetras(size_t n) {
  DatasetParts p;
  p.mesh = tetra_mesh(n);
  p.fields.add({"T", Association::point, ramp<float>(n + 3), {}, Role::none});
  return make_dataset(std::move(p));
}

size_t cells_in(const Data& d) {
  size_t n = 0;
  for_each_dataset(d, [&](const std::string&, const DatasetPtr& x) { n += x->cell_count(); });
  return n;
}

}  // namespace

TEST_CASE("vtm: blocks nest, keep their names, and blocks without a mesh are left out") {
  for (const size_t n : {1, 2, 3}) write(temp("b" + std::to_string(n) + ".vtu"), tetras(n));
  write_file(temp("tree.vtm"), vtm("<Block index=\"0\" name=\"wing &amp; tail\"><DataSet index=\"0\" name=\"left\" file=\"b1.vtu\"/>"
                                   "<Piece index=\"1\"><DataSet index=\"4\" file=\"b2.vtu\"/></Piece><DataSet index=\"2\"/></Block>"
                                   "<Block index=\"1\"/><DataSet index=\"2\" file=\"b3.vtu\"/>"));
  const Data d = read_in_temp("tree.vtm");
  CHECK(parts_of(d).parts.size() == 3);
  CHECK(names_of(d) == std::vector<std::string>{"wing & tail/left", "wing & tail/1/4", "2"});
  CHECK(cells_in(d) == 6);
  for (const int pieces : {2, 3, 4}) {
    size_t cells = 0;
    for (int i = 0; i < pieces; ++i) {
      ReadOptions o;
      o.piece = i, o.pieces = pieces;
      cells += cells_in(read_in_temp("tree.vtm", o));
    }
    CHECK(cells == 6);
  }
}

TEST_CASE("vtm: of missing files the others are read with a warning") {
  write(temp("here.vtu"), tetras(2));
  write_file(temp("some.vtm"), vtm("<DataSet index=\"0\" file=\"gone1.vtu\"/><Block index=\"1\"><DataSet index=\"0\" file=\"gone2.vtu\"/>"
                                   "</Block><DataSet index=\"2\" file=\"here.vtu\"/>"));
  Context context;
  std::string warned;
  context.on_log = [&](LogLevel level, std::string_view text) { warned += level == LogLevel::warning ? std::string(text) : ""; };
  CHECK(cells_in(read_data(temp("some.vtm"), {}, context)) == 2);
  CHECK(warned.find("2 of the 3 files that it names are missing (") != std::string::npos);
  CHECK(warned.find("gone1.vtu, ...); the rest is read") != std::string::npos);
  // A series below, whose only file is missing: a part without a mesh.
  write_file(temp("lost.pvd"), pvd("<DataSet timestep=\"0\" file=\"gone3.vtu\"/>"));
  write_file(temp("below.vtm"), vtm("<DataSet index=\"0\" file=\"here.vtu\"/><DataSet index=\"1\" file=\"lost.pvd\"/>"));
  warned.clear();
  CHECK(cells_in(read_data(temp("below.vtm"), {}, context)) == 2);
  CHECK(warned.find("1 of the 3 files that it names is missing (") != std::string::npos);
  write_file(temp("none.vtm"), vtm("<DataSet index=\"0\" file=\"gone1.vtu\"/>"));
  CHECK(error_of([&] { read_in_temp("none.vtm"); }).find("gone1.vtu: no such file") != std::string::npos);
}

TEST_CASE("vtm: what names itself, or names too much, is refused") {
  auto error = [&](const std::string& name) { return error_of([&] { read_in_temp(name); }); };
  write_file(temp("self.vtm"), vtm("<DataSet index=\"0\" file=\"self.vtm\"/>"));
  CHECK(error("self.vtm").find("contains itself") != std::string::npos);
  write_file(temp("ping.vtm"), vtm("<DataSet file=\"./pong.pvd\"/>"));
  write_file(temp("pong.pvd"), pvd("<DataSet timestep=\"0\" file=\"ping.vtm\"/>"));
  CHECK(error("ping.vtm").find("contains itself") != std::string::npos);
  write_file(temp("gone.vtm"), vtm("<DataSet file=\"nowhere/none.vtu\"/>"));
  CHECK(error("gone.vtm").find("none.vtu") != std::string::npos);
  CHECK(error("gone.vtm").find("gone.vtm") != std::string::npos);
  // Ten files, each naming the next ten times: ten thousand million parts.
  write(temp("leaf.vtu"), tetras(1));
  for (int i = 0; i < 10; ++i) {
    std::string body;
    for (int k = 0; k < 10; ++k)
      body += i < 9 ? "<DataSet file=\"laugh" + std::to_string(i + 1) + ".vtm\"/>" : std::string("<DataSet file=\"leaf.vtu\"/>");
    write_file(temp("laugh" + std::to_string(i) + ".vtm"), vtm(body));
  }
  CHECK(error("laugh0.vtm").find("parts") != std::string::npos);
  CHECK(cells_in(read_in_temp("laugh6.vtm")) == 10000);  // read once, not ten thousand times
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<Block>";
  for (int i = 0; i < 5000; ++i) deep += "</Block>";
  write_file(temp("deep.vtm"), vtm(deep));
  CHECK(error("deep.vtm").find("deep") != std::string::npos);
  for (int i = 0; i < 40; ++i)
    write_file(temp("chain" + std::to_string(i) + ".vtm"), vtm("<DataSet file=\"chain" + std::to_string(i + 1) + ".vtm\"/>"));
  CHECK(error("chain0.vtm").find("other files") != std::string::npos);
  write_file(temp("entity.vtm"), "<!DOCTYPE v [<!ENTITY a \"aaaa\">]>" + vtm("<DataSet file=\"&a;\"/>"));
  CHECK(error("entity.vtm").find("entities") != std::string::npos);
}

TEST_CASE("pvd: steps are sorted, chosen by time or number, and only the chosen one is read") {
  for (const size_t n : {1, 2, 3}) write(temp("step" + std::to_string(n) + ".vtu"), tetras(n));
  write_file(temp("run.pvd"), pvd("<DataSet timestep=\"2.5\" part=\"0\" file=\"step2.vtu\"/><DataSet timestep=\"-1\" part=\"0\" "
                                  "file=\"step1.vtu\"/><DataSet timestep=\"1e3\" file=\"missing.vtu\"/>"));
  Context context;
  CHECK(file_times(temp("run.pvd"), {}, context) == std::vector<double>{-1, 2.5, 1000});
  ReadOptions o;
  CHECK(cells_in(read_in_temp("run.pvd", o)) == 1);
  o.step = 1;
  const Data d = read_in_temp("run.pvd", o);
  REQUIRE(std::holds_alternative<DatasetPtr>(d));
  CHECK(std::get<DatasetPtr>(d)->cell_count() == 2);
  CHECK(std::get<DatasetPtr>(d)->time() == 2.5);
  o.step = -1, o.time = 3.0;
  CHECK(cells_in(read_in_temp("run.pvd", o)) == 2);
  o.time = 900.0;
  CHECK(error_of([&] { read_in_temp("run.pvd", o); }).find("missing.vtu") != std::string::npos);
  o.time.reset(), o.step = 3;
  CHECK(error_of([&] { read_in_temp("run.pvd", o); }).find("no time step 3") != std::string::npos);
}

TEST_CASE("pvd: several parts of one step become a collection, and a file without times has none") {
  write(temp("p1.vtu"), tetras(1)), write(temp("p2.vtu"), tetras(2));
  write_file(temp("parts.pvd"), pvd("<DataSet timestep=\"0\" group=\"a\" part=\"0\" file=\"p1.vtu\"/><DataSet timestep=\"0\" group=\"a\" "
                                    "part=\"1\" name=\"hub\" file=\"p2.vtu\"/><DataSet timestep=\"1\" file=\"p1.vtu\"/>"));
  const Data d = read_in_temp("parts.pvd");
  CHECK(names_of(d) == std::vector<std::string>{"0", "hub"});
  CHECK(cells_in(d) == 3);
  write_file(temp("still.pvd"), pvd("<DataSet file=\"p1.vtu\"/><DataSet file=\"p2.vtu\"/>"));
  Context context;
  CHECK(file_times(temp("still.pvd"), {}, context).empty());
  CHECK(cells_in(read_in_temp("still.pvd")) == 3);
  write_file(temp("none.pvd"), pvd(""));
  CHECK(error_of([&] { read_in_temp("none.pvd"); }).find("no DataSet") != std::string::npos);
  write_file(temp("nan.pvd"), pvd("<DataSet timestep=\"soon\" file=\"p1.vtu\"/>"));
  CHECK(error_of([&] { read_in_temp("nan.pvd"); }).find("timestep") != std::string::npos);
}

TEST_CASE("vtm and pvd: a file cut or changed anywhere reads or gives an Error") {
  write(temp("b1.vtu"), tetras(1));
  const std::pair<const char*, std::string> files[] = {
      {"bent.vtm",
       vtm("<Block index=\"0\" name=\"a\"><DataSet index=\"0\" file=\"b1.vtu\"/></Block><DataSet index=\"1\" file=\"b1.vtu\"/>")},
      {"bent.pvd", pvd("<DataSet timestep=\"0.5\" part=\"0\" file=\"b1.vtu\"/><DataSet timestep=\"1\" part=\"0\" file=\"b1.vtu\"/>")}};
  for (const auto& [name, text] : files) {
    size_t errors = 0;
    auto attempt = [&](const std::string& t) {
      write_file(temp(name), t);
      try {
        read_in_temp(name);
      } catch (const Error& e) {
        ++errors;
        CHECK(e.kind() == ErrorKind::data);
      }
    };
    for (size_t i = 1; i < 64; ++i) attempt(text.substr(0, text.size() * i / 64));
    CHECK(errors == 63);
    for (size_t i = 0; i < text.size(); ++i)
      for (const int flip : {1, 0x80, 0x20}) {
        std::string bent = text;
        bent[i] = char(bent[i] ^ flip);
        attempt(bent);
      }
    CHECK(errors > 150);
  }
}

TEST_CASE("vtm: a tree is written and comes back with names, meshes and fields") {
  auto inner = std::make_shared<Collection>();
  std::vector<DatasetPtr> all;
  for (const Sample& s : samples()) {
    inner->parts.push_back({std::string("a \"") + s.extension + "\" <b>", s.dataset});
    all.push_back(s.dataset);
  }
  auto outer = std::make_shared<Collection>();
  outer->parts.push_back({"inner", CollectionPtr(inner)});
  outer->parts.push_back({"alone", samples()[0].dataset});
  outer->parts.push_back({"empty", CollectionPtr(std::make_shared<Collection>())});
  all.push_back(samples()[0].dataset);
  Context context;
  for (const char* compression : {"none", "zlib"}) {  // the second time over the first
    write_data(temp("tree out.vtm"), CollectionPtr(outer), {VtkEncoding::appended, value_of_word<Compression>(compression)}, context);
    const Data back = read_in_temp("tree out.vtm");
    CHECK(parts_of(back).parts.size() == 3);
    CHECK(names_of(back)[0] == "inner/a \"vti\" <b>");
    size_t i = 0;
    for_each_dataset(back, [&](const std::string&, const DatasetPtr& d) { check_same(*all[i++], *d); });
    CHECK(i == all.size());
  }
  for (const auto& entry : std::filesystem::directory_iterator(temp_folder())) {
    CAPTURE(entry.path().string());
    CHECK(entry.path().filename().string().find(".partial") == std::string::npos);
    CHECK(entry.path().filename().string().find(".old") == std::string::npos);
  }
}

TEST_CASE("vtm: what cannot be written leaves nothing behind, and folders of others are left alone") {
  auto collection = std::make_shared<Collection>();
  collection->parts.push_back({"mesh", tetras(2)});
  collection->parts.push_back({"table", std::make_shared<const Table>()});
  Context context;
  CHECK(error_of([&] { write_data(temp("half.vtm"), CollectionPtr(collection), {}, context); }).find("table") != std::string::npos);
  CHECK(!file_exists(temp("half.vtm")));
  CHECK(!file_exists(temp("half")));
  collection->parts.pop_back();
  std::filesystem::create_directory(temp("mine"));
  write_file(temp("mine/letter.txt"), "dear");
  CHECK(error_of([&] { write_data(temp("mine.vtm"), CollectionPtr(collection), {}, context); }).find("letter.txt") != std::string::npos);
  CHECK(file_exists(temp("mine/letter.txt")));
  CHECK(!file_exists(temp("mine.vtm")));
  write_file(temp("blocked"), "");
  CHECK(!error_of([&] { write_data(temp("blocked.vtm"), CollectionPtr(collection), {}, context); }).empty());
  CHECK(!error_of([&] { write_data(temp("no/such/folder.vtm"), CollectionPtr(collection), {}, context); }).empty());
}

TEST_CASE("vtm and pvd: the real ones agree with the truth recorded for them" * doctest::skip(no_data())) {
  Context context;
  const Data blow = read_data(data_file("meshes/multiblock/ex-blow_5/ex-blow_5.vtm"), {}, context);
  CHECK(names_of(blow).size() == 16);
  CHECK(names_of(blow)[0].starts_with("Element Blocks/"));
  size_t points = 0;
  for_each_dataset(blow, [&](const std::string&, const DatasetPtr& d) { points += d->point_count(); });
  CHECK(points == 945);
  CHECK(cells_in(blow) == 1057);
  const std::string sphere = data_file("meshes/time/singleSphere/singleSphereAnimation.pvd");
  CHECK(file_times(sphere, {}, context).size() == 11);
  CHECK(file_times(sphere, {}, context)[10] == 10);
  ReadOptions o;
  o.time = 7.4;
  CHECK(std::get<DatasetPtr>(read_data(sphere, o, context))->time() == 7);
}
