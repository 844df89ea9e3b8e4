// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "io/io_files.h"

#include "io/bytes/inflate.h"

using namespace sg;
using namespace sg::test;

namespace {
const std::string mhd_head = "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\n";
std::string shorts(bool big) {
  std::string s;
  for (int i = 0; i < 12; ++i) {
    const int v = i * 1000 - 3000;
    const char lo = char(v & 255), hi = char(v >> 8 & 255);
    s += big ? hi : lo, s += big ? lo : hi;
  }
  return s;
}
bool is_ramp(const DatasetPtr& d) {
  const Array& a = d->fields().require("MetaImage").array;
  for (size_t i = 0; i < 12; ++i)
    if (a.get(i) != double(i) * 1000 - 3000) return false;
  return a.count() == 12;
}
}  // namespace

TEST_CASE("metaimage: local, separate, listed, numbered and packed data are the same numbers") {
  CHECK(is_ramp(read_text("m.mha", mhd_head + "ElementType = MET_SHORT\nElementDataFile = LOCAL\n" + shorts(false))));
  CHECK(is_ramp(
      read_text("m.mha", mhd_head + "ElementByteOrderMSB = True\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" + shorts(true))));
  CHECK(is_ramp(
      read_text("m.mha", mhd_head + "BinaryDataByteOrderMSB = True\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" + shorts(true))));
  temp_file("m.raw", "0123456789" + shorts(false));
  CHECK(is_ramp(read_text("m.mhd", mhd_head + "ElementType = MET_SHORT\nHeaderSize = 10\nElementDataFile = m.raw\n")));
  CHECK(is_ramp(read_text("m.mhd", mhd_head + "ElementType = MET_SHORT\nHeaderSize = -1\nElementDataFile = m.raw\n")));
  temp_file("m_1.raw", shorts(false).substr(0, 12));
  temp_file("m_2.raw", shorts(false).substr(12));
  CHECK(is_ramp(read_text("m.mhd", mhd_head + "ElementType = MET_SHORT\nElementDataFile = LIST\nm_1.raw\nm_2.raw\n")));
  CHECK(is_ramp(read_text("m.mhd", mhd_head + "ElementType = MET_SHORT\nElementDataFile = LIST 2D\nm_1.raw\nm_2.raw\n")));
  CHECK(is_ramp(read_text("m.mhd", mhd_head + "ElementType = MET_SHORT\nElementDataFile = m_%d.raw 1 2 1\n")));
  CHECK(is_ramp(read_text("m.mhd", mhd_head + "ElementType = MET_SHORT\nElementDataFile = m_%d.raw\n")));
  CHECK(is_ramp(read_text("m.mha", mhd_head +
                                       "BinaryData = False\nElementType = MET_SHORT\nElementDataFile = LOCAL\n-3000 -2000 -1000 0 1000 "
                                       "2000\n3000 4000 5000 6000 7000 8000\n")));
  const std::string s = shorts(false);
  const auto packed = pack_gzip({reinterpret_cast<const std::byte*>(s.data()), s.size()});
  CHECK(is_ramp(read_text("m.mha", mhd_head + "CompressedData = True\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
                                       std::string(reinterpret_cast<const char*>(packed.data()), packed.size()))));
}

TEST_CASE("metaimage: geometry, channels and further axes") {
  auto d = read_text(
      "g.mha",
      "NDims = 3\nDimSize = 2 1 1\nElementSpacing = 2 3 4\nPosition = 5 6 7\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nModality = MET_MOD_CT\n"
      "ElementNumberOfChannels = 3\nElementType = MET_FLOAT_ARRAY\nBinaryData = False\nElementDataFile = LOCAL\n1 2 3 4 5 6\n");
  const auto* g = d->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->spacing == Vec3(2, 3, 4));
  CHECK(g->origin == Vec3(5, 6, 7));
  CHECK(g->direction.column(0) == Vec3(0, 1, 0));  // three numbers after another are one axis
  CHECK(g->direction.column(1) == Vec3(-1, 0, 0));
  CHECK(d->fields()[0].components() == 3);
  CHECK(d->fields()[0].role == Role::vectors);
  CHECK(d->fields()[0].array.get(1, 2) == 6);
  CHECK(std::find(d->notes().begin(), d->notes().end(), std::pair<std::string, std::string>("Modality", "MET_MOD_CT")) != d->notes().end());
  d = read_text("g.mha",
                "NDims = 4\nDimSize = 2 1 1 3\nElementSpacing = 1 1 1 1\nElementType = MET_UCHAR\nBinaryData = False\nElementDataFile = "
                "LOCAL\n1 2 3 4 5 6\n");
  CHECK(d->point_count() == 2);
  CHECK(d->fields()[0].components() == 3);
  CHECK(d->fields()[0].array.get(1, 2) == 6);
  d = read_text("g.mhd",
                "NDims = 2\nDimSize = 3 2\nElementSize = 0.5 0.25\nElementType = MET_DOUBLE\nBinaryData = False\nElementDataFile = "
                "LOCAL\n1 2 3 4 5 6\n");
  CHECK(d->as<UniformGrid>()->dims == std::array<size_t, 3>{3, 2, 1});
  CHECK(d->as<UniformGrid>()->spacing == Vec3(0.5, 0.25, 1));
}

