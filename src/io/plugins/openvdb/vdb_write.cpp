// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <openvdb/tools/Dense.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/file/partial_file.h"
#include "io/plugins/openvdb/held_grids.h"
#include "io/plugins/openvdb/vdb.h"
#include "io/volume/lattice_part.h"
#include "io/write_losses.h"

namespace sg {

namespace {

template <class GridType, class T, int N>
openvdb::GridBase::Ptr sparse(const Array& values, const openvdb::CoordBBox& box, double outside = 0) {
  using Value = typename GridType::ValueType;
  const Array packed = values.converted(element_type_of<T>());
  auto* data = const_cast<Value*>(reinterpret_cast<const Value*>(packed.raw()));  // only read
  openvdb::tools::Dense<Value, openvdb::tools::LayoutXYZ> dense(box, data);
  auto grid = GridType::create(Value(T(outside)));
  openvdb::tools::copyFromDense(dense, *grid, openvdb::zeroVal<Value>());  // tolerance 0: what is not background stays as it is
  // A leaf of background and NaN counts as all background there.
  auto tree = grid->getAccessor();
  const T* v = reinterpret_cast<const T*>(packed.raw());
  const openvdb::Coord n = box.dim();
  for (size_t i = 0; i < packed.count(); ++i) {
    bool nan = false;
    for (size_t c = 0; c < N; ++c) nan = nan || v[i * N + c] != v[i * N + c];
    if (nan) tree.setValue({int(i % size_t(n[0])), int(i / size_t(n[0]) % size_t(n[1])), int(i / size_t(n[0]) / size_t(n[1]))}, data[i]);
  }
  return grid;
}

// io::File::write does not look whether its stream took all of it; here a disk that is full is an error.
class Archive : openvdb::io::Archive {
 public:
  explicit Archive(const openvdb::GridPtrVec& grids) : grids_(grids.begin(), grids.end()) {}
  void write_to(const std::string& file, const std::string& path) const {
    errno = 0;
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    if (stream) write(stream, grids_, true);
    stream.flush();
    const bool whole = stream.good();
    stream.close();
    if (!whole || !stream.good()) fail_data(std::string("write failed: ") + std::strerror(errno ? errno : EIO), path);
  }

 private:
  openvdb::GridCPtrVec grids_;
};

// Floats stay what they are; whole numbers become f32, which every program reads, where that changes none of them, else the integers
// that OpenVDB has. Null: neither 1 nor 3 components.
openvdb::GridBase::Ptr grid_of(const Dataset& d, const Field& f, const openvdb::CoordBBox& box, WriteLosses& losses) {
  const Array& a = f.array;
  const bool f32 = a.type() == ElementType::f32 || (a.type() != ElementType::f64 && survives(a, ElementType::f32));
  if (a.components() == 1) {
    // Beyond a level set everything lies outside.
    const double outside = f.look.shows == FieldLook::Shows::zero ? std::max(0.0, d.range(f, 0).hi) : 0;
    if (f32) return sparse<openvdb::FloatGrid, float, 1>(a, box, outside);
    if (a.type() == ElementType::f64) return sparse<openvdb::DoubleGrid, double, 1>(a, box, outside);
    if (a.type() == ElementType::i32) return sparse<openvdb::Int32Grid, int32_t, 1>(a, box);
    if (survives(a, ElementType::i64)) return sparse<openvdb::Int64Grid, int64_t, 1>(a, box);
    losses.rounds(f, ElementType::f64);
    return sparse<openvdb::DoubleGrid, double, 1>(a, box);
  }
  if (a.components() != 3) return nullptr;
  if (f32) return sparse<openvdb::Vec3SGrid, float, 3>(a, box);
  losses.rounds(f, ElementType::f64);
  return sparse<openvdb::Vec3DGrid, double, 3>(a, box);
}

}  // namespace

void write_vdb(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  start_openvdb();
  const DatasetPtr d = single_dataset(data, "writing OpenVDB");
  const UniformGrid* grid_of_data = d->as<UniformGrid>();
  if (!grid_of_data)
    fail_usage(fmt::format("an OpenVDB file holds uniform grids, not a {} mesh", d->kind()), path,
               "sample it on a grid first: -f 'resample'");
  const UniformGrid placed = with_long_axes(*grid_of_data), *g = &placed;
  for (const size_t n : g->dims)
    if (n > size_t(1) << 30) fail_usage(fmt::format("{} points along an axis", n), path);
  const openvdb::Coord last(int(g->dims[0]) - 1, int(g->dims[1]) - 1, int(g->dims[2]) - 1);
  const openvdb::CoordBBox box(openvdb::Coord(0), last);
  openvdb::GridPtrVec grids;
  WriteLosses losses(path, "OpenVDB");
  try {
    // OpenVDB multiplies from the left: the rows are the steps, the last one the origin.
    openvdb::Mat4R map = openvdb::Mat4R::identity();
    for (int a = 0; a < 3; ++a)
      for (int c = 0; c < 3; ++c) map[a][c] = g->direction.m[c][a] * g->spacing[a], map[3][c] = g->origin[c];
    for (const Field& f : d->fields()) {
      const openvdb::GridBase::Ptr grid = f.association == Association::point ? grid_of(*d, f, box, losses) : nullptr;
      if (!grid) {
        losses.leaves_out(f);
        continue;
      }
      losses.drops_unit(f);
      grid->setName(f.name);
      if (f.look.shows == FieldLook::Shows::zero && (grid->isType<openvdb::FloatGrid>() || grid->isType<openvdb::DoubleGrid>()))
        grid->setGridClass(openvdb::GRID_LEVEL_SET);
      grid->setTransform(openvdb::math::Transform::createLinearTransform(map));
      grid->insertMeta(vdb_box_lo, openvdb::Vec3IMetadata(openvdb::Vec3i(0, 0, 0)));
      grid->insertMeta(vdb_box_hi, openvdb::Vec3IMetadata(last.asVec3i()));
      grids.push_back(grid);
    }
    if (grids.empty()) fail_usage("there is no point field of 1 or 3 components to write", path);
    // Written to a temporary file and renamed: never half a file.
    PartialFile partial(path);
    Archive(grids).write_to(partial.name(), path);
    partial.commit();
    losses.tell(context);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    fail_data(fmt::format("OpenVDB cannot write it: {}", e.what()), path);
  }
}

}  // namespace sg
