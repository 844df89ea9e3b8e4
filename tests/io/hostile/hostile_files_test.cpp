// SPDX-License-Identifier: Apache-2.0
// Files that are small and ask for much: entities of entities, bombs of packed zeros, lists in lists, files that name themselves, and
// files whose pieces are gone.
#include <fmt/core.h>
#include <zlib.h>

#include <cstring>

#include "io/bytes/inflate.h"
#include "io/corpus.h"
#include "io/io_files.h"
#include "memory_cap.h"

using namespace sg;
using test::contains;
using test::temp_file;

namespace {

// "" when it was read. Errors of kind internal, other exceptions, and asking for memory without end fail the test.
std::string reading(const std::string& path) {
  Context context;
  try {
    for_each_dataset(read_data(path, {}, context), [](const std::string&, const DatasetPtr& d) { (void)d->bounds(); });
  } catch (const Error& e) {
    CHECK(e.kind() != ErrorKind::internal);
    CHECK(!contains(e.what(), "not enough memory"));
    return e.what();
  }
  return "";
}

struct XmlKind {
  const char *extension, *root, *inner;
};
constexpr XmlKind xml_kinds[] = {{"vtu", "VTKFile type=\"UnstructuredGrid\"", "UnstructuredGrid"},
                                 {"pvtu", "VTKFile type=\"PUnstructuredGrid\"", "PUnstructuredGrid"},
                                 {"vtm", "VTKFile type=\"vtkMultiBlockDataSet\"", "vtkMultiBlockDataSet"},
                                 {"pvd", "VTKFile type=\"Collection\"", "Collection"},
                                 {"vthb", "VTKFile type=\"vtkOverlappingAMR\"", "vtkOverlappingAMR"},
                                 {"xdmf", "Xdmf", "Domain"}};

std::string repeated(std::string_view part, size_t n) {
  std::string s;
  for (size_t i = 0; i < n; ++i) s += part;
  return s;
}

std::string bytes_of(std::string_view head, size_t zeros) {
  std::string all(head);
  all.resize(head.size() + zeros, '\0');
  return all;
}

std::string gzipped(const std::string& bytes) {
  const auto packed = pack_gzip({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()});
  return {reinterpret_cast<const char*>(packed.data()), packed.size()};
}

constexpr size_t bomb_bytes = size_t(192) << 20;  // a thousandth of it when it is packed

}  // namespace

TEST_CASE("hostile: entities of entities do not grow in any kind of XML") {
  const test::OneThread one;
  for (const XmlKind& k : xml_kinds) {
    CAPTURE(std::string(k.extension));
    std::string text = "<?xml version=\"1.0\"?><!DOCTYPE x [<!ENTITY a0 \"0123456789012345678901234567890123456789\">";
    for (int i = 1; i < 12; ++i) text += fmt::format("<!ENTITY a{} \"{}\">", i, repeated(fmt::format("&a{};", i - 1), 10));
    text += fmt::format(
        "]><{} Name=\"&a11;\"><{}><Grid Name=\"&a11;\"><Topology TopologyType=\"&a11;\"/></Grid><DataSet file=\"&a11;\"/>"
        "<Piece Source=\"&a11;\"/></{}></{}>",
        k.root, k.inner, k.inner, std::string(k.root).substr(0, std::string(k.root).find(' ')));
    const std::string path = temp_file(std::string("entities.") + k.extension, text);
    const test::MemoryCap cap(size_t(64) << 20);
    const std::string said = reading(path);
    CHECK(!said.empty());
    CHECK(said.size() < 4000);
  }
}

TEST_CASE("hostile: elements in elements, closed or not, are refused or read, in any kind of XML") {
  for (const XmlKind& k : xml_kinds)
    for (const std::string_view element : {"Block", "Grid", "Piece"})
      for (const bool closed : {false, true}) {
        CAPTURE(std::string(k.extension));
        const std::string root(k.root), close = fmt::format("</{}></{}>", k.inner, root.substr(0, root.find(' ')));
        const std::string open = fmt::format("<{}{}>", element, element == "Grid" ? " GridType=\"Tree\"" : "");
        const std::string text = fmt::format("<{}><{}>", root, k.inner) + repeated(open, 50000) +
                                 (closed ? repeated(fmt::format("</{}>", element), 50000) + close : "");
        const std::string said = reading(temp_file(std::string("deep.") + k.extension, text));
        if (!closed) CHECK(!said.empty());
      }
}

