// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "base/bytes.h"
#include "base/error.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/isolated/isolated.h"
#include "io/plugin.h"
#include "io/plugins/openvdb/vdb.h"
#include "io/volume/direction.h"
#include "io/volume/lattice_part.h"

namespace sg {

namespace {

// Bytes of one dense field: what is stated, else what a file of this size may reasonably unfold to, 256 MiB to 8 GiB.
size_t budget_for(const std::string& path, const Context& context) {
  if (context.memory_limit) return context.memory_limit;
  return std::clamp(MappedFile(path).size() * 4096, size_t(256) << 20, size_t(8) << 30);
}

using openvdb::Coord;
using openvdb::CoordBBox;

/// Grids that share a map: fields of one dense grid.
struct Group {
  std::vector<openvdb::GridBase::ConstPtr> grids;
  Vec3 origin, step[3];
  CoordBBox box;
};

CoordBBox box_of(const openvdb::GridBase& g) {
  CoordBBox box = g.evalActiveVoxelBoundingBox();
  const auto lo = g.getMetadata<openvdb::Vec3IMetadata>(vdb_box_lo), hi = g.getMetadata<openvdb::Vec3IMetadata>(vdb_box_hi);
  if (lo && hi) {
    const CoordBBox told(Coord(lo->value()), Coord(hi->value()));
    if (!told.empty() && (box.empty() || told.isInside(box))) return told;
  }
  return box;
}

std::vector<Group> group(const std::vector<openvdb::GridBase::ConstPtr>& grids, const std::string& path, Context& context) {
  std::vector<Group> groups;
  for (const auto& g : grids) {
    const CoordBBox box = box_of(*g);
    if (box.empty()) {
      context.info(fmt::format("{}: grid '{}' has no active voxel and is left out", path, g->getName()));
      continue;
    }
    Group one{{g}, {}, {}, box};
    if (!vdb_affine(*g, one.origin, one.step))
      fail_data(fmt::format("grid '{}' has a transform that is not affine ({})", g->getName(), g->transform().mapType()), path,
                "frustums are not supported");
    bool found = false;
    for (Group& other : groups)
      if (other.grids[0]->transform() == g->transform()) {
        other.grids.push_back(g);
        other.box.expand(box);
        found = true;
        break;
      }
    if (!found) groups.push_back(std::move(one));
  }
  return groups;
}

// The wanted voxels along one axis that lie in first..last of the index space: from, to (exclusive), counted over the wanted ones.
std::pair<size_t, size_t> covered(int first, int last, int lo, const LatticePart& part, int axis) {
  const size_t a = size_t(axis);
  const int64_t begin = int64_t(lo) + int64_t(part.lo[a]), step = int64_t(part.stride[a]);
  const int64_t from = first <= begin ? 0 : (first - begin + step - 1) / step;
  const int64_t to = last < begin ? 0 : (last - begin) / step + 1;
  return {size_t(from), std::min(size_t(to), part.count[a])};
}

// Calls f(place of the result, coordinate) for the wanted voxels of a box.
template <class F>
void each_voxel(const CoordBBox& voxels, const Coord& lo, const LatticePart& part, F&& f) {
  std::pair<size_t, size_t> r[3];
  for (int a = 0; a < 3; ++a) {
    r[a] = covered(voxels.min()[a], voxels.max()[a], lo[a], part, a);
    if (r[a].first >= r[a].second) return;
  }
  for (size_t k = r[2].first; k < r[2].second; ++k)
    for (size_t j = r[1].first; j < r[1].second; ++j)
      for (size_t i = r[0].first; i < r[0].second; ++i)
        f(i + part.count[0] * (j + part.count[1] * k),
          lo.offsetBy(int(part.lo[0] + i * part.stride[0]), int(part.lo[1] + j * part.stride[1]), int(part.lo[2] + k * part.stride[2])));
}

// Background, then tiles, then leaves. Not by the library's own copyToDense: that needs threads, which a reading process lacks.
template <class GridType, class T, int N>
Array dense(const GridType& grid, const CoordBBox& box, const LatticePart& part) {
  using Value = typename GridType::ValueType;
  T* out = nullptr;
  Array a = Array::make<T>(part.points(), N, &out);
  auto put = [&](size_t at, const Value& v) {
    if constexpr (N == 3) out[3 * at] = v[0], out[3 * at + 1] = v[1], out[3 * at + 2] = v[2];
    else out[at] = T(v);
  };
  const Value background = grid.background();
  for (size_t i = 0; i < part.points(); ++i) put(i, background);
  const auto& tree = grid.tree();
  auto tile = tree.cbeginValueAll();
  for (tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1); tile; ++tile) {
    const Value v = *tile;
    if (v == background) continue;
    each_voxel(tile.getBoundingBox(), box.min(), part, [&](size_t at, const Coord&) { put(at, v); });
  }
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
    each_voxel(leaf->getNodeBoundingBox(), box.min(), part, [&](size_t at, const Coord& c) { put(at, leaf->getValue(c)); });
  return a;
}

// Calls f(grid, T(), components) with the concrete type; false when there are no numbers in it.
template <class F>
bool with_type(const openvdb::GridBase& g, F&& f) {
  using namespace openvdb;
  auto is = [&](auto* grid) {
    using G = std::remove_pointer_t<decltype(grid)>;
    return g.isType<G>() ? static_cast<const G*>(&g) : nullptr;
  };
  if (auto* p = is((FloatGrid*)nullptr)) return f(*p, float(), std::integral_constant<int, 1>()), true;
  if (auto* p = is((DoubleGrid*)nullptr)) return f(*p, double(), std::integral_constant<int, 1>()), true;
  if (auto* p = is((Int32Grid*)nullptr)) return f(*p, int32_t(), std::integral_constant<int, 1>()), true;
  if (auto* p = is((Int64Grid*)nullptr)) return f(*p, int64_t(), std::integral_constant<int, 1>()), true;
  if (auto* p = is((BoolGrid*)nullptr)) return f(*p, uint8_t(), std::integral_constant<int, 1>()), true;
  if (auto* p = is((Vec3SGrid*)nullptr)) return f(*p, float(), std::integral_constant<int, 3>()), true;
  if (auto* p = is((Vec3DGrid*)nullptr)) return f(*p, double(), std::integral_constant<int, 3>()), true;
  if (auto* p = is((Vec3IGrid*)nullptr)) return f(*p, int32_t(), std::integral_constant<int, 3>()), true;
  return false;
}

DatasetPtr make_grid(const Group& g, const std::string& path, const ReadOptions& options, Context& context) {
  DatasetParts out;
  UniformGrid grid;
  const Coord lo = g.box.min();
  for (int a = 0; a < 3; ++a) {
    grid.dims[size_t(a)] = size_t(int64_t(g.box.max()[a]) - g.box.min()[a] + 1);
    grid.spacing[a] = length(g.step[a]);
  }
  grid.origin = g.origin + g.step[0] * double(lo[0]) + g.step[1] * double(lo[1]) + g.step[2] * double(lo[2]);
  grid.direction = direction_of(g.step, 3, path);
  grid.extent_start = {lo[0], lo[1], lo[2]};
  const std::array<size_t, 3> whole = grid.dims;
  uint64_t points = 0;
  if (!multiply(whole[0], whole[1], points) || !multiply(points, whole[2], points)) fail_data("the dense box is too large", path);
  const LatticePart part = cut_grid(grid, options.region);
  out.mesh = grid;
  const size_t budget = budget_for(path, context);
  for (const auto& one : g.grids) {
    std::string name = one->getName().empty() ? "values" : one->getName();
    while (out.fields.find(name, Association::point)) name += "'";
    const bool known = with_type(*one, [&](const auto& typed, auto zero, auto components) {
      using T = decltype(zero);
      constexpr int n = decltype(components)::value;
      uint64_t bytes = 0;
      if (!multiply(part.points(), sizeof(T) * n, bytes) || bytes > budget)
        fail_data(fmt::format("grid '{}' is {} x {} x {} voxels when made dense: {}, more than {}", name, part.count[0], part.count[1],
                              part.count[2], human_bytes(bytes), human_bytes(budget)),
                  path, "read a region of it or every n-th voxel, or allow more memory");
      if (options.header_only) return;
      const Role role = n == 3 ? Role::vectors : out.fields.empty() ? Role::scalars : Role::none;
      FieldLook look;
      if (n == 1 && one->getGridClass() == openvdb::GRID_LEVEL_SET) look.shows = FieldLook::Shows::zero;
      out.fields.add({name, Association::point, dense<std::decay_t<decltype(typed)>, T, n>(typed, g.box, part), "", role, look});
    });
    if (!known) context.warn(fmt::format("{}: grid '{}' of type {} holds no numbers of a supported type", path, name, one->valueType()));
    if (one->getGridClass() != openvdb::GRID_UNKNOWN)
      out.notes.emplace_back(name, openvdb::GridBase::gridClassToMenuName(one->getGridClass()));
  }
  return make_dataset(std::move(out));
}

std::vector<openvdb::GridBase::ConstPtr> load_grids(const std::string& path, const ReadOptions& options) {
  std::vector<openvdb::GridBase::ConstPtr> grids;
  openvdb::io::File file(path);
  file.open(false);
  for (auto name = file.beginName(); name != file.endName(); ++name) {
    std::string plain = name.gridName();
    plain.resize(std::min(plain.find('['), plain.size()));  // name[1], name[2] distinguish grids of the same name
    if (plain.empty()) plain = "values";
    const bool wanted = options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), plain) != options.fields.end();
    const auto head = file.readGridMetadata(name.gridName());
    if (wanted || head->valueType() == "ptdataidx32") grids.push_back(file.readGrid(name.gridName()));
  }
  file.close();
  return grids;
}

}  // namespace