TEST_CASE("metaimage: what is written reads back the same, with the field's name") {
  DatasetParts p;
  UniformGrid g;
  g.dims = {5, 4, 3};
  g.origin = {0.1, -2e7, 3};
  g.spacing = {0.5, 0.1, 2};
  g.direction.m[0][0] = 0, g.direction.m[1][0] = 1, g.direction.m[0][1] = -1, g.direction.m[1][1] = 0;
  p.mesh = g;
  p.notes = {{"Modality", "MET_MOD_CT"}};
  std::vector<float> v(180);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i) * 0.37f;
  Context context;
  for (const int components : {1, 3})
    for (const char* compression : {"none", "zlib"})
      for (const char* name : {"w.mha", "w.mhd"}) {
        p.fields = {};
        p.fields.add({"wind speed", Association::point,
                      Array::from_vector(std::vector<float>(v.begin(), v.begin() + 60 * components), components), "",
                      components == 3 ? Role::vectors : Role::scalars});
        const auto d = make_dataset(p);
        WriteOptions o;
        o.compression = value_of_word<Compression>(compression);
        write_data(temp_folder() + name, d, o, context);
        const auto r = read_file(temp_folder() + name);
        const auto* h = r->as<UniformGrid>();
        REQUIRE(h);
        CHECK(h->dims == g.dims);
        CHECK(h->origin == g.origin);
        CHECK(h->spacing == g.spacing);
        CHECK(h->direction == g.direction);
        CHECK(r->fields()[0].name == "wind speed");
        CHECK(same_array(r->fields()[0].array, d->fields()[0].array));
        CHECK(std::find(r->notes().begin(), r->notes().end(), p.notes[0]) != r->notes().end());
      }
  WriteOptions o;
  o.compression = Compression::lz4;
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.mha", make_dataset(p), o, context); }), "lz4"));
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.mha", make_dataset(PointCloud{}), {}, context); }), "uniform grid"));
  p.fields = {};
  CHECK(contains(error_of([&] { write_data(temp_folder() + "w.mha", make_dataset(p), {}, context); }), "no point field"));
}

TEST_CASE("metaimage: bad headers are refused") {
  const std::string end = "ElementType = MET_SHORT\nElementDataFile = LOCAL\n" + shorts(false);
  CHECK(contains(refusal("b.mha", "NDims = 3\nDimSize = 3 2\n" + end), "2 numbers but NDims is 3"));
  CHECK(contains(refusal("b.mha", "NDims = 30\nDimSize = 3 2\n" + end), "NDims is '30'"));
  CHECK(contains(refusal("b.mha", "NDims = 2\nDimSize = 3 x\n" + end), "'x' is not a valid size"));
  CHECK(contains(refusal("b.mha", mhd_head + "ElementType = MET_STRING\nElementDataFile = LOCAL\n"), "'MET_STRING' is unknown"));
  CHECK(contains(refusal("b.mha", mhd_head + "ElementSpacing = 1 1\n" + end), "2 numbers, but 3 are needed"));
  CHECK(contains(refusal("b.mha", mhd_head + "ElementSpacing = 1 1 nan\n" + end), "is not a number"));
  CHECK(contains(refusal("b.mha", mhd_head + "TransformMatrix = 1 0 0 1 0 0 0 0 1\n" + end), "coplanar"));
  CHECK(contains(refusal("b.mha", mhd_head + "ElementType = MET_SHORT\n"), "no ElementDataFile"));
  CHECK(contains(refusal("b.mha", mhd_head + "ElementNumberOfChannels = 0\n" + end), "ElementNumberOfChannels"));
  CHECK(contains(refusal("b.mha", mhd_head + "HeaderSize = -2\n" + end), "HeaderSize"));
  CHECK(contains(refusal("b.mha", mhd_head + "ElementType = MET_SHORT\nElementDataFile = LIST\n"), "not followed by names"));
  CHECK(contains(refusal("b.mha", "ObjectType = Tube\nNDims = 3\nDimSize = 1 1 1\n" + end), "MetaIO Tube"));
  CHECK(contains(refusal("b.mha", "NDims = 3\nDimSize = 9999999 9999999 9999999\n" + end), "too large"));
  CHECK(contains(refusal("b.mha", "NDims = 3\nDimSize = 3000 3000 30\n" + end), "bytes are needed, but there are 24"));
  CHECK(contains(refusal("b.mha", "NDims = 3\nDimSize = 3000 3000 30\nCompressedData = True\n" + end), "cannot hold"));
  CHECK(contains(refusal("b.mha", mhd_head + "CompressedData = True\n" + end), "damaged"));
}

TEST_CASE("metaimage: cut and damaged files give errors, never crashes") {
  CHECK(cut_and_damage("cut.mha", mhd_head + "ElementSpacing = 1 1 1\nOffset = 0 0 0\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
                                      shorts(false)) == 63);
}