TEST_CASE("hostile: lists in lists in a PLOT3D meta file and in dictionaries of OpenFOAM are refused") {
  CHECK(!reading(temp_file("deep.p3d", repeated("[", 200000))).empty());
  CHECK(!reading(temp_file("deep2.p3d", "{\"filenames\": " + repeated("[", 200000) + repeated("]", 200000) + "}")).empty());
  CHECK(!reading(temp_file("deep3.p3d", repeated("{\"filenames\": ", 100000))).empty());
  for (const Format& f : formats()) {
    if (fuzz::slug(f.name) != "openfoam") continue;
    for (const std::string& path : test::seeds_of("openfoam")) {
      test::Seed seed(f, path);
      REQUIRE(seed.read(seed.bytes()) == "");
      for (const std::string_view deep : {"a { ", "( ", "boundaryField { a { type "}) {
        size_t files = 0;
        for (size_t at = seed.bytes().find("\n@@ "); at != std::string::npos; at = seed.bytes().find("\n@@ ", at + 1), ++files) {
          const size_t body = seed.bytes().find('}', at);  // behind the header of each file
          if (body == std::string::npos) continue;
          std::string bytes = seed.bytes();
          bytes.insert(body + 1, "\n" + repeated(deep, 100000));
          seed.read(bytes);
        }
        CHECK(files > 3);
      }
    }
  }
}

