// SPDX-License-Identifier: Apache-2.0
#include "base/bytes.h"
#include "data/lattice.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

std::string npy(const std::string& dict, const std::string& body, int version = 1) {
  std::string s = "\x93NUMPY";
  s += char(version), s += '\0';
  const std::string text = dict + "\n";
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i) s += char(text.size() >> (8 * i) & 255);
  return s + text + body;
}
std::string dict(const std::string& descr, const std::string& shape, bool fortran = false) {
  return "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" + shape + "), }";
}
template <class T>
std::string ramp(size_t n, bool big = false) {
  std::string s(n * sizeof(T), '\0');
  for (size_t i = 0; i < n; ++i) {
    T v = T(i);
    if (big) swap_bytes(&v, 1, sizeof v);
    std::memcpy(s.data() + i * sizeof v, &v, sizeof v);
  }
  return s;
}
double npy_value(const DatasetPtr& d, size_t i, int c = 0) { return d->fields().require("values").array.get(i, c); }

}  // namespace

TEST_CASE("npy: every type in both byte orders") {
  auto check = [](const std::string& descr, const std::string& body, ElementType type) {
    CAPTURE(descr);
    for (const int version : {1, 2, 3}) {
      const auto d = read_text("a.npy", npy(dict(descr, "2, 3, 4"), body, version));
      CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{4, 3, 2});
      CHECK(d->fields()[0].array.type() == type);
      for (size_t i = 0; i < 24; ++i) CHECK(npy_value(d, i) == double(i));
    }
  };
  check("|u1", ramp<uint8_t>(24), ElementType::u8);
  check("|i1", ramp<int8_t>(24), ElementType::i8);
  for (const bool big : {false, true}) {
    const std::string o = big ? ">" : "<";
    check(o + "u2", ramp<uint16_t>(24, big), ElementType::u16);
    check(o + "i2", ramp<int16_t>(24, big), ElementType::i16);
    check(o + "u4", ramp<uint32_t>(24, big), ElementType::u32);
    check(o + "i4", ramp<int32_t>(24, big), ElementType::i32);
    check(o + "u8", ramp<uint64_t>(24, big), ElementType::u64);
    check(o + "i8", ramp<int64_t>(24, big), ElementType::i64);
    check(o + "f4", ramp<float>(24, big), ElementType::f32);
    check(o + "f8", ramp<double>(24, big), ElementType::f64);
  }
}

TEST_CASE("npy: halves, truth values and complex numbers") {
  // 1, -2, 65504, smallest subnormal, infinity, -0
  const std::string half("\x00\x3c\x00\xc0\xff\x7b\x01\x00\x00\x7c\x00\x80", 12);
  auto d = read_text("h.npy", npy(dict("<f2", "6,"), half));
  CHECK(d->fields()[0].array.type() == ElementType::f32);
  CHECK(npy_value(d, 0) == 1);
  CHECK(npy_value(d, 1) == -2);
  CHECK(npy_value(d, 2) == 65504);
  CHECK(npy_value(d, 3) == std::ldexp(1.0, -24));
  CHECK(std::isinf(npy_value(d, 4)));
  CHECK(std::signbit(npy_value(d, 5)));
  d = read_text("h.npy", npy(dict("|b1", "2,"), std::string("\x00\x01", 2)));
  CHECK(npy_value(d, 1) == 1);
  d = read_text("h.npy", npy(dict("<c8", "2, 2"), ramp<float>(8)));
  CHECK(d->fields()[0].components() == 2);
  CHECK(npy_value(d, 3, 1) == 7);
}

TEST_CASE("npy: the memory order does not change which number is where") {
  // a[k][j][i][c] = 1000 k + 100 j + 10 i + c in both orders.
  for (const int components : {1, 3}) {
    const size_t nz = 2, ny = 3, nx = 4, nc = size_t(components);
    std::vector<int32_t> c_order, fortran(nz * ny * nx * nc);
    for (size_t k = 0; k < nz; ++k)
      for (size_t j = 0; j < ny; ++j)
        for (size_t i = 0; i < nx; ++i)
          for (size_t c = 0; c < nc; ++c) {
            const auto v = int32_t(1000 * k + 100 * j + 10 * i + c);
            c_order.push_back(v);
            fortran[k + nz * (j + ny * (i + nx * c))] = v;
          }
    auto bytes = [](const std::vector<int32_t>& v) { return std::string(reinterpret_cast<const char*>(v.data()), v.size() * 4); };
    const std::string shape = components == 1 ? "2, 3, 4" : "2, 3, 4, 3";
    const auto a = read_text("c.npy", npy(dict("<i4", shape), bytes(c_order)));
    const auto b = read_text("f.npy", npy(dict("<i4", shape, true), bytes(fortran)));
    CHECK(npy_value(a, 1 + 4 * (2 + 3 * 1), components - 1) == 1210 + components - 1);
    CHECK(same_array(a->fields()[0].array, b->fields()[0].array));
    ReadOptions o;
    o.region.lo = {1, 1, 0};
    o.region.stride = {2, 1, 1};
    const auto p = read_file(temp_folder() + "c.npy", o), q = read_file(temp_folder() + "f.npy", o);
    CHECK(lattice_dims(p->mesh()) == std::array<size_t, 3>{2, 2, 2});
    CHECK(npy_value(p, 3) == 230);
    CHECK(same_array(p->fields()[0].array, q->fields()[0].array));
  }
}

