// SPDX-License-Identifier: Apache-2.0
#include "base/bytes.h"
#include "data/lattice.h"
#include "data/patient/patient_frame.h"
#include "io/bytes/inflate.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

// A header with what a test needs, in either byte order.
struct Nifti {
  bool big = false, two = false;
  std::vector<int64_t> dim{3, 2, 3, 2};
  int datatype = 4;
  std::array<double, 8> pixdim{1, 1, 1, 1, 1, 1, 1, 1};
  double slope = 0, intercept = 0, begin = 352, toffset = 0;
  int qform = 0, sform = 0, intent = 0;
  std::array<double, 6> q{};  // quatern b c d, offset x y z
  std::array<double, 12> srow{};
  std::string magic = "n+1";

  template <class T>
  void put(std::string& s, size_t at, T v) const {
    if (big) swap_bytes(&v, 1, sizeof v);
    std::memcpy(s.data() + at, &v, sizeof v);
  }
  std::string head() const {
    if (two) return head_2();
    std::string s(352, '\0');
    put(s, 0, int32_t(348));
    for (size_t i = 0; i < dim.size(); ++i) put(s, 40 + 2 * i, int16_t(dim[i]));
    put(s, 68, int16_t(intent)), put(s, 70, int16_t(datatype));
    for (size_t i = 0; i < 8; ++i) put(s, 76 + 4 * i, float(pixdim[i]));
    put(s, 108, float(begin)), put(s, 112, float(slope)), put(s, 116, float(intercept)), put(s, 136, float(toffset));
    put(s, 252, int16_t(qform)), put(s, 254, int16_t(sform));
    for (size_t i = 0; i < 6; ++i) put(s, 256 + 4 * i, float(q[i]));
    for (size_t i = 0; i < 12; ++i) put(s, 280 + 4 * i, float(srow[i]));
    std::memcpy(s.data() + 344, magic.data(), magic.size());
    return s;
  }
  std::string head_2() const {
    std::string s(544, '\0');
    put(s, 0, int32_t(540));
    std::memcpy(s.data() + 4, "n+2\0\r\n\x1a\n", 8);
    put(s, 12, int16_t(datatype));
    for (size_t i = 0; i < dim.size(); ++i) put(s, 16 + 8 * i, dim[i]);
    for (size_t i = 0; i < 8; ++i) put(s, 104 + 8 * i, pixdim[i]);
    put(s, 168, int64_t(544)), put(s, 176, slope), put(s, 184, intercept), put(s, 216, toffset);
    put(s, 344, int32_t(qform)), put(s, 348, int32_t(sform));
    for (size_t i = 0; i < 6; ++i) put(s, 352 + 8 * i, q[i]);
    for (size_t i = 0; i < 12; ++i) put(s, 400 + 8 * i, srow[i]);
    put(s, 504, int32_t(intent));
    return s;
  }
  // 0, 1, 2, ... as the datatype.
  std::string ramp(size_t n) const {
    std::string s;
    for (size_t i = 0; i < n; ++i) {
      std::string v(datatype == 4 ? 2 : datatype == 2 ? 1 : datatype == 64 ? 8 : 4, '\0');
      if (datatype == 2) v[0] = char(i);
      else if (datatype == 4) put(v, 0, int16_t(i));
      else if (datatype == 8) put(v, 0, int32_t(i));
      else if (datatype == 16) put(v, 0, float(i));
      else put(v, 0, double(i));
      s += v;
    }
    return s;
  }
  std::string file(size_t n) const { return head() + ramp(n); }
};

std::string gzipped(const std::string& s) {
  const auto p = pack_gzip({reinterpret_cast<const std::byte*>(s.data()), s.size()});
  return {reinterpret_cast<const char*>(p.data()), p.size()};
}

