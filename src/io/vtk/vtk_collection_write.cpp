// SPDX-License-Identifier: Apache-2.0
// Writing of files that name others: collections as .vtm, overlapping AMR as .vthb.
// Parts first, then the file that names them.
#include <fmt/core.h>

#include "base/text/text.h"
#include "io/formats.h"
#include "io/vtk/vtk_amr.h"
#include "io/vtk/vtk_parts_folder.h"
#include "io/vtk/xml/vtk_xml_encode.h"

namespace sg {

namespace vtk {
namespace {

class BlockWriter {
 public:
  BlockWriter(const std::string& path, const WriteOptions& options, Context& context)
      : folder_(path), path_(path), options_(options), context_(context) {}

  void write(const Data& data) {
    text_ = "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <vtkMultiBlockDataSet>\n";
    if (auto* c = std::get_if<CollectionPtr>(&data)) blocks(**c, "    ");
    else leaf(data, "", 0, "    ");
    text_ += "  </vtkMultiBlockDataSet>\n</VTKFile>\n";
    folder_.commit(text_);
  }

 private:
  void blocks(const Collection& c, const std::string& indent) {
    for (size_t i = 0; i < c.parts.size(); ++i) {
      const Collection::Part& part = c.parts[i];
      auto* inner = std::get_if<CollectionPtr>(&part.data);
      if (!inner) {
        leaf(part.data, part.name, i, indent);
        continue;
      }
      text_ += fmt::format("{}<Block{}>\n", indent, attributes_text({{"index", std::to_string(i)}, {"name", part.name}}));
      if (*inner) blocks(**inner, indent + "  ");
      text_ += indent + "</Block>\n";
    }
  }

  void leaf(const Data& data, const std::string& name, size_t index, const std::string& indent) {
    XmlAttributes attributes{{"index", std::to_string(index)}};
    if (!name.empty()) attributes.emplace_back("name", name);
    auto* d = std::get_if<DatasetPtr>(&data);
    if (!d) fail_usage(fmt::format("part '{}' is a table, which a multiblock file cannot hold", name), path_, "write tables to .csv");
    if (*d) {
      if ((*d)->as<AmrGrid>())
        fail_usage(fmt::format("part '{}' is AMR, which a multiblock file cannot hold", name), path_, "write it to .vthb");
      const std::string_view extension = extension_for((*d)->mesh());
      write_dataset(folder_.file(parts_, extension), **d, options_, context_);
      attributes.emplace_back("file", folder_.name(parts_++, extension));
    }
    text_ += fmt::format("{}<DataSet{}/>\n", indent, attributes_text(attributes));
  }

  PartsFolder folder_;
  const std::string& path_;
  const WriteOptions& options_;
  Context& context_;
  std::string text_;
  size_t parts_ = 0;
};

// One patch as image data, with its share of the fields. Refined cells are found again by every reader, so their bit is left out.
DatasetPtr patch_dataset(const Dataset& d, const AmrGrid& grid, const AmrGrid::Level& level, const AmrGrid::Patch& patch,
                         const Array& ghost) {
  UniformGrid g;
  const auto cells = patch.cells();
  g.spacing = level.spacing;
  for (size_t a = 0; a < 3; ++a) {
    g.dims[a] = grid.dimension == 2 && a == 2 ? 1 : cells[a] + 1;
    g.origin[int(a)] = grid.origin[int(a)] + double(patch.lo[a]) * level.spacing[int(a)];
  }
  const size_t n = cells[0] * cells[1] * cells[2], points = g.dims[0] * g.dims[1] * g.dims[2];
  DatasetParts parts;
  parts.mesh = g;
  for (const Field& f : d.fields()) {
    Field part = f;
    if (f.association == Association::cell) part.array = f.array.slice(patch.cell_offset, patch.cell_offset + n);
    if (f.association == Association::point) part.array = f.array.slice(patch.point_offset, patch.point_offset + points);
    parts.fields.add(std::move(part));
  }
  if (!ghost.empty()) parts.cell_ghost = ghost.slice(patch.cell_offset, patch.cell_offset + n);
  if (!d.point_ghost().empty()) parts.point_ghost = d.point_ghost().slice(patch.point_offset, patch.point_offset + points);
  parts.time = d.time();
  return make_dataset(std::move(parts));
}

// The ghosts but for refined cells; empty when nothing is left.
Array other_ghosts(const Array& ghost) {
  uint8_t* out = nullptr;
  const Array in = ghost.made_packed();
  Array a = Array::make<uint8_t>(in.count(), 1, &out);
  bool any = false;
  for (size_t i = 0; i < in.count(); ++i) {
    out[i] = in.view<uint8_t>()[i] & uint8_t(~ghost_refined_cell);
    any = any || out[i];
  }
  return any ? a : Array();
}

}  // namespace
}  // namespace vtk

void write_vtk_multiblock(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  vtk::BlockWriter(path, options, context).write(data);
}

void write_vtk_amr(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const DatasetPtr d = single_dataset(data, "an AMR file");
  const auto* grid = d->as<AmrGrid>();
  if (!grid)
    fail_usage(fmt::format("a mesh of kind {} cannot be written to .{}", d->kind(), extension_of(path)), path,
               fmt::format("name the file *.{}", vtk::extension_for(d->mesh())));
  vtk::PartsFolder folder(path);
  const Array ghost = vtk::other_ghosts(d->cell_ghost());
  std::string text = fmt::format(
      "<VTKFile type=\"vtkOverlappingAMR\" version=\"1.1\" byte_order=\"LittleEndian\">\n"
      "  <vtkOverlappingAMR origin=\"{}\" grid_description=\"{}\">\n",
      vtk::point_text(grid->origin), grid->dimension == 2 ? "XY" : "XYZ");
  size_t part = 0;
  for (size_t l = 0; l < grid->levels.size(); ++l) {
    const AmrGrid::Level& level = grid->levels[l];
    text += fmt::format("    <Block level=\"{}\" spacing=\"{}\">\n", l, vtk::point_text(level.spacing));
    for (size_t p = 0; p < level.patches.size(); ++p, ++part) {
      const AmrGrid::Patch& box = level.patches[p];
      vtk::write_dataset(folder.file(part, "vti"), *vtk::patch_dataset(*d, *grid, level, box, ghost), options, context);
      // A flat axis has no cells: its box ends before it begins.
      const long long top = grid->dimension == 2 ? box.lo[2] - 1 : box.hi[2];
      text += fmt::format("      <DataSet index=\"{}\" amr_box=\"{} {} {} {} {} {}\" file=\"{}\"/>\n", p, box.lo[0], box.hi[0], box.lo[1],
                          box.hi[1], box.lo[2], top, vtk::escaped_xml(folder.name(part, "vti")));
    }
    text += "    </Block>\n";
  }
  text += "  </vtkOverlappingAMR>\n</VTKFile>\n";
  folder.commit(text);
}

}  // namespace sg
