// SPDX-License-Identifier: Apache-2.0
// One patient in the files of six formats: each voxel at the same place of the patient frame, whatever frame the file has. What the formats
// mean is spelled out here as ITK reads and writes them: physical space is LPS; NIfTI and MINC are RAS; NRRD says it; MetaImage's Offset
// and TransformMatrix are LPS, its AnatomicalOrientation names where axes come from; Analyze has a plane of slices (0: RPI).
#include <cstring>

#include "data/lattice.h"
#include "data/patient/patient_frame.h"
#include "io/io_files.h"
#include "io/netcdf/netcdf_bytes.h"
#include "io/volume/dicom_bytes.h"

using namespace sg;
using namespace sg::test;

namespace {

// The scan: 3 x 2 x 2 voxels of 0.5 x 2 x 3 mm, first one 10 mm right, 20 mm behind and 30 mm above the origin, rows to the left, columns
// to the back, slices to the head; the value of a voxel is its number.
constexpr Vec3 first{-10, 20, 30}, spacing{0.5, 2, 3};
constexpr size_t columns = 3, rows = 2, slices = 2;

Vec3 place(size_t i, size_t j, size_t k) { return first + Vec3(spacing.x * double(i), spacing.y * double(j), spacing.z * double(k)); }

void check_places(const Dataset& d) {
  REQUIRE(is_lattice(d.mesh()));
  const Lattice lattice(d.mesh());
  REQUIRE(lattice_dims(d.mesh()) == std::array<size_t, 3>{columns, rows, slices});
  const Array& a = d.fields()[0].array;
  for (size_t k = 0; k < slices; ++k)
    for (size_t j = 0; j < rows; ++j)
      for (size_t i = 0; i < columns; ++i) {
        CHECK(length(lattice.view().position(i, j, k) - place(i, j, k)) < 1e-6);
        CHECK(a.get(i + columns * (j + rows * k)) == double(i + columns * (j + rows * k)));
      }
  CHECK(in_patient_frame(d));
}

std::vector<int> numbers(size_t begin, size_t count) {
  std::vector<int> v;
  for (size_t i = 0; i < count; ++i) v.push_back(int(begin + i));
  return v;
}
const std::string voxels = stored(numbers(0, columns* rows* slices));  // little endian

template <class T>
void put(std::string& s, size_t at, T v) {
  std::memcpy(s.data() + at, &v, sizeof v);
}
std::string nifti_head(const char* magic) {
  std::string s(352, '\0');
  put(s, 0, int32_t(348));
  const int16_t dim[] = {3, columns, rows, slices, 1, 1, 1, 1};
  for (size_t i = 0; i < 8; ++i) put(s, 40 + 2 * i, dim[i]);
  put(s, 70, int16_t(4)), put(s, 72, int16_t(16));
  put(s, 76, 1.0f);
  for (int a = 0; a < 3; ++a) put(s, size_t(80 + 4 * a), float(spacing[a]));
  put(s, 108, 352.0f);
  std::memcpy(s.data() + 344, magic, std::strlen(magic));
  return s;
}

// The same scan in NIfTI: left is -x, back is -y.
std::string nifti() {
  std::string s = nifti_head("n+1");
  put(s, 254, int16_t(1));
  const double srow[3][4] = {{-0.5, 0, 0, 10}, {0, -2, 0, -20}, {0, 0, 3, 30}};
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 4; ++c) put(s, 280 + 16 * r + 4 * c, float(srow[r][c]));
  return s + voxels;
}

std::string nrrd(const std::string& space, const std::string& geometry) {
  return "NRRD0004\ntype: short\ndimension: 3\nspace: " + space + "\nsizes: 3 2 2\n" + geometry + "\nendian: little\nencoding: raw\n\n" +
         voxels;
}

std::string minc() {
  NcBytes f;
  const int z = f.dim("zspace", slices), y = f.dim("yspace", rows), x = f.dim("xspace", columns);
  f.var<int32_t>("rootvariable", {}, {0});
  f.var<double>("xspace", {}, {0}).num("start", {10.}).num("step", {-0.5});
  f.var<double>("yspace", {}, {0}).num("start", {-20.}).num("step", {-2.});
  f.var<double>("zspace", {}, {0}).num("start", {30.}).num("step", {3.});
  std::vector<int16_t> v;
  for (const int n : numbers(0, columns * rows * slices)) v.push_back(int16_t(n));
  f.var<int16_t>("image", {z, y, x}, v);
  f.att("signtype", "signed__");
  return f.bytes();
}

