// SPDX-License-Identifier: Apache-2.0
// Files that another program writes while they are read: told, never a crash, never a picture of half a file.
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "base/file/file.h"
#include "base/file/mapped_watch.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;

namespace {

void overwrite(const std::string& path, size_t at, const std::string& bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY);
  REQUIRE(fd >= 0);
  CHECK(::pwrite(fd, bytes.data(), bytes.size(), off_t(at)) == ssize_t(bytes.size()));
  ::close(fd);
}

// The clock of a file system may stand still for some milliseconds.
void wait_for_clock(const std::string& path) {
  struct stat before {
  }, now{};
  ::stat(path.c_str(), &before);
  const std::string other = test::temp_folder() + "clock";
  for (int i = 0; i < 1000; ++i) {
    write_file(other, "x");
    ::stat(other.c_str(), &now);
    if (now.st_mtim.tv_sec != before.st_mtim.tv_sec || now.st_mtim.tv_nsec != before.st_mtim.tv_nsec) return;
    ::usleep(1000);
  }
}

template <class T>
std::string bytes_of(const std::vector<T>& v) {
  const uint64_t n = v.size() * sizeof(T);
  return std::string(reinterpret_cast<const char*>(&n), 8) + std::string(reinterpret_cast<const char*>(v.data()), n);
}

// A strip of n quadrilaterals, numbers appended without encoding: they stay in the mapped file. `at` receives where the ids begin.
std::string write_strip(const std::string& name, size_t n, size_t& at) {
  std::vector<float> xyz;
  std::vector<int64_t> ids, offsets;
  std::vector<uint8_t> types(n, 9);
  for (size_t i = 0; i <= n; ++i)
    for (const float y : {0.f, 1.f}) xyz.insert(xyz.end(), {float(i), y, 0.f});
  for (size_t i = 0; i < n; ++i) {
    const auto k = int64_t(2 * i);
    ids.insert(ids.end(), {k, k + 2, k + 3, k + 1});
    offsets.push_back(4 * int64_t(i + 1));
  }
  std::string body[4] = {bytes_of(xyz), bytes_of(ids), bytes_of(offsets), bytes_of(types)};
  size_t place[4], sum = 0;
  for (int k = 0; k < 4; ++k) {
    while (body[k].size() % 8) body[k] += '\0';
    place[k] = sum, sum += body[k].size();
  }
  const auto array = [&](const char* type, const char* what, int components, int k) {
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>", type, what,
                       components, place[k]);
  };
  std::string head = fmt::format(
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"><UnstructuredGrid><Piece "
      "NumberOfPoints=\"{}\" NumberOfCells=\"{}\"><Points>{}</Points><Cells>{}{}{}</Cells></Piece></UnstructuredGrid><AppendedData "
      "encoding=\"raw\">",
      2 * (n + 1), n, array("Float32", "Points", 3, 0), array("Int64", "connectivity", 1, 1), array("Int64", "offsets", 1, 2),
      array("UInt8", "types", 1, 3));
  while ((head.size() + 1) % 8) head += ' ';
  head += '_';
  at = head.size() + place[1] + 8;
  const std::string path = test::temp_folder() + name;
  write_file(path, head + body[0] + body[1] + body[2] + body[3] + "</AppendedData></VTKFile>");
  return path;
}

DatasetPtr read_one(const std::string& path) {
  Context context;
  return std::get<DatasetPtr>(read_data(path, {}, context));
}

std::string change_told() {
  return test::error_of([] { check_files_unchanged(); });
}

}  // namespace

