// SPDX-License-Identifier: Apache-2.0
// MFEM: meshes ("*.mesh", with the grid functions "*.gf" beside them), grid functions (with the mesh beside them), and what GLVis
// saves ("*.saved": a mesh and a grid function in one file). Elements become Lagrange cells of the highest order among positions and
// fields, NURBS patches rational Bezier cells; "attribute" is a cell field. Boundary elements are left out.
#include <fmt/core.h>

#include <algorithm>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/mfem/mesh_file.h"

namespace sg {

namespace mfem {

namespace {

bool starts_mesh(std::string_view s) {
  for (const char* first : {"MFEM mesh v1.", "MFEM NC mesh v1.", "MFEM NURBS mesh v1.", "MFEM INLINE mesh v1."})
    if (s.starts_with(first)) return true;
  return false;
}
bool starts_function(std::string_view s) {
  return s.starts_with("FiniteElementSpace") || s.starts_with("ComplexGridFunction") || s.starts_with("MFEM FiniteElementSpace");
}

std::string_view as_text(std::span<const std::byte> head) { return {reinterpret_cast<const char*>(head.data()), head.size()}; }

// What GLVis writes before the mesh.
bool is_stream_word(std::string_view w) {
  for (const char* known : {"solution", "mesh", "fem2d_gf_data", "fem2d_gf_data_keys", "vfem2d_gf_data", "vfem2d_gf_data_keys",
                            "fem3d_gf_data", "fem3d_gf_data_keys", "vfem3d_gf_data", "vfem3d_gf_data_keys", "quadrature"})
    if (w == known) return true;
  return false;
}

bool wanted(const ReadOptions& options, std::string_view name) {
  return options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end();
}

// One grid function (two of a complex one) on a mesh.
void parse_function(TextCursor& in, const MeshFile& mesh, const std::string& name, const ReadOptions& options,
                    std::vector<GridFunction>& out) {
  const bool complex = in.peek() == "ComplexGridFunction";
  if (complex) in.word();
  GridFunction f;
  f.space = parse_space(in);
  const size_t n = mesh.nurbs && f.space.collection.family == Family::nurbs ? nurbs_size(mesh, in.where())
                                                                            : space_size(mesh.topology, f.space.collection, in.where());
  for (const char* part : complex ? std::vector<const char*>{"_real", "_imaginary"} : std::vector<const char*>{""}) {
    f.name = name + part;
    f.values = parse_values(in, n * size_t(f.space.vdim));
    if (wanted(options, f.name)) out.push_back(f);
  }
}

DatasetPtr make(const MeshFile& mesh, const std::vector<GridFunction>& fields, const std::string& where, Context& context) {
  return mesh.nurbs ? nurbs_dataset(mesh, fields, where) : lagrange_dataset(mesh, fields, where, context);
}

// "a/b" of "a/b.mesh".
std::string stem_of(const std::string& path) {
  const size_t dot = path.rfind('.');
  return dot == std::string::npos || path.find('/', dot) != std::string::npos ? path : path.substr(0, dot);
}

// Grid functions that belong to X.mesh: X.gf, X.NAME.gf, X-NAME.gf, X_NAME.gf; with the names of their fields.
std::vector<std::pair<std::string, std::string>> functions_beside(const std::string& path) {
  std::vector<std::pair<std::string, std::string>> r;
  const std::string folder = folder_of(path), stem = file_name_of(stem_of(path));
  for (const std::string& name : folder_entries(folder.empty() ? "." : folder)) {
    if (!name.ends_with(".gf") || !name.starts_with(stem)) continue;
    const std::string rest = name.substr(stem.size(), name.size() - stem.size() - 3);
    if (rest.empty()) r.emplace_back(folder + name, stem);
    else if (rest.size() > 1 && (rest[0] == '.' || rest[0] == '-' || rest[0] == '_')) r.emplace_back(folder + name, rest.substr(1));
  }
  return r;
}

std::string mesh_beside(const std::string& path) {
  std::string stem = stem_of(path);
  if (file_exists(stem + ".mesh")) return stem + ".mesh";
  // X.NAME.gf, X-NAME.gf, X_NAME.gf: the longest X that has a mesh.
  const std::string folder = folder_of(path);
  for (size_t n = stem.size(); n-- > folder.size() + 1;)
    if ((stem[n] == '.' || stem[n] == '-' || stem[n] == '_') && file_exists(stem.substr(0, n) + ".mesh"))
      return stem.substr(0, n) + ".mesh";
  std::vector<std::string> meshes;
  for (const std::string& name : folder_entries(folder.empty() ? "." : folder))
    if (name.ends_with(".mesh")) meshes.push_back(folder + name);
  if (meshes.size() == 1) return meshes[0];
  fail_data("the mesh of the grid function is missing", path,
            fmt::format("put the mesh beside it as '{}.mesh', or keep only one mesh in the folder", file_name_of(stem)));
}

MeshFile mesh_of(const std::string& path) {
  const MappedFile file(path);
  TextCursor in(file.text(), path, '#');
  return parse_mesh(in);
}

}  // namespace
}  // namespace mfem

bool sniff_mfem_mesh(std::span<const std::byte> head) { return mfem::starts_mesh(mfem::as_text(head)); }
bool sniff_mfem_function(std::span<const std::byte> head) { return mfem::starts_function(mfem::as_text(head)); }
bool sniff_glvis(std::span<const std::byte> head) {
  std::string_view s = mfem::as_text(head);
  const size_t end = s.find('\n');
  if (end == std::string_view::npos || !mfem::is_stream_word(trim(s.substr(0, end)))) return false;
  s.remove_prefix(end);
  while (!s.empty() && (s[0] == '\n' || s[0] == '\r' || s[0] == ' ')) s.remove_prefix(1);
  return mfem::starts_mesh(s);
}

Data read_mfem_mesh(const std::string& path, const ReadOptions& options, Context& context) {
  const mfem::MeshFile mesh = mfem::mesh_of(path);
  std::vector<mfem::GridFunction> fields;
  for (const auto& [file, name] : mfem::functions_beside(path)) {
    if (!mfem::wanted(options, name) && !mfem::wanted(options, name + "_real") && !mfem::wanted(options, name + "_imaginary")) continue;
    const MappedFile mapped(file);
    TextCursor in(mapped.text(), file, '#');
    mfem::parse_function(in, mesh, name, options, fields);
  }
  return mfem::make(mesh, fields, path, context);
}

Data read_mfem_function(const std::string& path, const ReadOptions& options, Context& context) {
  const std::string mesh_path = mfem::mesh_beside(path);
  const mfem::MeshFile mesh = mfem::mesh_of(mesh_path);
  std::string name = file_name_of(mfem::stem_of(path));
  for (const auto& [file, field] : mfem::functions_beside(mesh_path))
    if (file == path) name = field;
  std::vector<mfem::GridFunction> fields;
  const MappedFile mapped(path);
  TextCursor in(mapped.text(), path, '#');
  mfem::parse_function(in, mesh, name, options, fields);
  return mfem::make(mesh, fields, path, context);
}

Data read_glvis(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  TextCursor in(file.text(), path, '#');
  const std::string_view kind = in.word();
  const mfem::MeshFile mesh = mfem::parse_mesh(in);
  if (in.peek() == "mfem_mesh_end") in.word();
  std::vector<mfem::GridFunction> fields;
  if (kind == "quadrature" || in.peek() == "QuadratureSpace")
    in.fail("quadrature functions are not supported", "project them onto an L2 space before saving");
  const bool more = !in.at_end();
  if (more && mfem::starts_function(in.text().substr(in.position()))) mfem::parse_function(in, mesh, "solution", options, fields);
  else if (kind != "mesh") in.fail("the grid function is missing", "expected a line 'FiniteElementSpace' after the mesh");
  return mfem::make(mesh, fields, path, context);
}

}  // namespace sg
