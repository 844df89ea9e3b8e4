// SPDX-License-Identifier: Apache-2.0
// Temporal VTKHDF files, step by step: uniform grids, unstructured and surface meshes, point clouds. Arrays hold the steps one after the
// other, and tables in Steps tell where each begins; a mesh that stays the same is stored once. The file can be read while it grows.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "base/error.h"
#include "base/file/file.h"
#include "data/lattice.h"
#include "io/plugins/hdf5/h5_grow.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf_out.h"
#include "io/steps/steps.h"
#include "io/write_losses.h"

namespace sg::vtkhdf {

namespace {

const std::string root = "/VTKHDF/";

/// Rows to append to a dataset of the file.
struct Rows {
  std::string name;  ///< below /VTKHDF
  Array values;
  size_t rows = 0;
  std::vector<hsize_t> row;  ///< dimensions of one of them
};

bool same(const Array& a, const Array& b) {
  if (a.type() != b.type() || a.count() != b.count() || a.components() != b.components()) return false;
  const Array p = a.made_packed(), q = b.made_packed();
  return p.raw() == q.raw() || p.bytes() == 0 || std::memcmp(p.raw(), q.raw(), p.bytes()) == 0;
}

/// What is appended for one step.
class Step {
 public:
  std::vector<Rows> geometry, fields, tables;

  void list(std::vector<Rows>& to, const std::string& name, const Array& a) {
    std::vector<hsize_t> row;
    if (a.components() > 1) row.push_back(hsize_t(a.components()));
    to.push_back({name, a, a.count(), std::move(row)});
  }
  void number(std::vector<Rows>& to, const std::string& name, int64_t n) { list(to, name, Array::from_vector(std::vector<int64_t>{n})); }
  void numbers(std::vector<Rows>& to, const std::string& name, std::vector<int64_t> n) {
    const auto count = hsize_t(n.size());
    to.push_back({name, Array::from_vector(std::move(n)), 1, {count}});
  }
  void cells(const std::string& at, const CellArray& cells) {
    const size_t n = cells.size();
    const CellsView v = cells_view(cells);
    std::vector<int64_t> offsets{0};
    for (size_t i = 0; i < n; ++i) offsets.push_back(int64_t(v.end(i)));
    const auto ids = size_t(offsets.back());
    number(geometry, at + "NumberOfCells", int64_t(n));
    number(geometry, at + "NumberOfConnectivityIds", int64_t(ids));
    list(geometry, at + "Offsets", Array::from_vector(std::move(offsets)));
    list(geometry, at + "Connectivity", wide(cells.connectivity.slice(0, ids)));
  }
  void points(const Points& p) {
    number(geometry, "NumberOfPoints", int64_t(p.count()));
    Array xyz = p.count() > 0 ? coordinates(p) : Array::from_vector(std::vector<float>{});
    geometry.push_back({"Points", std::move(xyz), p.count(), {3}});
  }
};

void add_geometry(Step& s, const UnstructuredMesh& m) {
  s.points(m.points);
  s.cells("", m.cells);
  std::vector<uint8_t> types(m.cells.size());
  for (size_t c = 0; c < types.size(); ++c) types[c] = uint8_t(m.type(c));
  s.list(s.geometry, "Types", Array::from_vector(std::move(types)));
  if (m.polyhedron_faces.empty()) return;
  const CellsView v = cells_view(m.faces);
  std::vector<int64_t> offsets{0}, numbers(m.faces.size());
  for (size_t f = 0; f < v.count; ++f) offsets.push_back(int64_t(v.end(f)));
  std::iota(numbers.begin(), numbers.end(), int64_t(0));
  const auto ids = size_t(offsets.back());
  s.number(s.geometry, "NumberOfFaces", int64_t(numbers.size()));
  s.number(s.geometry, "NumberOfFaceConnectivityIds", int64_t(ids));
  s.number(s.geometry, "NumberOfPolyhedronToFaceIds", int64_t(numbers.size()));
  s.list(s.geometry, "FaceConnectivity", wide(m.faces.connectivity.slice(0, ids)));
  s.list(s.geometry, "FaceOffsets", Array::from_vector(std::move(offsets)));
  s.list(s.geometry, "PolyhedronToFaces", Array::from_vector(std::move(numbers)));
  s.list(s.geometry, "PolyhedronOffsets", wide(m.polyhedron_faces));
}

constexpr std::pair<const char*, CellArray SurfaceMesh::*> surface_lists[] = {{"Vertices/", &SurfaceMesh::vertices},
                                                                              {"Lines/", &SurfaceMesh::lines},
                                                                              {"Polygons/", &SurfaceMesh::polygons},
                                                                              {"Strips/", &SurfaceMesh::strips}};

void add_geometry(Step& s, const SurfaceMesh& m) {
  s.points(m.points);
  for (const auto& [at, list] : surface_lists) s.cells(at, m.*list);
}
void add_geometry(Step& s, const PointCloud& m) {
  SurfaceMesh points;
  points.points = m.points;
  add_geometry(s, points);
}

class VtkhdfSteps final : public StepsWriter {
 public:
  VtkhdfSteps(const std::string& path, StepsPlan plan, bool compress, Context& context)
      : StepsWriter(std::move(plan)),
        path_(path),
        losses_(path, "VTKHDF"),
        file_(std::make_unique<h5::GrowingFile>(path, compress, context)) {
    if (!plan_.resume || !file_exists(path)) return;
    // A file that was broken off is not written to: its steps go into a new one.
    std::vector<double> times;
    std::string recipe;
    {
      const h5::File old(path);
      recipe = old.text_attribute("/VTKHDF", "recipe").value_or("");
      times = step_values(old, "/VTKHDF");
    }
    const size_t there = steps_there(times, recipe, plan_, path);
    ReadOptions options;
    for (size_t k = 0; k < there; ++k) {
      options.step = int64_t(k);
      put(k, single_dataset(read_vtkhdf(path, options, context), "a VTKHDF file"));
    }
    done_ = there;
    if (there > 0) place();
  }