// Of a voxel in NIfTI's own world: right, anterior, superior.
Vec3 position(const DatasetPtr& d, size_t i, size_t j, size_t k) {
  const Vec3 lps = Lattice(d->mesh()).view().position(i, j, k);
  return in_patient_frame(*d) ? Vec3{-lps.x, -lps.y, lps.z} : lps;
}
double nifti_value(const DatasetPtr& d, size_t i, int c = 0) { return d->fields().require("NIFTI").array.get(i, c); }

}  // namespace

TEST_CASE("nifti: both versions, both byte orders, plain and gzip give the same volume") {
  for (const bool two : {false, true})
    for (const bool big : {false, true})
      for (const int type : {2, 4, 8, 16, 64})
        for (const bool zip : {false, true}) {
          Nifti n;
          n.two = two, n.big = big, n.datatype = type;
          n.pixdim = {1, 0.5, 2, 3, 1, 1, 1, 1};
          const std::string bytes = n.file(12);
          const auto d = read_text(zip ? "v.nii.gz" : "v.nii", zip ? gzipped(bytes) : bytes);
          CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{2, 3, 2});
          CHECK(d->as<UniformGrid>()->spacing == Vec3(0.5, 2, 3));
          for (size_t i = 0; i < 12; ++i) CHECK(nifti_value(d, i) == double(i));
          CHECK(int(element_size(d->fields()[0].array.type())) == int(n.ramp(1).size()));
        }
}

TEST_CASE("nifti: a voxel lands where the sform says, sheared or not") {
  Nifti n;
  n.sform = 1;
  n.srow = {-2, 0.25, 0, 10, 0, 3, 0.5, -20, 0.125, 0, 4, 30};
  const auto d = read_text("s.nii", n.file(12));
  for (size_t k = 0; k < 2; ++k)
    for (size_t j = 0; j < 3; ++j)
      for (size_t i = 0; i < 2; ++i) {
        const double x = double(i), y = double(j), z = double(k);
        const Vec3 want(-2 * x + 0.25 * y + 10, 3 * y + 0.5 * z - 20, 0.125 * x + 4 * z + 30);
        CHECK(length(position(d, i, j, k) - want) < 1e-12);
      }
  bool told = false;
  for (const auto& [key, text] : d->notes()) told = told || key == "shear";
  CHECK(told);
}

TEST_CASE("nifti: a voxel lands where the quaternion says, with qfac") {
  Nifti n;
  n.qform = 1;
  const double half = std::sqrt(0.5);
  n.q = {0, 0, half, 5, 6, 7};  // a quarter turn about z: x -> y, y -> -x
  n.pixdim = {-1, 2, 3, 4, 1, 1, 1, 1};
  auto d = read_text("q.nii", n.file(12));
  CHECK(length(position(d, 1, 0, 0) - Vec3(5, 8, 7)) < 1e-6);
  CHECK(length(position(d, 0, 1, 0) - Vec3(2, 6, 7)) < 1e-6);
  CHECK(length(position(d, 0, 0, 1) - Vec3(5, 6, 3)) < 1e-6);
  n.q = {1, 0, 0, 0, 0, 0};  // half a turn about x
  n.pixdim[0] = 1;
  d = read_text("q.nii", n.file(12));
  CHECK(length(position(d, 1, 1, 1) - Vec3(2, -3, -4)) < 1e-6);
  n.sform = 1;  // a matrix of zeros is no orientation: the quaternion counts
  d = read_text("q.nii", n.file(12));
  CHECK(length(position(d, 1, 1, 1) - Vec3(2, -3, -4)) < 1e-6);
}

TEST_CASE("nifti: slope and intercept are applied, in double where the stored numbers need it") {
  Nifti n;
  n.slope = 0.5, n.intercept = -1;
  auto d = read_text("s.nii", n.file(12));
  CHECK(d->fields()[0].array.type() == ElementType::f32);
  for (size_t i = 0; i < 12; ++i) CHECK(nifti_value(d, i) == 0.5 * double(i) - 1);
  n.datatype = 8;
  CHECK(read_text("s.nii", n.file(12))->fields()[0].array.type() == ElementType::f64);
  n.datatype = 4;
  n.slope = 0;  // says: not scaled
  CHECK(read_text("s.nii", n.file(12))->fields()[0].array.type() == ElementType::i16);
  n.slope = std::nan("");
  CHECK(nifti_value(read_text("s.nii", n.file(12)), 11) == 11);
}