TEST_CASE("hostile: packed zeros are unpacked as far as the header says") {
  const test::OneThread one;
  std::string nifti(352, '\0');
  auto put16 = [&](size_t at, int16_t v) { std::memcpy(&nifti[at], &v, 2); };
  const int32_t header = 348;
  const float offset = 352, one_mm = 1;
  std::memcpy(nifti.data(), &header, 4), std::memcpy(&nifti[108], &offset, 4), std::memcpy(&nifti[344], "n+1", 4);
  for (size_t i = 0; i < 8; ++i) put16(40 + 2 * i, i == 0 ? 3 : i < 4 ? 4 : 1), std::memcpy(&nifti[76 + 4 * i], &one_mm, 4);
  put16(70, 2), put16(72, 8);
  const std::string zeros = gzipped(bytes_of("", bomb_bytes)), image = gzipped(bytes_of(nifti, bomb_bytes));
  CHECK(zeros.size() < bomb_bytes / 500);
  const std::string mha = "NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nCompressedData = True\nElementDataFile = LOCAL\n";
  const std::vector<std::string> paths{
      temp_file("zeros.nii.gz", image), temp_file("zeros.mha", mha + zeros),
      temp_file("zeros.nrrd", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: gzip\n\n" + zeros)};
  temp_file("zeros.bin.gz", zeros);
  std::string tail = zeros;  // the length that a gzip file says of itself
  for (const uint32_t length : {64u, 0x7fffffffu, 0xffffffffu}) {
    std::memcpy(tail.data() + tail.size() - 4, &length, 4);
    temp_file(fmt::format("zeros{}.nii.gz", length), tail);
  }
  const test::MemoryCap cap(bomb_bytes / 2);
  for (const std::string& path : paths) {
    CAPTURE(path);
    reading(path);
  }
  for (const uint32_t length : {64u, 0x7fffffffu, 0xffffffffu})
    CHECK(!reading(test::temp_folder() + fmt::format("zeros{}.nii.gz", length)).empty());
}

TEST_CASE("hostile: pictures that say they are larger than their bytes can be are refused") {
  const test::OneThread one;
  auto word = [](uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  auto chunk = [&](const std::string& kind, const std::string& data) {
    const std::string both = kind + data;
    const auto crc = ::crc32(0, reinterpret_cast<const unsigned char*>(both.data()), uInt(both.size()));
    return word(uint32_t(data.size())) + both + word(uint32_t(crc));
  };
  for (const uint32_t size : {60000u, 1000000u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    CAPTURE(size);
    const std::string head = word(size) + word(size) + std::string("\x10\x06\0\0\0", 5);
    const std::string png = "\x89PNG\r\n\x1a\n" + chunk("IHDR", head) + chunk("IDAT", "x\x9c") + chunk("IEND", "");
    const std::string path = temp_file("huge.png", png);
    const test::MemoryCap cap(size_t(64) << 20);
    CHECK(!reading(path).empty());
  }
}

TEST_CASE("hostile: files that name themselves are refused, or read as what they are") {
  auto named = [](const std::string& name, const std::string& text) { return reading(temp_file(name, text)); };
  CHECK(!named("self.pvtu",
               "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid><PPoints><PDataArray type=\"Float32\" NumberOfComponents=\"3\"/>"
               "</PPoints><Piece Source=\"self.pvtu\"/></PUnstructuredGrid></VTKFile>")
             .empty());
  CHECK(contains(
      named("self.pvd", "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"self.pvd\"/></Collection></VTKFile>"),
      "itself"));
  CHECK(!named("self.vthb",
               "<VTKFile type=\"vtkOverlappingAMR\" version=\"1.1\"><vtkOverlappingAMR origin=\"0 0 0\" grid_description=\"XYZ\"><Block "
               "level=\"0\" spacing=\"1 1 1\"><DataSet index=\"0\" amr_box=\"0 1 0 0 0 0\" file=\"self.vthb\"/></Block>"
               "</vtkOverlappingAMR></VTKFile>")
             .empty());
  CHECK(!named("self.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: self.case\n").empty());
  CHECK(!named("self.p3d", "{\"filenames\": [{\"time\": 0, \"xyz\": \"self.p3d\"}]}").empty());
  CHECK(!named("self.nek5000", "filetemplate: self.nek5000\nfirsttimestep: 1\nnumtimesteps: 1\n").empty());
  named("self.nhdr", "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 3 3\nencoding: raw\ndata file: self.nhdr\n");
  named("self.mhd", "NDims = 2\nDimSize = 3 3\nElementType = MET_UCHAR\nElementDataFile = self.mhd\n");
  named("self.bov", "DATA_FILE: self.bov\nDATA_SIZE: 2 2 2\nDATA_FORMAT: BYTE\n");
}

TEST_CASE("missing pieces: what a file names and is not there is named by the error") {
  size_t refused = 0, read = 0;
  for (const Format& f : formats()) {
    const std::string slug = fuzz::slug(f.name), plugin(test::plugin_of(slug));
    if (!f.read || (!plugin.empty() && test::missing(plugin))) continue;
    for (const std::string& path : test::seeds_of(slug)) {
      test::Seed seed(f, path);
      const std::vector<fuzz::BundleFile> files = fuzz::bundle_files(seed.bytes());
      for (size_t gone = 1; gone < files.size(); ++gone) {
        if (files[gone].bytes.empty()) continue;
        std::string bytes;
        for (size_t i = 0; i < files.size(); ++i)
          if (i != gone) bytes += (i > 0 ? "\n@@ " : "@@ ") + files[i].name + "\n" + std::string(files[i].bytes);
        const std::string said = seed.read(bytes);
        CAPTURE(path);
        CAPTURE(files[gone].name);
        ++(said.empty() ? read : refused);
        // A folder of pictures names none of them, and one is no stack; an .img says which .hdr it needs.
        const std::string name = files[gone].name.substr(files[gone].name.rfind('/') + 1);
        if (said.empty() || slug == "stack-of-pictures") continue;
        CHECK_MESSAGE(contains(said, slug == "analyze-image" ? ".hdr" : name), said);
      }
    }
  }
  CHECK(refused > 20);
  CHECK(read > 0);  // without a solution, a step, a slice
}