std::string dicom_folder() {
  const std::string folder = empty_folder("patient");
  for (size_t k = 0; k < slices; ++k) {
    SliceOptions o;
    o.number = int(k) + 1;
    // Rows and columns in DICOM's own words: spacing is 2\0.5 in these files.
    o.position = "-10\\20\\" + std::to_string(30 + 3 * k);
    o.pixels = stored(numbers(k * columns * rows, columns * rows));
    write_file(folder + "/" + std::to_string(k) + ".dcm", slice(o));
  }
  return folder;
}

const std::string lps_geometry = "space directions: (0.5,0,0) (0,2,0) (0,0,3)\nspace origin: (-10,20,30)";
const std::string ras_geometry = "space directions: (-0.5,0,0) (0,-2,0) (0,0,3)\nspace origin: (10,-20,30)";
const std::string las_geometry = "space directions: (0.5,0,0) (0,-2,0) (0,0,3)\nspace origin: (-10,-20,30)";

std::string metaimage(const std::string& orientation) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -10 20 30\n" + orientation +
         "ElementSpacing = 0.5 2 3\nDimSize = 3 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" + voxels;
}

std::string text_of(const std::string& path) { return std::string(MappedFile(path).text()); }

}  // namespace

TEST_CASE("patient frame: the same scan in six formats lies at the same place") {
  check_places(*read_text("p.nii", nifti()));
  check_places(*read_text("p.nrrd", nrrd("left-posterior-superior", lps_geometry)));
  check_places(*read_text("p.nrrd", nrrd("LPS", lps_geometry)));
  check_places(*read_text("p.nrrd", nrrd("right-anterior-superior", ras_geometry)));
  check_places(*read_text("p.nrrd", nrrd("Left-Anterior-Superior", las_geometry)));
  check_places(*read_text("p.mha", metaimage("AnatomicalOrientation = RAI\n")));
  check_places(*read_text("p.mnc", minc()));
  check_places(*read_file(dicom_folder()));
}

TEST_CASE("patient frame: a file that speaks of no patient keeps its numbers and gets no frame") {
  const auto meta = read_text("p.mha", metaimage(""));
  CHECK(!in_patient_frame(*meta));
  CHECK(meta->as<UniformGrid>()->origin == first);
  const auto n = read_text("p.nrrd", nrrd("3D-right-handed", ras_geometry));
  CHECK(!in_patient_frame(*n));
  CHECK(n->as<UniformGrid>()->origin == Vec3(10, -20, 30));
  CHECK(stated_space(*n) == "3D-right-handed");
}

TEST_CASE("patient frame: Analyze's six planes of slices are ITK's") {
  // Where the first, second and third axis of the file lead: the letters that are opposite to ITK's RPI, RIP, PIR, RAI, RSP, PIL.
  const char* leads[] = {"LAS", "LSA", "ASL", "LPS", "LIA", "ASR"};
  for (int orient = 0; orient < 6; ++orient) {
    std::string head = nifti_head("").substr(0, 348);
    put(head, 108, 0.0f);
    head[252] = char(orient);
    temp_file("a.hdr", head);
    temp_file("a.img", voxels);
    const auto d = read_file(temp_folder() + "a.hdr");
    CHECK(in_patient_frame(*d));
    CHECK(axis_letters(d->as<UniformGrid>()->direction) == leads[orient]);
  }
}

namespace {

// Whatever the order of its axes, each voxel of a file lies where one of the scan lies, moved by `moved`, and has its value.
void check_voxels(const Dataset& d, Vec3 moved) {
  REQUIRE(is_lattice(d.mesh()));
  const Lattice lattice(d.mesh());
  const auto n = lattice_dims(d.mesh());
  const Array& a = d.fields()[0].array;
  REQUIRE(n[0] * n[1] * n[2] == columns * rows * slices);
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) {
        const Vec3 at = lattice.view().position(i, j, k) - moved - first;
        const Vec3 number(std::round(at.x / spacing.x), std::round(at.y / spacing.y), std::round(at.z / spacing.z));
        CHECK(length(at - Vec3(number.x * spacing.x, number.y * spacing.y, number.z * spacing.z)) < 1e-5);
        CHECK(a.get(i + n[0] * (j + n[1] * k)) == number.x + double(columns) * (number.y + double(rows) * number.z));
      }
  CHECK(in_patient_frame(d));
}