TEST_CASE("nifti: the fourth axis is time, one step at a time") {
  for (const bool zip : {false, true}) {
    Nifti n;
    n.dim = {4, 2, 3, 2, 4};
    n.pixdim[4] = 2.5;
    n.toffset = 1;
    const std::string path = temp_file(zip ? "t.nii.gz" : "t.nii", zip ? gzipped(n.file(48)) : n.file(48));
    Context context;
    CHECK(file_times(path, {}, context) == std::vector<double>{1, 3.5, 6, 8.5});
    for (int step = 0; step < 4; ++step) {
      ReadOptions o;
      o.step = step;
      const auto d = read_file(path, o);
      CHECK(d->time() == 1 + 2.5 * step);
      for (size_t i = 0; i < 12; ++i) CHECK(nifti_value(d, i) == double(step) * 12 + double(i));
    }
    ReadOptions o;
    o.time = 5.5;
    CHECK(nifti_value(read_file(path, o), 0) == 24);
    o.step = 4;
    CHECK(contains(error_of([&] { read_file(path, o); }), "no time step 4"));
  }
}

TEST_CASE("nifti: diffusion directions come along as whole fields") {
  Nifti n;
  n.dim = {4, 2, 3, 2, 4};
  const std::string path = temp_file("dwi.nii", n.file(48));
  temp_file("dwi.bval", "0 1000 1000 2000\n");
  temp_file("dwi.bvec", "0 1 0 0.6\n0 0 1 0.8\n0 0 0 0\n");
  auto d = read_file(path);
  CHECK(d->fields().require("bval", Association::whole).array.get(3) == 2000);
  const Array& v = d->fields().require("bvec", Association::whole).array;
  CHECK(v.get(3, 0) == 0.6);
  CHECK(v.get(3, 1) == 0.8);
  temp_file("dwi.bvec", "nan nan nan\n1 0 0\n0 1 0\n0.6 0.8 0\n");
  CHECK(read_file(path)->fields().require("bvec").array.get(3, 1) == 0.8);
  temp_file("dwi.bval", "0 1000 what 2000\n");
  CHECK(read_file(path)->fields().find("bval") == nullptr);
}

TEST_CASE("nifti: the fifth axis is components") {
  Nifti n;
  n.dim = {5, 2, 3, 2, 1, 3};
  n.intent = 1007;
  auto d = read_text("v.nii", n.file(36));
  CHECK(d->fields()[0].role == Role::vectors);
  CHECK(nifti_value(d, 5, 2) == 29);
  n.dim[5] = 6;
  n.intent = 1005;  // xx xy yy xz yz zz
  d = read_text("v.nii", n.file(72));
  CHECK(d->fields()[0].role == Role::tensors);
  const int order[9] = {0, 1, 3, 1, 2, 4, 3, 4, 5};
  // From right-anterior-superior to ours: xz and yz change their signs.
  for (int c = 0; c < 9; ++c) CHECK(nifti_value(d, 7, c) == (c % 4 && c != 1 && c != 3 ? -1 : 1) * (order[c] * 12 + 7));
  n.dim = {5, 2, 3, 2, 2, 2};
  n.intent = 0;
  n.big = true;
  ReadOptions o;
  o.step = 1;
  d = read_text("v.nii", n.file(48), o);
  CHECK(nifti_value(d, 0, 0) == 12);
  CHECK(nifti_value(d, 0, 1) == 36);
  n = Nifti{};
  n.datatype = 128;
  std::string rgb;
  for (int i = 0; i < 36; ++i) rgb += char(i);
  d = read_text("c.nii", n.head() + rgb);
  CHECK(d->fields()[0].role == Role::colors);
  CHECK(nifti_value(d, 3, 1) == 10);
}

