// SPDX-License-Identifier: Apache-2.0
// VTK XML files, reading: the choice of the kind, and parallel files, which name the files of their pieces.
// Format: VTK User's Guide, "XML file formats".
#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <set>

#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/vtk_missing.h"
#include "io/vtk/xml/vtk_xml_pieces.h"

namespace sg {

namespace vtk {
namespace {

struct KindReader {
  std::string_view type;
  void (*read)(const XmlRead&, DatasetParts&);
};
constexpr KindReader kinds[] = {{"ImageData", read_image},
                                {"RectilinearGrid", read_rectilinear},
                                {"StructuredGrid", read_curvilinear},
                                {"UnstructuredGrid", read_unstructured},
                                {"PolyData", read_polydata}};

const KindReader* kind_of(std::string_view type) {
  for (const KindReader& k : kinds)
    if (k.type == type) return &k;
  return nullptr;
}

void add_pieces(const XmlFile& file, std::vector<XmlPiece>& pieces) {
  for (const pugi::xml_node& n : file.dataset().children("Piece")) pieces.push_back({&file, n});
}

void add_whole_fields(const XmlRead& read, DatasetParts& parts) {
  for (const pugi::xml_node& owner : {read.file.dataset(), read.file.dataset().parent()}) {
    for (const Field& f : read_whole_fields(read, owner)) {
      if (f.name == "TimeValue" && f.array.count() == 1 && f.components() == 1) parts.time = f.array.get(0);
      else if (!parts.fields.find(f.name, f.association)) parts.fields.add(f);
    }
    add_texts(read, owner, parts);
  }
}

// Every mapped piece keeps its file open.
void allow_open_files(size_t n) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= n) return;
  limit.rlim_cur = std::min<rlim_t>(n, limit.rlim_max);
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace
}  // namespace vtk

bool sniff_vtk_xml(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  if (text.find("<VTKFile") == std::string_view::npos) return false;
  // Collections (.vtm, .pvd) and parallel headers (.pvtu) have the same root but are other formats.
  const std::string_view type = vtk::xml_type(text);
  return type.empty() || vtk::kind_of(type);
}

bool sniff_vtk_parallel(std::span<const std::byte> head) {
  const std::string_view type = vtk::xml_type({reinterpret_cast<const char*>(head.data()), head.size()});
  return type.size() > 1 && type[0] == 'P' && vtk::kind_of(type.substr(1));
}

Data read_vtk_xml(const std::string& path, const ReadOptions& options, Context& context) {
  const vtk::XmlFile file(path);
  const vtk::KindReader* kind = vtk::kind_of(file.type());
  if (!kind)
    fail_data(fmt::format("has the type '{}'", file.type()), path,
              "supported: ImageData, RectilinearGrid, StructuredGrid, UnstructuredGrid, PolyData");
  vtk::XmlRead read{file, options, context};
  vtk::add_pieces(file, read.pieces);
  DatasetParts parts;
  kind->read(read, parts);
  vtk::add_whole_fields(read, parts);
  vtk::take_ghosts(parts);
  return make_dataset(std::move(parts));
}

Data read_vtk_parallel(const std::string& path, const ReadOptions& options, Context& context) {
  const vtk::XmlFile file(path);
  const vtk::KindReader* kind = file.type().starts_with("P") ? vtk::kind_of(file.type().substr(1)) : nullptr;
  if (!kind)
    fail_data(fmt::format("has the type '{}'", file.type()), path,
              "supported: PImageData, PRectilinearGrid, PStructuredGrid, PUnstructuredGrid, PPolyData");
  std::vector<std::string> sources;
  std::set<std::string_view> seen;
  for (const pugi::xml_node& n : file.dataset().children("Piece")) {
    const std::string_view source = n.attribute("Source").value();
    if (source.empty()) file.fail("has no Source", n, "expected the file name of the piece");
    if (!seen.insert(source).second) file.fail(fmt::format("names '{}' a second time", source), n, "name each piece once");
    sources.emplace_back(source);
  }
  if (options.pieces < 1 || options.piece < 0 || options.piece >= options.pieces)
    fail_usage(fmt::format("piece {} of {}", options.piece, options.pieces), path, "pieces count from 0");
  const size_t begin = sources.size() * size_t(options.piece) / size_t(options.pieces),
               end = sources.size() * size_t(options.piece + 1) / size_t(options.pieces);
  vtk::allow_open_files(end - begin + 256);
  std::vector<std::unique_ptr<vtk::XmlFile>> files;
  vtk::XmlRead read{file, options, context};
  vtk::MissingFiles missing;
  for (size_t i = begin; i < end; ++i) {
    context.check();
    auto piece = with_context(fmt::format("reading the pieces of '{}'", path), [&]() -> std::unique_ptr<vtk::XmlFile> {
      const std::string name = named_file(path, sources[i]);
      return missing.lacks(name) ? nullptr : std::make_unique<vtk::XmlFile>(name);
    });
    if (!piece) continue;
    missing.found();
    files.push_back(std::move(piece));
    if (files.back()->type() != kind->type)
      fail_data(fmt::format("holds {}", files.back()->type()), files.back()->path(),
                fmt::format("expected {}, as in the other pieces of {}", kind->type, file_name_of(path)));
    vtk::add_pieces(*files.back(), read.pieces);
  }
  missing.tell(path, context);
  DatasetParts parts;
  kind->read(read, parts);
  vtk::add_whole_fields(read, parts);
  if (!files.empty()) vtk::add_whole_fields({*files[0], options, context}, parts);
  vtk::take_ghosts(parts);
  return make_dataset(std::move(parts));
}

}  // namespace sg