TEST_CASE("changing files: of a mapped file that is cut, what is gone reads as zeros, and the change is told") {
  const std::string path = test::temp_folder() + "cut_64x64x64_float32.raw";
  {
    std::string ones;
    const float one = 1;
    for (int i = 0; i < 64 * 64 * 64; ++i) ones.append(reinterpret_cast<const char*>(&one), 4);
    write_file(path, ones);
  }
  ReadOptions options;
  options.raw_dims = {64, 64, 64}, options.raw_type = "f32";
  Context context;
  const DatasetPtr d = std::get<DatasetPtr>(read_data(path, options, context));
  check_files_unchanged();
  CHECK(::truncate(path.c_str(), 65536) == 0);
  const Range r = d->range(d->fields()[0]);
  CHECK(r.lo == 0);
  CHECK(r.hi == 1);
  const std::string error = change_told();
  CHECK(error.find(path) != std::string::npos);
  CHECK(error.find("the file changed while it was being read") != std::string::npos);
}

TEST_CASE("changing files: a bus error anywhere else ends the program as ever") {
  const std::string path = test::temp_folder() + "mapped.txt";
  write_file(path, "mapped");
  const MappedFile watched(path);  // the handler is there
  const pid_t child = ::fork();
  if (child == 0) {
    ::raise(SIGBUS);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK((WIFSIGNALED(status) || WEXITSTATUS(status) != 0));  // an address sanitizer has an end of its own
}

TEST_CASE("changing files: ids that are written over after they were checked stay what they were, and the change is told") {
  size_t at = 0;
  const std::string path = write_strip("strip.vtu", 1000, at);
  const DatasetPtr d = read_one(path);
  const auto& mesh = *d->as<UnstructuredMesh>();
  const CellsView cells = cells_view(mesh.cells);
  REQUIRE(cells.count == 1000);
  REQUIRE(cells.point(500, 2) == 1003);
  check_files_unchanged();
  wait_for_clock(path);
  overwrite(path, at, std::string(8 * 4 * 1000 + 8 + 8 * 1000 + 8 + 1000, '\x7f'));  // ids, offsets and types
  for (size_t c = 0; c < 1000; ++c) {
    CHECK(cells.size(c) == 4);
    CHECK(cells.point(c, 2) == int64_t(2 * c + 3));
    CHECK(mesh.type(c) == CellType::quad);
  }
  validate(d->mesh());
  CHECK(change_told().find(path) != std::string::npos);
}

TEST_CASE("changing files: a new file under the name of one that is mapped changes nothing") {
  size_t at = 0;
  const std::string path = write_strip("replaced.vtu", 10, at);
  const DatasetPtr d = read_one(path);
  wait_for_clock(path);
  write_file(path, "something else");
  check_files_unchanged();
  CHECK(d->bounds().hi.x == 10);
}

TEST_CASE("changing files: nothing is written that was made of a file that has changed") {
  size_t at = 0;
  const std::string path = write_strip("source.vtu", 10, at), out = test::temp_folder() + "made.stl";
  write_file(out, "before");
  {
    const DatasetPtr d = read_one(path);
    wait_for_clock(path);
    overwrite(path, at, std::string(8, '\0'));
    Context context;
    SurfaceMesh s;
    s.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    s.polygons.fixed = 3, s.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2});
    CHECK(test::error_of([&] { write_data(out, make_dataset(s), {}, context); }).find("the file changed while it was being read") !=
          std::string::npos);
    CHECK(MappedFile(out).text() == "before");
  }
  check_files_unchanged();  // no longer mapped: nothing more is made of it
}

TEST_CASE("changing files: what is changed while a reader is at work is told, whatever the reader makes of it") {
  const std::string text =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 2\n"
      "FIELD f 2\nodd 1 3 float\n1 2 3\neven 1 2 float\n4 5\n";
  for (const bool cut : {false, true}) {
    const std::string path = test::temp_folder() + "worked_on.vtk";
    write_file(path, text);
    wait_for_clock(path);
    Context context;
    int said = 0;
    context.on_log = [&](LogLevel, std::string_view) {  // after 'odd' was read
      ++said;
      if (cut) CHECK(::truncate(path.c_str(), 0) == 0);
      else overwrite(path, text.size() - 4, "7 8\n");
    };
    const std::string error = test::error_of([&] { read_data(path, {}, context); });
    CHECK(said > 0);
    CHECK(error.find(path) != std::string::npos);
    CHECK(error.find("the file changed while it was being read") != std::string::npos);
  }
}