TEST_CASE("nifti: zero in the place of dimensions or sizes means one") {
  Nifti n;
  n.dim = {0, 1, 1, 1, 0, 1};
  n.datatype = 16;
  CHECK(read_text("o.nii", n.file(1))->point_count() == 1);
  n.dim = {4, 2, 3, 2, 0};
  CHECK(read_text("o.nii", n.file(12))->point_count() == 12);
}

TEST_CASE("nifti: a pair of header and image, and Analyze without a magic") {
  Nifti n;
  n.begin = 0;
  n.magic = "ni1";
  temp_file("pair.hdr", n.head().substr(0, 348));
  CHECK(contains(error_of([] { read_file(temp_folder() + "pair.hdr"); }), "no data"));
  temp_file("pair.img", n.ramp(12));
  CHECK(nifti_value(read_file(temp_folder() + "pair.hdr"), 11) == 11);
  CHECK(nifti_value(read_file(temp_folder() + "pair.img"), 11) == 11);
  n.magic = "";
  n.big = true;
  n.sform = 1;  // means nothing here
  temp_file("old.hdr", n.head().substr(0, 348));
  temp_file("old.img.gz", gzipped(n.ramp(12)));
  CHECK(nifti_value(read_file(temp_folder() + "old.hdr"), 11) == 11);
  CHECK(nifti_value(read_file(temp_folder() + "old.img.gz"), 11) == 11);
  CHECK(contains(refusal("alone.img", "0123456789"), "header of the .img file is missing"));
}

TEST_CASE("nifti: a region reads the same points as cutting afterwards") {
  for (const bool zip : {false, true})
    for (const bool big : {false, true}) {
      Nifti n;
      n.dim = {4, 7, 6, 5, 2};
      n.big = big;
      const std::string path = temp_file(zip ? "r.nii.gz" : "r.nii", zip ? gzipped(n.file(420)) : n.file(420));
      ReadOptions o;
      o.step = 1;
      o.region.lo = {1, 0, 2};
      o.region.hi = {6, 4, 4};
      o.region.stride = {2, 3, 1};
      const auto d = read_file(path, o);
      CHECK(lattice_dims(d->mesh()) == std::array<size_t, 3>{3, 2, 3});
      size_t at = 0;
      for (size_t k = 2; k < 5; ++k)
        for (size_t j = 0; j < 5; j += 3)
          for (size_t i = 1; i < 7; i += 2) CHECK(nifti_value(d, at++) == double(210 + i + 7 * (j + 6 * k)));
      CHECK(position(d, 1, 1, 1) == Vec3(3, 3, 3));
      o.region.lo = {7, 0, 0};
      CHECK(contains(error_of([&] { read_file(path, o); }), "axis x"));
    }
}