DatasetPtr moved_by(const DatasetPtr& d, Vec3 by) {
  UniformGrid g = *d->as<UniformGrid>();
  g.origin = g.origin + by;
  DatasetParts parts;
  parts.mesh = g;
  parts.fields = d->fields();
  note_patient_frame(parts);
  return make_dataset(std::move(parts));
}

std::string warnings_of_writing(const std::string& path, const DatasetPtr& d) {
  std::string said;
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) said += text;
  };
  write_data(path, d, {}, context);
  return said;
}

}  // namespace

TEST_CASE("patient frame: through all formats that are written every voxel keeps its place in the patient") {
  Context context;
  const auto scan = read_file(dicom_folder());
  const char* ways[] = {"nii", "nii.gz", "nrrd", "mha", "mnc", "dcm"};
  for (const std::string a : ways)
    for (const std::string b : ways) {
      CAPTURE(a);
      CAPTURE(b);
      write_data(temp_folder() + "1." + a, scan, {}, context);
      write_data(temp_folder() + "2." + b, read_file(temp_folder() + "1." + a), {}, context);
      check_places(*read_file(temp_folder() + "2." + b));
    }
  // Analyze has places of whole voxels near the volume, and says what it drops.
  const Vec3 near = Vec3(-0.5, -2, -3) - first;
  for (const std::string a : ways) {
    CAPTURE(a);
    write_data(temp_folder() + "1." + a, moved_by(scan, near), {}, context);
    CHECK(warnings_of_writing(temp_folder() + "2.hdr", read_file(temp_folder() + "1." + a)).find("origin") == std::string::npos);
    check_voxels(*read_file(temp_folder() + "2.hdr"), near);
    check_voxels(*read_file(temp_folder() + "2.img"), near);
    write_data(temp_folder() + "3." + a, read_file(temp_folder() + "2.hdr"), {}, context);
    check_voxels(*read_file(temp_folder() + "3." + a), near);
  }
  CHECK(contains(warnings_of_writing(temp_folder() + "4.hdr", scan), "drops the origin"));
  CHECK(contains(warnings_of_writing(temp_folder() + "4.hdr", moved_by(scan, near + Vec3(0.2, 0, 0))), "moves the origin by 0.2 mm"));
  // In the file: NIfTI's matrix is RAS, MetaImage's offset LPS, NRRD says what it is.
  write_data(temp_folder() + "w.nii", scan, {}, context);
  const std::string n = text_of(temp_folder() + "w.nii");
  const float want[12] = {-0.5f, 0, 0, 10, 0, -2, 0, -20, 0, 0, 3, 30};
  CHECK(std::memcmp(n.data() + 280, want, sizeof want) == 0);
  write_data(temp_folder() + "w.mha", scan, {}, context);
  CHECK(contains(text_of(temp_folder() + "w.mha"), "AnatomicalOrientation = RAI\n"));
  CHECK(contains(text_of(temp_folder() + "w.mha"), "Offset = -10 20 30\n"));
  write_data(temp_folder() + "w.nrrd", scan, {}, context);
  CHECK(contains(text_of(temp_folder() + "w.nrrd"), "space: left-posterior-superior\n"));
  CHECK(contains(text_of(temp_folder() + "w.nrrd"), "space origin: (-10,20,30)\n"));
}

