// SPDX-License-Identifier: Apache-2.0
// VTK XML: cut, bent and absurd files give errors that name the element.
#include <fstream>

#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("vtk xml: a file cut anywhere gives an Error that names it") {
  for (const Sample& s : samples())
    for (const WriteOptions& o : every_option) {
      const std::string whole = temp(std::string("whole.") + s.extension), part = temp(std::string("cut.") + s.extension);
      write(whole, s.dataset, o);
      const std::string text(MappedFile(whole).text());
      for (size_t i = 1; i < 64; ++i) {
        write_file(part, text.substr(0, text.size() * i / 64));
        CAPTURE(s.extension);
        CAPTURE(std::string(word_of(o.encoding)));
        CAPTURE(i);
        CHECK(test::error_of([&] { read(part); }).find("cut.") != std::string::npos);
      }
    }
}

TEST_CASE("vtk xml: files with any byte changed read or give an Error, and nothing worse") {
  size_t errors = 0, reads = 0;
  for (const Sample& s : samples())
    for (const WriteOptions& o : {every_option[0], every_option[2], every_option[5], every_option[7]}) {
      const std::string path = temp(std::string("bent.") + s.extension);
      write(path, s.dataset, o);
      const std::string text(MappedFile(path).text());
      for (size_t i = 0; i < 150; ++i) {
        std::string bent = text;
        uint64_t h = (i + 1) * 0x9e3779b97f4a7c15ull;
        bent[(h >> 20) % bent.size()] = char(h >> 8);
        write_file(path, bent);
        try {
          read(path);
          ++reads;
        } catch (const Error& e) {
          CHECK(e.kind() == ErrorKind::data);
          ++errors;
        }
      }
    }
  CHECK(errors > 100);
  CHECK(reads > 100);
}

TEST_CASE("vtk xml: absurd sizes, types, offsets and extents are refused with the element's name") {
  auto array = [](const std::string& attributes, const std::string& text = "1 2 3") {
    return "<PointData><DataArray Name=\"T\" " + attributes + ">" + text + "</DataArray></PointData>";
  };
  auto error = [&](const std::string& text) { return test::error_of([&] { read_text("bad.vtu", text); }); };
  auto says = [](const std::string& e, const char* what) { return e.find(what) != std::string::npos; };
  CHECK(says(error(vtu(piece("9223372036854775808", "1"))), "DataArray 'P'"));
  CHECK(says(error(vtu(piece("18446744073709551616", "1"))), "NumberOfPoints"));
  CHECK(says(error(vtu(piece("-3", "1"))), "NumberOfPoints"));
  CHECK(says(error(vtu(piece("3", "9223372036854775808"))), "offsets"));
  CHECK(says(error(vtu(piece("4", "1"))), "4 tuples"));
  CHECK(says(error(vtu(piece("2", "1"))), "point id 2"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float16\" format=\"ascii\"")))), "Float16"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Int8\" format=\"ascii\"", "1 2 300")))), "'300'"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"ascii\"", "1 x 3")))), "DataArray 'T'"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"ascii\"", "1 2")))), "DataArray 'T'"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"ascii\" NumberOfComponents=\"4294967296\"")))), "components"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"hex\"")))), "hex"));
  CHECK(says(error(vtu(piece("3", "1", array("type=\"Float32\" format=\"appended\" offset=\"0\"")))), "AppendedData"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkZstd\"><UnstructuredGrid/></VTKFile>"), "vtkZstd"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt128\"><UnstructuredGrid/></VTKFile>"), "UInt128"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\" byte_order=\"Middle\"><UnstructuredGrid/></VTKFile>"), "Middle"));
  CHECK(says(error("<VTKFile type=\"UnstructuredGrid\"><PolyData/></VTKFile>"), "UnstructuredGrid"));
  for (const char* extent :
       {"0 -5 0 1 0 1", "0 9223372036854775807 0 1 0 1", "0 1000000000000 0 1000000000000 0 1", "0 1 0 1", "a b c d e f"}) {
    CAPTURE(extent);
    CHECK(says(error(std::string("<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"") + extent + "\"><Piece/></ImageData></VTKFile>"),
               "WholeExtent"));
  }
  // Appended bytes: an offset beyond the end, and a size that is larger than the file.
  auto appended = [&](const char* offset, const std::string& bytes, const char* compressor = "") {
    return error("<VTKFile type=\"ImageData\" " + std::string(compressor) +
                 "><ImageData WholeExtent=\"0 1 0 0 0 0\"><Piece Extent=\"0 1 0 0 0 0\"><PointData><DataArray type=\"Int8\" Name=\"T\" "
                 "format=\"appended\" offset=\"" +
                 offset + "\"/></PointData></Piece></ImageData><AppendedData encoding=\"raw\">_" + bytes + "</AppendedData></VTKFile>");
  };
  CHECK(says(appended("999", std::string("\2\0\0\0ab", 6)), "offset 999"));
  CHECK(says(appended("5", std::string("\2\0\0\0ab", 6)), "DataArray 'T'"));
  CHECK(says(appended("0",
                      "\xff\xff\xff\xff"
                      "ab"),
             "4294967295"));
  CHECK(says(appended("0", std::string("\1\0\0\0ab", 6)), "2 tuples"));
  const char* zlib = "compressor=\"vtkZLibDataCompressor\"";
  CHECK(says(appended("0",
                      "\xff\xff\xff\xff"
                      "abcdabcdabcd",
                      zlib),
             "blocks"));
  CHECK(says(appended("0", std::string("\1\0\0\0\2\0\0\0\0\0\0\0\5\0\0\0abcde", 21), zlib), "decompressed"));
  CHECK(says(appended("0", std::string("\1\0\0\0\2\0\0\0\0\0\0\0\5\0\0\1abcde", 21), zlib), "DataArray 'T'"));
  CHECK(says(appended("0", std::string("\1\0\0\0\0\0\0\x7f\0\0\0\0\5\0\0\0abcde", 21), zlib), "DataArray 'T'"));
}