TEST_CASE("nifti: what is written reads back the same") {
  DatasetParts p;
  UniformGrid g;
  g.dims = {5, 4, 3};
  g.origin = {1, -2, 3};
  g.spacing = {0.5, 0.25, 2};
  g.direction.m[0][0] = 0, g.direction.m[1][0] = 1, g.direction.m[0][1] = -1, g.direction.m[1][1] = 0;
  p.mesh = g;
  p.notes = {{"space", "left-posterior-superior"}, {"length unit", "mm"}, {"description", "a test"}};
  std::vector<float> v(180);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i) * 0.37f;
  Context context;
  for (const int components : {1, 3})
    for (const char* name : {"w.nii", "w.nii.gz"}) {
      p.fields = {};
      p.fields.add({"u", Association::point, Array::from_vector(std::vector<float>(v.begin(), v.begin() + 60 * components), components), "",
                    Role::none});
      const auto d = make_dataset(p);
      write_data(temp_folder() + name, d, {}, context);
      const auto r = read_file(temp_folder() + name);
      CHECK(same_array(r->fields()[0].array, d->fields()[0].array));
      const Vec3 there = position(d, 4, 2, 1), back = position(r, 4, 2, 1);
      CHECK(length(back - there) < 1e-12);
      CHECK(r->as<UniformGrid>()->spacing == g.spacing);
    }
  for (const ElementType t : {ElementType::u8, ElementType::i8, ElementType::u16, ElementType::i16, ElementType::u32, ElementType::i32,
                              ElementType::u64, ElementType::i64, ElementType::f32, ElementType::f64}) {
    p.fields = {};
    p.fields.add({"u", Association::point, Array::from_vector(std::vector<float>(v.begin(), v.begin() + 60)).converted(t), "", Role::none});
    const auto d = make_dataset(p);
    write_data(temp_folder() + "w.nii", d, {}, context);
    CHECK(same_array(read_file(temp_folder() + "w.nii")->fields()[0].array, d->fields()[0].array));
  }
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.hdr.gz", make_dataset(p), {}, context); }), "name it .hdr or .img"));
  p.fields = {};
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.nii", make_dataset(p), {}, context); }), "no point field"));
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.nii", make_dataset(PointCloud{}), {}, context); }), "uniform grid"));
  g.dims = {40000, 1, 1};
  p.mesh = g;
  p.fields.add({"u", Association::point, Array::from_vector(std::vector<float>(40000)), "", Role::none});
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.nii", make_dataset(p), {}, context); }), "32767"));
}

TEST_CASE("nifti: bad headers are refused before memory is asked for") {
  auto refused = [](auto change, const char* why) {
    Nifti n;
    change(n);
    const std::string bytes = n.file(12);
    CAPTURE(why);
    CHECK(contains(refusal("b.nii", bytes), why));
    CHECK(refusal("b.nii.gz", gzipped(bytes)) != "");
  };
  refused([](Nifti& n) { n.dim[0] = 8; }, "8 dimensions");
  refused([](Nifti& n) { n.dim[2] = -3; }, "dim[2] is -3");
  refused([](Nifti& n) { n.dim[1] = 30000, n.dim[2] = 30000, n.dim[3] = 30000; }, "too short");
  refused([](Nifti& n) { n.two = true, n.dim[1] = int64_t(1) << 31, n.dim[2] = int64_t(1) << 31; }, "too large");
  refused([](Nifti& n) { n.two = true, n.dim[1] = INT64_MAX; }, "too large");
  refused([](Nifti& n) { n.two = true, n.dim[1] = -1; }, "dim[1] is -1");
  refused([](Nifti& n) { n.datatype = 7; }, "datatype 7");
  refused([](Nifti& n) { n.datatype = 1536; }, "128 bits");
  refused([](Nifti& n) { n.datatype = 1; }, "one bit");
  refused([](Nifti& n) { n.begin = -5; }, "byte 108");
  refused([](Nifti& n) { n.begin = 1e30; }, "byte 108");
  refused([](Nifti& n) { n.begin = 400; }, "too short");
}

TEST_CASE("nifti: cut and damaged files give errors, never crashes") {
  Nifti n;
  n.dim = {4, 2, 3, 2, 2};
  n.sform = 1;
  n.srow = {2, 0, 0, 1, 0, 2, 0, 1, 0, 0, 2, 1};
  CHECK(cut_and_damage("cut.nii", n.file(24)) == 63);
  n.two = true;
  CHECK(cut_and_damage("cut.nii", n.file(24)) == 63);
  CHECK(cut_and_damage("cut.nii.gz", gzipped(n.file(24))) >= 50);  // the end holds the second step
  // Each of the first 200 bytes, three ways.
  n.two = false;
  Context context;
  for (size_t k = 0; k < 260; ++k)
    for (const int flip : {1, 0x80, 0xff}) {
      std::string bytes = n.file(24);
      bytes[k] = char(bytes[k] ^ flip);
      const std::string path = temp_file("flip.nii", bytes);
      try {
        read_data(path, {}, context);
      } catch (const Error& e) {
        CHECK(e.kind() == ErrorKind::data);
      }
    }
}
