// SPDX-License-Identifier: Apache-2.0
// PLOT3D: every combination of byte order, records, precision, dimensions, blanking and number of grids is found from the length.
#include <fmt/core.h>

#include "case_files.h"

using namespace sg;
using namespace sg::test;

namespace {

struct P3dWriting {
  bool text = false, big = false, records = false, multi = false, iblank = false;
  int dimensions = 3, real = 4;
};

using Sizes = std::vector<std::array<int, 3>>;

struct P3dEmit {
  const P3dWriting& w;
  std::string out{}, record{};
  void integer(int v) {
    if (w.text) out += fmt::format("{} ", v);
    else put_bytes(record, int32_t(v), w.big);
  }
  void real(double v) {
    if (w.text) out += fmt::format("{:.6e}\n", v);
    else if (w.real == 8) put_bytes(record, v, w.big);
    else put_bytes(record, float(v), w.big);
  }
  void end() {
    if (w.text) {
      out += "\n";
      return;
    }
    if (w.records) put_bytes(out, uint32_t(record.size()), w.big);
    out += record;
    if (w.records) put_bytes(out, uint32_t(record.size()), w.big);
    record.clear();
  }
  void sizes(const Sizes& s, int functions = 0) {
    if (w.multi) integer(int(s.size())), end();
    for (const auto& n : s) {
      for (int a = 0; a < w.dimensions; ++a) integer(n[size_t(a)]);
      if (functions) integer(functions);
    }
    end();
  }
};

size_t points_of(const std::array<int, 3>& n) { return size_t(n[0]) * size_t(n[1]) * size_t(n[2]); }
double coordinate(size_t g, int axis, size_t i) { return double(g + 1) * 100 + axis * 10 + double(i) * 0.5; }
int blank(size_t i) { return i == 1 ? 0 : i % 3 == 2 ? -2 : 1; }

std::string grid_file(const P3dWriting& w, const Sizes& s) {
  P3dEmit e{w};
  e.sizes(s);
  for (size_t g = 0; g < s.size(); ++g) {
    for (int a = 0; a < w.dimensions; ++a)
      for (size_t i = 0; i < points_of(s[g]); ++i) e.real(coordinate(g, a, i));
    if (w.iblank)
      for (size_t i = 0; i < points_of(s[g]); ++i) e.integer(blank(i));
    e.end();
  }
  return e.out;
}

std::string solution_file(const P3dWriting& w, const Sizes& s) {
  P3dEmit e{w};
  e.sizes(s);
  for (size_t g = 0; g < s.size(); ++g) {
    for (const double v : {0.8, 2.0, 1e6, 12.5}) e.real(v);
    e.end();
    for (int f = 0; f < w.dimensions + 2; ++f)
      for (size_t i = 0; i < points_of(s[g]); ++i) e.real(f * 1000 + double(i));
    e.end();
  }
  return e.out;
}

std::string function_file(const P3dWriting& w, const Sizes& s, int functions) {
  P3dEmit e{w};
  e.sizes(s, functions);
  for (size_t g = 0; g < s.size(); ++g) {
    for (int f = 0; f < functions; ++f)
      for (size_t i = 0; i < points_of(s[g]); ++i) e.real(double(g) + f * 100 + double(i));
    e.end();
  }
  return e.out;
}

}  // namespace

TEST_CASE("plot3d: all forms are told apart by length and content") {
  int forms = 0;
  for (const bool text : {false, true})
    for (const bool big : {false, true})
      for (const bool records : {false, true})
        for (const bool multi : {false, true})
          for (const bool iblank : {false, true})
            for (const int dimensions : {2, 3})
              for (const int real : {4, 8}) {
                const P3dWriting w{text, big, records, multi, iblank, dimensions, real};
                if (text && (big || records || real == 8)) continue;
                const int nz = dimensions == 3 ? 2 : 1;
                Sizes s{{4, 3, nz}};
                if (multi) s.push_back({2, 5, nz});
                CAPTURE(fmt::format("text {} big {} records {} multi {} iblank {} {}D {} bytes", text, big, records, multi, iblank,
                                    dimensions, real));
                const std::string root =
                    write_case(fmt::format("p3d{}", forms++),
                               {{"a.xyz", grid_file(w, s)}, {"a.q", solution_file(w, s)}, {"a.fun", function_file(w, s, 2)}});
                const auto all = leaves(read_any(root + "a.xyz"));
                REQUIRE(all.size() == s.size());
                for (size_t g = 0; g < s.size(); ++g) {
                  if (multi) CHECK(all[g].first == fmt::format("grid {}", g + 1));
                  const Dataset& d = *all[g].second;
                  const auto* m = d.as<CurvilinearGrid>();
                  REQUIRE(m);
                  for (size_t a = 0; a < 3; ++a) CHECK(m->dims[a] == size_t(s[g][a]));
                  const size_t last = d.point_count() - 1;
                  CHECK(m->points.at(last).y == coordinate(g, 1, last));
                  CHECK(m->points.at(last).z == (dimensions == 3 ? coordinate(g, 2, last) : 0));
                  CHECK(d.time() == 12.5);
                  CHECK(d.fields().require("Density").array.get(3) == 3);
                  CHECK(d.fields().require("Momentum").array.get(3, 1) == 2003);
                  CHECK(d.fields().require("Momentum").array.get(3, 2) == (dimensions == 3 ? 3003 : 0));
                  CHECK(d.fields().require("StagnationEnergy").array.get(3) == (dimensions == 3 ? 4003 : 3003));
                  CHECK(d.fields().require("Density").array.type() == (real == 8 ? ElementType::f64 : ElementType::f32));
                  CHECK(d.fields().require("Properties").array.get(2) == 1e6);
                  CHECK(d.fields().require("Function1").array.get(2) == double(g) + 102);
                  CHECK((d.fields().find("IBlank") != nullptr) == iblank);
                  if (!iblank) continue;
                  CHECK(d.fields().require("IBlank").array.get(2) == -2);
                  CHECK(d.point_ghost().get(1) == ghost_hidden_point);
                  CHECK(d.point_ghost().get(2) == 0);
                  CHECK(d.cell_ghost().get(0) == ghost_hidden_cell);
                  CHECK(d.cell_ghost().get(d.cell_count() - 1) == 0);
                }
              }
  CHECK(forms == 72);
}