  ~VtkhdfSteps() override {
    const h5::Turn turn;
    file_.reset();
  }

  void finish() override {
    const h5::Turn turn;
    file_->close();
  }

 private:
  void write(size_t step, const Data& data, Context& context) override {
    const h5::Turn turn;
    put(step, single_dataset(data, "a VTKHDF file"));
    if (!placed_) place(), losses_.tell(context);
  }
  void place() { file_->move_into_place(), placed_ = true; }

  void put(size_t step, const DatasetPtr& d) {
    Step s;
    add_mesh(s, *d);
    add_fields(s, *d);
    s.list(s.tables, "Steps/Values", Array::from_vector(std::vector<double>{plan_.times[step]}));
    if (step == 0) begin(s, *d);
    units_.clear(), attributes_.clear();
    for (const auto* part : {&s.geometry, &s.fields, &s.tables})
      for (const Rows& r : *part) {
        if (!file_->has(root + r.name))
          fail_usage(fmt::format("'{}' of step {} is not in the first step", r.name, step), path_,
                     "every step has the arrays of the first; numbered files hold others");
        file_->append(root + r.name, r.values, r.rows);
      }
    file_->set_count("/VTKHDF/Steps", "NSteps", int64_t(step) + 1);
    last_mesh_ = d;
  }

  // Cells of the step before that are the same are not stored again: the tables point to them.
  void add_mesh(Step& s, const Dataset& d) {
    if (const auto* g = d.as<UniformGrid>()) {
      if (last_mesh_ &&
          !(last_mesh_->as<UniformGrid>() && last_mesh_->as<UniformGrid>()->dims == g->dims && last_mesh_->bounds() == d.bounds()))
        fail_usage("the grid changes from step to step", path_, "write a .pvd, or numbered files");
      dims_ = g->dims;
      return;
    }
    std::visit(
        [&](const auto& mesh) {
          if constexpr (requires { add_geometry(s, mesh); }) add_geometry(s, mesh);
          else refuse_kind(d, path_);
        },
        d.mesh());
    const bool unchanged = !geometry_.empty() && geometry_.size() == s.geometry.size() &&
                           std::equal(geometry_.begin(), geometry_.end(), s.geometry.begin(),
                                      [](const Rows& a, const Rows& b) { return same(a.values, b.values); });
    if (unchanged) {
      s.geometry.clear();
    } else {
      begins_.clear();
      const auto begin_of = [&](const std::string& name) { return int64_t(file_->has(root + name) ? file_->rows(root + name) : 0); };
      part_ = begin_of("NumberOfPoints");
      begins_["PointOffsets"] = {begin_of("Points")};
      const bool surface = !d.as<UnstructuredMesh>();
      for (const auto& [at, list] : surface_lists) {
        const std::string of = surface ? at : "";
        // Each part has one offset more than cells.
        begins_["CellOffsets"].push_back(begin_of(of + "Offsets") - part_);
        begins_["ConnectivityIdOffsets"].push_back(begin_of(of + "Connectivity"));
        if (!surface) break;
      }
      geometry_ = s.geometry;
    }
    s.number(s.tables, "Steps/PartOffsets", part_);
    s.number(s.tables, "Steps/NumberOfParts", 1);
    for (const auto& [name, begin] : begins_) {
      if (begin.size() == 1) s.number(s.tables, "Steps/" + name, begin[0]);
      else s.numbers(s.tables, "Steps/" + name, begin);
    }
  }