TEST_CASE("npy: numbers in C order and this byte order are mapped") {
  std::string d = dict("<f4", "3, 2");
  d.append(128 - 10 - d.size() - 1, ' ');
  const auto a = read_text("m.npy", npy(d, ramp<float>(6)));
  CHECK(reinterpret_cast<uintptr_t>(a->fields()[0].array.raw()) % 4096 == 128);
  CHECK(lattice_dims(a->mesh()) == std::array<size_t, 3>{2, 3, 1});
  CHECK(read_text("s.npy", npy(dict("<f8", ""), ramp<double>(1)))->point_count() == 1);
}

TEST_CASE("npy: what is written reads back the same") {
  Context context;
  for (const std::array<size_t, 3> dims : {std::array<size_t, 3>{5, 4, 3}, {5, 4, 1}, {5, 1, 1}})
    for (const int components : {1, 2})
      for (const ElementType t :
           {ElementType::u8, ElementType::i16, ElementType::u32, ElementType::i64, ElementType::f32, ElementType::f64}) {
        UniformGrid g;
        g.dims = dims;
        DatasetParts p;
        p.mesh = g;
        const size_t n = dims[0] * dims[1] * dims[2];
        std::vector<float> v(n * size_t(components));
        for (size_t i = 0; i < v.size(); ++i) v[i] = float(i);
        p.fields.add({"u", Association::point, Array::from_vector(v, components).converted(t), "", Role::none});
        const auto d = make_dataset(p);
        const std::string path = temp_folder() + "w.npy";
        write_data(path, d, {}, context);
        const auto r = read_file(path);
        CHECK(lattice_dims(r->mesh()) == dims);
        CHECK(same_array(r->fields()[0].array, d->fields()[0].array));
      }
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.npy", make_dataset(UniformGrid{}), {}, context); }), "no point field"));
  DatasetParts p;
  p.mesh = PointCloud{{Array::from_vector(std::vector<float>(9), 3), {}}};
  p.fields.add({"u", Association::point, Array::from_vector(std::vector<float>{4, 5, 6}), "", Role::none});
  write_data(temp_folder() + "w.npy", make_dataset(p), {}, context);
  CHECK(npy_value(read_file(temp_folder() + "w.npy"), 2) == 6);
}

TEST_CASE("npy: what cannot be read is said") {
  const std::string f4 = ramp<float>(6);
  CHECK(
      contains(refusal("b.npy", npy("{'descr': [('a', '<f4'), ('b', '<i4')], 'fortran_order': False, 'shape': (6,)}", f4)), "structured"));
  CHECK(contains(refusal("b.npy", npy(dict("<U4", "6,"), f4)), "'<U4' are not supported"));
  CHECK(contains(refusal("b.npy", npy(dict("|O", "6,"), f4)), "'|O' are not supported"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "1, 1, 1, 1, 6"), f4)), "5 axes"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "-1,"), f4)), "'-1' is not a valid size"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "0,"), f4)), "size is 0"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "9223372036854775807, 3"), f4)), "too large"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "2147483648"), f4)), "bytes are needed, but there are 24"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "2147483648", true), f4)), "bytes are needed, but there are 24"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "7,"), f4)), "28 bytes are needed, but there are 24"));
  CHECK(contains(refusal("b.npy", npy("{'descr': '<f4', 'shape': (6,)}", f4)), "no 'fortran_order'"));
  CHECK(contains(refusal("b.npy", npy("{'descr': '<f4', 'fortran_order': 0, 'shape': (6,)}", f4)), "use True or False"));
  CHECK(contains(refusal("b.npy", npy("{'descr': '<f4', 'fortran_order': False, 'shape': 6}", f4)), "'shape' is '6'"));
  CHECK(contains(refusal("b.npy", npy(dict("<f4", "6,"), f4, 4)), "version 4"));
  CHECK(contains(refusal("b.npy", "\x93NUMPY\x01" + std::string(1, '\0') + "\xff\xff{'descr'"), "65535 bytes"));
}

TEST_CASE("npy: cut and damaged files give errors, never crashes") {
  CHECK(cut_and_damage("cut.npy", npy(dict("<f4", "2, 3, 4"), ramp<float>(24))) == 63);
  CHECK(cut_and_damage("cut.npy", npy(dict(">f8", "2, 3, 4", true), ramp<double>(24, true))) == 63);
}