TEST_CASE("plot3d: NAMExyz.bin finds NAMEq.bin, and what does not fit the grid is left out with a warning") {
  const P3dWriting w{false, true};
  const Sizes s{{3, 3, 3}};
  const std::string root = write_case("p3d_pair", {{"wxyz.bin", grid_file(w, s)},
                                                   {"wq.bin", solution_file(w, s)},
                                                   {"vxyz.bin", grid_file(w, s)},
                                                   {"vq.bin", solution_file(w, {{3, 3, 2}})},
                                                   {"plain.bin", std::string(12345, 'x')}});
  CHECK(leaf(read_any(root + "wxyz.bin"), 0)->fields().find("Density") != nullptr);
  ReadOptions o;
  o.fields = {"Momentum"};
  CHECK(leaf(read_any(root + "wxyz.bin", o), 0)->fields().size() == 1);
  o.fields.clear(), o.header_only = true;
  CHECK(leaf(read_any(root + "wxyz.bin", o), 0)->fields().require("Momentum").array.stride_bytes() == 0);
  Context context;
  std::string said;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) said += std::string(text);
  };
  CHECK(leaf(read_data(root + "vxyz.bin", {}, context), 0)->fields().empty());
  CHECK(contains(said, "vq.bin is left out"));
  CHECK(contains(error_of([&] { read_any(root + "plain.bin"); }), "--dims"));  // a .bin of another kind stays a raw brick
}

TEST_CASE("plot3d: zeros that fill a solution to whole blocks are no numbers") {
  const P3dWriting w;
  const Sizes s{{3, 3, 3}};
  std::string q = solution_file(w, s);
  q.resize((q.size() + 511) / 512 * 512);
  CHECK(leaf(read_any(write_case("p3d_padded", {{"a.xyz", grid_file(w, s)}, {"a.q", q}}) + "a.xyz"), 0)->fields().find("Density") !=
        nullptr);
  q.back() = 1;
  CHECK(leaf(read_any(write_case("p3d_padded", {{"a.xyz", grid_file(w, s)}, {"a.q", q}}) + "a.xyz"), 0)->fields().empty());
}

TEST_CASE("plot3d: a meta file names the steps") {
  const P3dWriting w;
  CaseFiles files;
  for (const int n : {2, 3}) files[fmt::format("g{}.xyz", n)] = grid_file(w, {{n, 2, 2}});
  files["s.p3d"] = R"({"auto-detect-format": true, "filenames": [{"time": 5, "xyz": "g3.xyz"}, {"time": 1, "xyz": "g2.xyz"}]})";
  files["none.p3d"] = R"({"filenames": [{"time": 5, "xyz": "g9.xyz"}]})";
  files["odd.p3d"] = R"({"filenames": [{"time": 5, "q": "g9.xyz"}], "xyz": "xyz"})";
  files["wrong.p3d"] = R"({"filenames": [{"xyz": "g2.xyz", "q": "g3.xyz"}]})";
  const std::string root = write_case("p3d_meta", files);
  Context context;
  CHECK(file_times(root + "s.p3d", {}, context) == std::vector<double>{1, 5});
  CHECK(leaf(read_any(root + "s.p3d"), 0)->point_count() == 8);
  ReadOptions o;
  o.time = 4;
  CHECK(leaf(read_any(root + "s.p3d", o), 0)->point_count() == 12);
  CHECK(contains(error_of([&] { read_any(root + "none.p3d"); }), "g9.xyz"));
  CHECK(contains(error_of([&] { read_any(root + "odd.p3d"); }), "names no \"xyz\""));
  CHECK(contains(error_of([&] { read_any(root + "wrong.p3d"); }), "do not match the grid"));
}

TEST_CASE("plot3d: damaged files give an error or a valid grid") {
  const Sizes s{{4, 3, 2}, {2, 2, 2}};
  for (const P3dWriting& w : {P3dWriting{false, false, false, true, true}, P3dWriting{false, true, true, true, false, 3, 8},
                              P3dWriting{true, false, false, true}}) {
    const CaseFiles files{{"a.xyz", grid_file(w, s)}, {"a.q", solution_file(w, s)}, {"a.f", function_file(w, s, 1)}};
    const std::string name = fmt::format("p3d_damage{}{}", w.text, w.big);
    CHECK(cut_and_damage_case(name, files, "a.xyz", "a.xyz") >= 60);
    cut_and_damage_case(name, files, "a.q", "a.xyz");
    cut_and_damage_case(name, files, "a.f", "a.xyz");
  }
}

TEST_CASE("plot3d: sizes beyond what the file holds are no grid") {
  for (const int32_t n : {INT32_MAX, -1, 0, 65536}) {
    std::string s;
    for (int a = 0; a < 3; ++a) put_bytes(s, n);
    s += std::string(4096, '\1');
    CHECK(contains(error_of([&] { read_any(temp_file("absurd.xyz", s)); }), "content"));
  }
}