  void add_fields(Step& s, const Dataset& d) {
    for (const auto& [group, association] : {std::pair("PointData", Association::point), std::pair("CellData", Association::cell),
                                             std::pair("FieldData", Association::whole)}) {
      std::vector<std::string> used;
      const auto add = [&](const std::string& name, const Array& a, const Field* f) {
        const std::string full = fmt::format("{}/{}", group, name);
        if (dims_ && association != Association::whole) {
          std::vector<hsize_t> row;
          for (size_t k = 3; k-- > 0;)
            row.push_back(association == Association::point ? (*dims_)[k] : std::max<size_t>((*dims_)[k] - 1, 1));
          if (a.components() > 1) row.push_back(hsize_t(a.components()));
          s.fields.push_back({full, a, 1, std::move(row)});
        } else {
          s.list(s.fields, full, a);
        }
        s.number(s.tables, fmt::format("Steps/{}Offsets/{}", group, name), int64_t(file_->has(root + full) ? file_->rows(root + full) : 0));
        if (association == Association::whole)
          s.numbers(s.tables, fmt::format("Steps/FieldDataSizes/{}", name), {a.components(), int64_t(a.count())});
        if (f && !f->unit.empty()) units_.emplace_back(full, f->unit);
        const char* attribute = f ? attribute_of(f->role) : nullptr;
        if (attribute && d.fields().with_role(f->role) == f) attributes_.emplace_back(group, attribute, name);
      };
      for (const Field& f : d.fields())
        if (f.association == association) {
          const std::string name = safe_name(f.name, used);
          losses_.renames(f, name);
          add(name, f.array, &f);
        }
      if (association == Association::whole) continue;
      const Array& ghost = association == Association::point ? d.point_ghost() : d.cell_ghost();
      if (!ghost.empty()) add("vtkGhostType", ghost, nullptr);
    }
  }

  // Declares all that the first step has; nothing else can follow.
  void begin(const Step& s, const Dataset& d) {
    if (const auto* g = d.as<UniformGrid>()) {
      write_head(*file_, "/VTKHDF", "ImageData", 2, 0);
      write_head(*file_, "/VTKHDF", *g);
    } else {
      write_head(*file_, "/VTKHDF", d.as<UnstructuredMesh>() ? "UnstructuredGrid" : "PolyData", 2, file_holds_faces(s) ? 5 : 0);
      if (d.as<PointCloud>()) file_->text("/VTKHDF", "Kind", "points");  // ours: a surface without cells is another thing
    }
    file_->text("/VTKHDF", "recipe", plan_.recipe);
    file_->group("/VTKHDF/Steps");
    file_->declare_count("/VTKHDF/Steps", "NSteps");
    std::vector<std::string> groups{"", "Steps"};
    for (const auto* part : {&s.geometry, &s.fields, &s.tables})
      for (const Rows& r : *part) {
        const std::string group = r.name.substr(0, r.name.rfind('/') == std::string::npos ? 0 : r.name.rfind('/'));
        if (std::find(groups.begin(), groups.end(), group) == groups.end()) file_->group(root + group), groups.push_back(group);
        file_->declare(root + r.name, r.values.type(), r.row, r.rows);
      }
    for (const auto& [name, unit] : units_) file_->text(root + name, "units", unit);
    for (const auto& [group, attribute, name] : attributes_) file_->text(root + group, attribute.c_str(), name);
    file_->start();
  }
  static bool file_holds_faces(const Step& s) {
    return std::any_of(s.geometry.begin(), s.geometry.end(), [](const Rows& r) { return r.name == "FaceOffsets"; });
  }

  std::string path_;
  WriteLosses losses_;
  std::unique_ptr<h5::GrowingFile> file_;
  bool placed_ = false;
  DatasetPtr last_mesh_;
  std::optional<std::array<size_t, 3>> dims_;
  std::vector<Rows> geometry_;
  int64_t part_ = 0;
  std::map<std::string, std::vector<int64_t>> begins_;
  std::vector<std::pair<std::string, std::string>> units_;
  std::vector<std::tuple<std::string, std::string, std::string>> attributes_;
};

}  // namespace

std::unique_ptr<StepsWriter> write_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context) {
  const Compression compression = options.compression.value_or(Compression::none);
  if (compression != Compression::none && compression != Compression::zlib)
    fail_usage(fmt::format("VTKHDF files cannot be compressed with '{}'", word_of(compression)), path, "use zlib or none");
  const h5::Turn turn;
  return std::make_unique<VtkhdfSteps>(path, std::move(plan), compression == Compression::zlib, context);
}

}  // namespace sg::vtkhdf