TEST_CASE("vtk xml: entities are not expanded and deep nesting is survived") {
  std::string bomb =
      "<?xml version=\"1.0\"?><!DOCTYPE x [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]><VTKFile "
      "type=\"&b;\"><ImageData/></VTKFile>";
  CHECK(!test::error_of([&] { read_text("bomb.vti", bomb); }).empty());
  std::string deep = "<VTKFile type=\"ImageData\">";
  for (int i = 0; i < 200000; ++i) deep += "<a>";
  CHECK(!test::error_of([&] { read_text("deep.vti", deep); }).empty());
}

namespace {

size_t peak_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stoul(line.substr(6)) / 1024;
  return 0;
}

// A lattice of one compressed array: `blocks` blocks of `size` bytes, the packed bytes of each given.
std::string bomb(const char* compressor, uint32_t blocks, uint32_t size, const std::string& packed, const std::string& extent) {
  std::string bytes;
  auto word = [&](uint32_t v) { bytes.append(reinterpret_cast<const char*>(&v), 4); };
  word(blocks), word(size), word(0);
  for (uint32_t i = 0; i < blocks; ++i) word(uint32_t(packed.size()));
  for (uint32_t i = 0; i < blocks; ++i) bytes += packed;
  return std::string("<VTKFile type=\"ImageData\" compressor=\"") + compressor + "\"><ImageData WholeExtent=\"" + extent +
         "\"><Piece Extent=\"" + extent +
         "\"><PointData><DataArray type=\"UInt8\" Name=\"T\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>"
         "<AppendedData encoding=\"raw\">_" +
         bytes + "</AppendedData></VTKFile>";
}

}  // namespace

TEST_CASE("vtk xml: compressed blocks that claim more than they can hold are refused before memory is asked for") {
  const size_t before = peak_megabytes();
  for (const char* compressor : {"vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor"}) {
    CAPTURE(compressor);
    // 40 packed bytes that are to hold 4 GB, and sixteen such blocks.
    for (const uint32_t blocks : {1u, 16u}) {
      const std::string e = test::error_of(
          [&] { read_text("bomb.vti", bomb(compressor, blocks, 0xf0000000u, std::string(40, 'x'), "0 4026531839 0 0 0 0")); });
      CHECK(e.find("'T'") != std::string::npos);
    }
    // A block whose claim could be true but is not.
    CHECK(test::error_of([&] { read_text("bomb.vti", bomb(compressor, 1, 4000, std::string(40, 'x'), "0 3999 0 0 0 0")); }).find("'T'") !=
          std::string::npos);
  }
  // Pieces and points beyond what the file can back, in each kind.
  for (const char* extent : {"0 1000000 0 1000000 0 1000", "0 2147483647 0 2147483647 0 0", "-2147483648 2147483647 0 0 0 0"}) {
    const std::string array = "<PointData><DataArray type=\"Float64\" Name=\"T\" format=\"ascii\">1 2 3</DataArray></PointData>";
    const std::string piece = std::string("<Piece Extent=\"") + extent + "\">" + array + "</Piece>";
    for (const bool header : {false, true})
      for (const std::string& pieces : {piece, piece + piece}) {
        ReadOptions o;
        o.header_only = header;
        CHECK(!test::error_of([&] {
                 read_text("huge.vti",
                           std::string("<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"") + extent + "\">" + pieces +
                               "</ImageData></VTKFile>",
                           o);
               }).empty());
      }
  }
  CHECK(peak_megabytes() < before + 200);
}

TEST_CASE("vtk xml: one face that hangs on thousands of polyhedra is refused") {
  std::string face, zeros, ends, offsets, types, ids;
  for (int i = 0; i < 2000; ++i) face += std::to_string(i % 3) + " ";
  for (int i = 0; i < 20000; ++i)
    zeros += "0 ", ends += std::to_string(i + 1) + " ", offsets += std::to_string(3 * i + 3) + " ", types += "42 ", ids += "0 1 2 ";
  auto list = [](const char* name, const std::string& text) {
    return std::string("<DataArray type=\"Int64\" Name=\"") + name + "\" format=\"ascii\">" + text + "</DataArray>";
  };
  const std::string e = test::error_of([&] {
    read_text("faces.vtu", vtu("<Piece NumberOfPoints=\"3\" NumberOfCells=\"20000\"><Points><DataArray type=\"Float32\" "
                               "NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells>" +
                               list("connectivity", ids) + list("offsets", offsets) + list("types", types) +
                               list("face_connectivity", face) + list("face_offsets", "2000") + list("polyhedron_to_faces", zeros) +
                               list("polyhedron_offsets", ends) + "</Cells></Piece>"));
  });
  CHECK(e.find("far more than two cells") != std::string::npos);
}