void start_openvdb() {
  static const bool once = (openvdb::initialize(), true);
  (void)once;
}

bool vdb_affine(const openvdb::GridBase& grid, Vec3& origin, Vec3 step[3]) {
  if (!grid.transform().isLinear()) return false;
  const auto o = grid.transform().indexToWorld(openvdb::Vec3d(0, 0, 0));
  origin = {o[0], o[1], o[2]};
  for (int a = 0; a < 3; ++a) {
    openvdb::Vec3d unit(0, 0, 0);
    unit[a] = 1;
    const auto p = grid.transform().indexToWorld(unit) - o;
    step[a] = {p[0], p[1], p[2]};
  }
  return true;
}

namespace {

Data read_all(const std::string& path, const ReadOptions& options, Context& context) {
  start_openvdb();
  Collection all;
  try {
    // Grids end with the process: the library empties their trees by several threads, which a reading process lacks.
    const auto& grids = *new auto(load_grids(path, options));
    std::vector<openvdb::GridBase::ConstPtr> volumes;
    for (const auto& g : grids) {
      context.check();
      if (is_vdb_points(*g)) all.parts.push_back({g->getName().empty() ? "points" : g->getName(), vdb_points(*g, path, options, context)});
      else volumes.push_back(g);
    }
    for (const Group& g : group(volumes, path, context)) {
      std::string name;
      for (const auto& one : g.grids) name += (name.empty() ? "" : ", ") + one->getName();
      all.parts.push_back({name, make_grid(g, path, options, context)});
    }
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    fail_data(fmt::format("OpenVDB cannot read it: {}", e.what()), path);
  }
  if (all.parts.empty()) fail_data("no grid in it has an active voxel", path);
  if (all.parts.size() == 1) return all.parts[0].data;
  return std::make_shared<const Collection>(std::move(all));
}

}  // namespace

Data read_vdb(const std::string& path, const ReadOptions& options, Context& context) {
  const size_t budget = budget_for(path, context);
  ChildLimits limits = reading_limits(bytes_at(path));
  limits.memory = 2 * budget + (size_t(256) << 20);  // the tree, the dense numbers, and room for the library itself
  return read_isolated(
      path, limits, [&](Context& c) { return read_all(path, options, c); }, context);
}

}  // namespace sg

SG_PLUGIN_FORMATS({"vdb", sg::read_vdb, sg::write_vdb, nullptr})