TEST_CASE("patient frame: oblique, leaning and mirrored scans keep their places in the formats that can say so") {
  Context context;
  UniformGrid g;
  g.dims = {4, 3, 5}, g.spacing = {1.5, 0.75, 2.25}, g.origin = {-31.25, 12.5, 80.125};
  const double c = std::cos(0.4), s = std::sin(0.4);
  const Mat3 oblique{{{c * c, -s, c * s}, {s * c, c, s * s}, {-s, 0, c}}};
  Mat3 leaning = oblique, mirrored = oblique;
  for (int r = 0; r < 3; ++r) {
    leaning.m[r][2] = 0.96 * oblique.m[r][2] + 0.28 * oblique.m[r][1];
    mirrored.m[r][2] = -oblique.m[r][2];
  }
  std::vector<float> v(60);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i) - 7;
  for (const Mat3& direction : {oblique, leaning, mirrored})
    for (const std::string way : {"nii", "nrrd", "mha", "mnc", "dcm"}) {
      CAPTURE(way);
      g.direction = direction;
      DatasetParts parts;
      parts.mesh = g;
      parts.fields.add({"T", Association::point, Array::from_vector(v), "", Role::scalars});
      note_patient_frame(parts);
      const DatasetPtr in = make_dataset(std::move(parts));
      write_data(temp_folder() + "oblique." + way, in, {}, context);
      const DatasetPtr out = read_file(temp_folder() + "oblique." + way);
      const Lattice from(in->mesh()), to(out->mesh());
      REQUIRE(lattice_dims(out->mesh()) == g.dims);
      for (size_t k = 0; k < 5; ++k)
        for (size_t i = 0; i < 12; ++i) {
          // Readers of slices sort them along their normal.
          const double value = out->fields()[0].array.get(12 * k + i);
          const auto at = size_t(value + 7.5);
          REQUIRE(at < 60);
          CHECK(at % 12 == i);
          CHECK(length(to.view().position(i % 4, i / 4, k) - from.view().position(i % 4, i / 4, at / 12)) < 2e-5);
        }
    }
  // Analyze has the patient's axes alone.
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"T", Association::point, Array::from_vector(v), "", Role::scalars});
  note_patient_frame(parts);
  CHECK(contains(warnings_of_writing(temp_folder() + "oblique.hdr", make_dataset(std::move(parts))), "drops a turn of 3"));
}

TEST_CASE("patient frame: vectors and tensors turn with it") {
  // One voxel; RAS components 1 2 3 are LPS -1 -2 3.
  const std::string head = "NRRD0005\ntype: float\ndimension: 4\nspace: RAS\n";
  const std::string geometry = "space directions: none (1,0,0) (0,1,0) (0,0,1)\n";
  auto d = read_text("v.nrrd", head + "sizes: 3 1 1 1\n" + geometry + "kinds: 3-vector domain domain domain\nencoding: ascii\n\n1 2 3\n");
  const auto components = [&] {
    std::vector<double> v;
    for (int c = 0; c < d->fields()[0].components(); ++c) v.push_back(d->fields()[0].array.get(0, c));
    return v;
  };
  CHECK(components() == std::vector<double>{-1, -2, 3});
  // A measurement frame of a quarter turn about z: what was measured along its first axis is along y of the file, and along -y of ours.
  d = read_text("v.nrrd", head + "measurement frame: (0,1,0) (-1,0,0) (0,0,1)\nsizes: 3 1 1 1\n" + geometry +
                              "kinds: 3-vector domain domain domain\nencoding: ascii\n\n1 0 0\n");
  CHECK(components() == std::vector<double>{0, -1, 0});
  // R D R^T with R = diag(-1, -1, 1): xz and yz change their signs.
  d = read_text("t.nrrd",
                head + "sizes: 6 1 1 1\n" + geometry + "kinds: 3D-symmetric-matrix domain domain domain\nencoding: ascii\n\n1 2 3 4 5 6\n");
  CHECK(components() == std::vector<double>{1, 2, -3, 2, 4, -5, -3, -5, 6});
  // Written and read, in files of either frame.
  Context context;
  for (const char* name : {"t.nrrd", "t.nii"}) {
    write_data(temp_folder() + name, d, {}, context);
    d = read_file(temp_folder() + name);
    CHECK(components() == std::vector<double>{1, 2, -3, 2, 4, -5, -3, -5, 6});
  }
}

TEST_CASE("patient frame: letters") {
  CHECK(patient_letters({1, 0, 0}) == "L");
  CHECK(patient_letters({0, -2, 0}) == "A");
  CHECK(patient_letters({0.1, 0.1, -1}) == "I");
  CHECK(patient_letters({-0.8, 0.6, 0.1}) == "RP");
  CHECK(patient_letters({0, 0, 0}).empty());
  Mat3 m;
  CHECK(axis_letters(m) == "LPS");
  m.m[0][0] = 0.1, m.m[1][0] = -0.99, m.m[0][1] = -0.99, m.m[1][1] = -0.1;
  CHECK(axis_letters(m) == "ARS");
}
