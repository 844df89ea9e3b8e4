// SPDX-License-Identifier: Apache-2.0
// What is not a plain file in an allowed place: files that name others elsewhere, pipes where files are expected, names of odd bytes.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "base/file/file.h"
#include "base/text/utf8.h"
#include "cli/program.h"
#include "image/codec.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

namespace {

namespace fs = std::filesystem;

void replace_all(std::string& s, std::string_view what, const std::string& by) {
  for (size_t at = s.find(what); at != s.npos; at = s.find(what, at + by.size())) s.replace(at, what.size(), by);
}

// Each format whose files name others: a header that names NAME, and what there has to be beside it.
struct Naming {
  std::string file, text, target;  // the kind of file that is named: "x.raw", "x.vti"
  std::vector<std::pair<std::string, std::string>> beside = {};
};

std::vector<Naming> naming_formats() {
  const std::string vtk = "<VTKFile type=\"", end = "</VTKFile>";
  const std::string topology =
      "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"2 2 2\"/><Geometry GeometryType=\"ORIGIN_DXDYDZ\"><DataItem "
      "Dimensions=\"3\">0 0 0</DataItem><DataItem Dimensions=\"3\">1 1 1</DataItem></Geometry>";
  const auto xdmf = [&](const std::string& item) {
    return "<Xdmf Version=\"3.0\"><Domain><Grid>" + topology + "<Attribute Name=\"a\" Center=\"Node\">" + item +
           "</Attribute></Grid></Domain></Xdmf>";
  };
  return {
      {"h.mhd", "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = NAME\n", "x.raw"},
      {"list.mhd", "NDims = 3\nDimSize = 2 2 1\nElementType = MET_UCHAR\nElementDataFile = LIST\nNAME\n", "x.raw"},
      {"h.nhdr", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: NAME\n", "x.raw"},
      {"list.nhdr", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: LIST\nNAME\n", "x.raw"},
      {"h.bov", "DATA_FILE: NAME\nDATA_SIZE: 2 2 2\nDATA_FORMAT: BYTE\n", "x.raw"},
      {"binary.xdmf", xdmf("<DataItem Format=\"Binary\" NumberType=\"UChar\" Precision=\"1\" Dimensions=\"2 2 2\">NAME</DataItem>"),
       "x.raw"},
      {"hdf.xdmf", xdmf("<DataItem Format=\"HDF\" NumberType=\"UChar\" Precision=\"1\" Dimensions=\"2 2 2\">NAME:/a</DataItem>"), "x.h5"},
      {"h.case", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: NAME\n", "x.geo"},
      {"h.pvd", vtk + "Collection\"><Collection><DataSet timestep=\"0\" file=\"NAME\"/></Collection>" + end, "x.vti"},
      {"h.vtm", vtk + "vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><DataSet index=\"0\" file=\"NAME\"/></vtkMultiBlockDataSet>" + end,
       "x.vti"},
      {"h.pvti",
       vtk +
           "PImageData\"><PImageData WholeExtent=\"0 1 0 1 0 1\" GhostLevel=\"0\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 1 0 "
           "1 0 1\" "
           "Source=\"NAME\"/></PImageData>" +
           end,
       "x.vti"},
      {"h.pvtu",
       vtk +
           "PUnstructuredGrid\"><PUnstructuredGrid><PPoints><PDataArray type=\"Float32\" NumberOfComponents=\"3\"/></PPoints><Piece "
           "Source=\"NAME\"/></PUnstructuredGrid>" +
           end,
       "x.vti"},
      {"h.vthb",
       vtk +
           "vtkOverlappingAMR\" version=\"1.1\"><vtkOverlappingAMR origin=\"0 0 0\" grid_description=\"XYZ\"><Block level=\"0\" "
           "spacing=\"1 1 "
           "1\"><DataSet index=\"0\" amr_box=\"0 0 0 0 0 0\" file=\"NAME\"/></Block></vtkOverlappingAMR>" +
           end,
       "x.vti"},
      {"h.gltf",
       "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"NAME\",\"byteLength\":8}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":8}"
       "],"
       "\"accessors\":[{\"bufferView\":0,\"componentType\":5121,\"count\":1,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{"
       "\"attributes\":{"
       "\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}",
       "x.raw"},
      {"h.p3d", "{\"filenames\": [{\"time\": 0, \"xyz\": \"NAME\"}]}", "x.xyz"},
      {"h.nek5000", "filetemplate: NAME%01d.f%05d\nfirsttimestep: 1\nnumtimesteps: 1\n", "x"},
  };
}

// A process that reads, with a limit of time: what waits for a pipe would wait for ever.
int status_within(const std::vector<std::string>& args, int seconds, const std::string& shell_before = {},
                  const std::string& shell_after = {}) {
  std::string command = "exec timeout -s KILL " + std::to_string(seconds) + " " + test::build_folder() + "/sightglass";
  if (!shell_before.empty()) command = shell_before + " " + command.substr(5);
  for (const std::string& a : args) command += " '" + a + "'";
  command += shell_after + " >/dev/null 2>&1";
  const pid_t child = ::fork();
  if (child == 0) {
    ::execlp("bash", "bash", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

TEST_CASE("files that name files: below their folder or the working folder alone, in every format; elsewhere when the user says so") {
  const std::string top = test::temp_folder() + "naming/", here = top + "here/", work = top + "work/", out = top + "out/";
  for (const std::string& f : {here, work, out, here + "inside/"}) fs::create_directories(f);
  for (const std::string& folder : {out, here, here + "inside/"}) {
    write_file(folder + "x.raw", "12345678"), write_file(folder + "x.geo", "no geometry"), write_file(folder + "x.h5", "no HDF5");
    write_file(folder + "x.xyz", "no grid"), write_file(folder + "x0.f00001", "no fields");
    REQUIRE(sightglass({"convert", "--source", "hydrogen size=2", "-o", folder + "x.vti"}).status == 0);
  }
  for (const Naming& n : naming_formats()) {
    for (const std::string& to : {"inside/../../out/" + n.target, out + n.target}) {
      INFO(n.file << " names " << to);
      std::string text = n.text;
      replace_all(text, "NAME", to);
      write_file(here + n.file, text);
      const auto refused = sightglass({"info", here + n.file}, work);
      CHECK(refused.status == 3);
      CHECK_MESSAGE(contains(refused.err, "--read-anywhere"), refused.err);
      CHECK(contains(refused.err, n.file));
      CHECK(contains(refused.err, n.target));
      if (to[0] != '/') CHECK_FALSE(contains(sightglass({"info", here + n.file, "--read-anywhere"}, work).err, "use --read-anywhere"));
    }
    for (const auto& [to, from] :
         std::vector<std::pair<std::string, std::string>>{{n.target, work}, {"inside/" + n.target, work}, {"../out/" + n.target, top}}) {
      INFO(n.file << " names " << to);
      std::string text = n.text;
      replace_all(text, "NAME", to);
      write_file(here + n.file, text);
      CHECK_FALSE(contains(sightglass({"info", here + n.file}, from).err, "--read-anywhere"));
    }
  }
}

TEST_CASE("files that name files: pipes and devices are refused at once, in every format") {
  const std::string here = test::temp_folder() + "naming_pipes/";
  fs::create_directories(here);
  for (const Naming& n : naming_formats()) {
    const std::string target = n.file == "h.nek5000" ? "x0.f00001" : n.target;
    if (!file_exists(here + target)) REQUIRE(::mkfifo((here + target).c_str(), 0600) == 0);
    std::string text = n.text;
    replace_all(text, "NAME", n.target);
    write_file(here + n.file, text);
    INFO(n.file);
    CHECK(status_within({"info", here + n.file}, 10) == 3);
  }
}

TEST_CASE("pipes in the place of any file: refused at once, in words") {
  const std::string here = test::temp_folder() + "pipes/", pipe = here + "pipe";
  fs::create_directories(here);
  REQUIRE(sightglass({"convert", "--source", "hydrogen size=4", "-o", here + "in.vti"}).status == 0);
  for (const std::string extension :
       {"", ".mhd", ".pvd", ".h5", ".nc", ".dcm", ".vdb", ".tif", ".cgns", ".csv", ".yaml", ".png", ".cpt", ".json", ".hierarchy"})
    REQUIRE(::mkfifo((pipe + extension).c_str(), 0600) == 0);
  write_file(here + "p.yaml", "sightglass: 1\nsteps: {a: {read: pipe.vti}}\n");
  REQUIRE(::mkfifo((here + "pipe.vti").c_str(), 0600) == 0);
  const std::vector<std::vector<std::string>> commands = {
      {"info", pipe},
      {"info", pipe + ".mhd"},
      {"info", pipe + ".pvd"},
      {"info", pipe + ".h5"},
      {"info", pipe + ".nc"},
      {"info", pipe + ".dcm"},
      {"info", pipe + ".vdb"},
      {"info", pipe + ".tif"},
      {"info", pipe + ".cgns"},
      {"info", pipe + ".csv"},
      {"info", pipe + ".hierarchy"},
      {"info", pipe, "--dims", "2,2,2", "--type", "u8"},
      {"run", pipe + ".yaml"},
      {"run", here + "p.yaml"},
      {"open", pipe + ".png"},
      {"colormap", pipe + ".cpt"},
      {"render", here + "in.vti", "--map", pipe + ".cpt", "-o", here + "o.png"},
      {"render", here + "in.vti", "--show", "volume transfer=" + pipe + ".yaml", "-o", here + "o.png"},
      {"render", here + "in.vti", "-f", "glyphs shape=" + pipe, "-o", here + "o.png"},
      {"convert", here + "in.vti", "-o", here + "pipe.vti"},
      {"info", here},
  };
  for (const auto& command : commands) {
    std::string all;
    for (const std::string& w : command) all += w + " ";
    INFO(all);
    const int status = status_within(command, 10);
    CHECK(status >= 2);
    CHECK(status <= 3);
  }
}

TEST_CASE("streams: info <(command) and /dev/stdin read what can be told from its content, up to the memory allowed") {
  const std::string here = test::temp_folder() + "streams/";
  fs::create_directories(here);
  for (const std::string name : {"a.vti", "a.nrrd", "a.ply", "a.npy", "a.vdb", "a.vtkhdf", "a.mha"}) {
    INFO(name);
    const auto made = sightglass({"convert", "--source", name == "a.ply" ? "superquadric" : "hydrogen size=5", "-o", here + name});
    if (made.status != 0) continue;  // no plug-in here, or no such source
    CHECK(status_within({"info"}, 20, "", " <(cat '" + here + name + "')") == 0);
    CHECK(status_within({"info", "/dev/stdin"}, 20, "cat '" + here + name + "' |") == 0);
  }
  write_file(here + "t.csv", "a,b\n1,2\n3,4\n"), write_file(here + "words", "a b\nc d\n");
  REQUIRE(sightglass({"convert", "--source", "sphere size=8", "-f", "contour values=0", "-o", here + "s.obj"}).status == 0);
  REQUIRE(sightglass({"convert", "--source", "sphere size=8", "-f", "contour values=0", "-o", here + "s.stl"}).status == 0);
  REQUIRE(sightglass({"convert", "--source", "sphere size=8", "-f", "contour values=0", "--ascii", "-o", here + "text.stl"}).status == 0);
  for (const std::string name : {"t.csv", "s.obj", "s.stl", "text.stl"}) {
    INFO(name);
    CHECK(status_within({"info", "-"}, 20, "cat '" + here + name + "' |") == 0);
  }
  CHECK(status_within({"info", "-"}, 20, "cat '" + here + "words' |") == 3);
  CHECK(status_within({"info", "-", "--input-format", "csv"}, 20, "cat '" + here + "words' |") == 0);
  // What is up in a format is so in a pipe as well.
  CHECK(status_within({"render", "-", "--size", "40x30", "-o", here + "piped.png"}, 20, "cat '" + here + "s.obj' |") == 0);
  REQUIRE(sightglass({"render", here + "s.obj", "--size", "40x30", "-o", here + "named.png"}).status == 0);
  const auto picture = [&](const char* name) { return read_png(here + name); };
  CHECK(compare(picture("piped.png"), picture("named.png")).pixels == 0);
  CHECK(status_within({"info", "--memory", "1M"}, 20, "", " <(cat /dev/zero)") == 3);
  CHECK(status_within({"info"}, 20, "", " <(cat /dev/null)") == 3);
  CHECK(status_within({"render", "--size", "40x30", "-o", here + "o.png"}, 20, "", " <(cat '" + here + "a.vti')") == 0);
}

TEST_CASE("names of odd bytes: files are read, shown and written, and no byte of a name acts on a terminal") {
  const std::string here = test::temp_folder() + "odd_names/";
  fs::create_directories(here);
  const std::string odd = std::string("t\xe9\xff") + "\x1b[31m\n'\"<&>.vti", field = "f\xe9\xe2\x80\xae\x9b\xff";
  write_file(here + "in.vtk",
             "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA "
             "8\nSCALARS " +
                 field + " float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n");
  const auto harmless = [](const std::string& text) {
    uint32_t code = 0;
    for (size_t i = 0, n = 0; i < text.size(); i += n) {
      n = decode_utf8(text, i, code);
      if (n == 0 || (code != '\n' && is_control(code))) return false;
    }
    return true;
  };
  for (const std::vector<std::string>& args : std::vector<std::vector<std::string>>{
           {"convert", "in.vtk", "-o", odd},
           {"info", odd},
           {"info", odd, "--json"},
           {"info", "in.vtk"},
           {"info", "in.vtk", "--json"},
           {"info", "in.vtk", "-f", "calc expr=1 name='\x1b]0;pwned\x07'"},
           {"info", "in.vtk", "--json", "-f", "calc expr=1 name='\x1b]0;pwned\x07'"},
           {"convert", "in.vtk", "-f", "calc expr=1 name='\x1b]0;pwned\x07'", "-o", "c" + odd},
           {"info", "c" + odd},
           {"render", odd, "--size", "80x60", "-o", odd + ".png"},
           {"open", odd + ".png", "-o", "again.png"},
           {"open", odd + ".png", "--recipe"},
           {"render", "in.vtk", "--size", "80x60", "-o", "o.png", "-v"},
       }) {
    const auto r = sightglass(args, here);
    INFO(args[0] << " " << printable(args[1]) << ": " << printable(r.err));
    CHECK(r.status == 0);
    CHECK(harmless(r.out));
    CHECK(harmless(r.err));
  }
  for (const std::vector<std::string>& args :
       std::vector<std::vector<std::string>>{{"info", "no" + odd},
                                             {"render", "in.vtk", "--field", "\x1b[2J", "-o", "o.png"},
                                             {"render", "in.vtk", "-f", "contour field=\x1b[2J"},
                                             {"inf\x1bo"},
                                             {"info", "--x\x1b"}}) {
    const auto r = sightglass(args, here);
    CHECK(r.status > 0);
    CHECK(harmless(r.err));
  }
  const std::string xml(MappedFile(here + odd).text().substr(0, 2000));
  CHECK(harmless(xml.substr(0, xml.find("<AppendedData"))));
}

TEST_CASE("plug-ins: from beside the program or the variable alone, never from a place that others may write") {
  const std::string here = test::temp_folder() + "program/", program = here + "sightglass", built = std::string(test::build_folder()) + "/";
  fs::create_directories(here + "plugins");
  std::error_code other_disk;
  fs::create_hard_link(built + "sightglass", program, other_disk);
  if (other_disk) fs::copy_file(built + "sightglass", program);
  write_file(here + "a.h5", "\x89HDF\r\n\x1a\n and no more");
  const auto said = [&](const std::string& before = "") {
    const int status = std::system((before + " '" + program + "' info '" + here + "a.h5' 2>'" + here + "said' >&2").c_str());
    CHECK(status != 0);
    return std::string(MappedFile(here + "said").text());
  };
  CHECK(contains(said(), "is not installed"));
  CHECK(contains(said(), here + "plugins/"));
  CHECK_FALSE(contains(said(), built));
  write_file(here + "plugins/sightglass_hdf5.so", "no library");
  CHECK(contains(said(), "cannot load"));
  fs::permissions(here + "plugins/sightglass_hdf5.so", fs::perms::others_write, fs::perm_options::add);
  CHECK(contains(said(), "skipped"));
  fs::permissions(here + "plugins/sightglass_hdf5.so", fs::perms::others_write, fs::perm_options::remove);
  fs::permissions(here + "plugins", fs::perms::others_write, fs::perm_options::add);
  CHECK(contains(said(), "skipped"));
  CHECK_FALSE(contains(said("SIGHTGLASS_PLUGINS='" + here + "other'"), here + "plugins/"));
}
