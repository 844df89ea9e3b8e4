// SPDX-License-Identifier: Apache-2.0
#include "data/content_hash.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <type_traits>
#include <variant>

#include "data/memory/memo.h"

namespace sg {

namespace {

class ContentSum {
 public:
  ContentSum() { XXH3_128bits_reset(state_.get()); }

  std::string text() const {
    const XXH128_hash_t h = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", h.high64, h.low64);
  }

  void add(std::string_view word) { add(uint64_t(word.size())), bytes(word.data(), word.size()); }
  template <class T>
  requires std::is_arithmetic_v<T>
  void add(T number) { bytes(&number, sizeof number); }
  void add(const Vec3& p) { add(p.x), add(p.y), add(p.z); }
  template <class T, size_t N>
  void add(const std::array<T, N>& numbers) {
    for (const T n : numbers) add(int64_t(n));
  }
  void add(const Array& a) {
    add(uint64_t(a.count())), add(uint64_t(a.components())), add(uint64_t(a.type()));
    if (a.packed()) return bytes(a.raw(), a.bytes());
    dispatch(a, [&](auto v) {
      const size_t m = size_t(v.components);
      list(v.count * m, [&](size_t i) { return v(i / m, int(i % m)); });
    });
  }
  void add(const Points& p) { add(p.origin), add(p.xyz); }
  void add(const CellArray& c) {
    const CellsView v = cells_view(c);
    add(uint64_t(v.count));
    list(v.count, [&](size_t i) { return uint64_t(v.size(i)); });
    list(c.connectivity.count(), [&](size_t i) { return v.connectivity[i]; });
  }
  void add(const UniformGrid& g) {
    add(g.dims), add(g.origin), add(g.spacing);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) add(g.direction.m[r][c]);
  }
  void add(const RectilinearGrid& g) { add(g.x), add(g.y), add(g.z); }
  void add(const CurvilinearGrid& g) { add(g.dims), add(g.points); }
  void add(const UnstructuredMesh& m) {
    add(m.points), add(m.cells);
    list(m.cells.size(), [&](size_t c) { return uint8_t(m.type(c)); });
    add(m.faces), add(m.polyhedron_faces), add(m.degrees), add(m.weights);
  }
  void add(const SurfaceMesh& m) { add(m.points), add(m.vertices), add(m.lines), add(m.polygons), add(m.strips); }
  void add(const PointCloud& c) { add(c.points); }
  void add(const AmrGrid& g) {
    add(g.dimension), add(g.origin);
    for (const AmrGrid::Level& l : g.levels) {
      add(l.spacing), add(l.ratio), add(uint64_t(l.patches.size()));
      for (const AmrGrid::Patch& p : l.patches) add(p.lo), add(p.hi), add(uint64_t(p.cell_offset)), add(uint64_t(p.point_offset));
    }
  }

 private:
  struct Free {
    void operator()(XXH3_state_t* s) const { XXH3_freeState(s); }
  };
  void bytes(const void* data, size_t size) { XXH3_128bits_update(state_.get(), data, size); }
  // Of number(0), number(1), ... as if they lay in a row.
  template <class F>
  void list(size_t count, F&& number) {
    std::array<decltype(number(size_t(0))), 4096> block;
    for (size_t first = 0; first < count; first += block.size()) {
      const size_t n = std::min(block.size(), count - first);
      for (size_t i = 0; i < n; ++i) block[i] = number(first + i);
      bytes(block.data(), n * sizeof block[0]);
    }
  }
  std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
};

}  // namespace

std::string content_hash(const Dataset& data, const std::vector<const Field*>& fields) {
  std::string key = "content hash";
  for (const Field* f : fields) key += fmt::format(" {}:{} {}", association_name(f->association), f->name.size(), f->name);
  if (const auto known = data.memo().find<std::string>(key)) return *known;
  ContentSum sum;
  sum.add(data.kind());
  std::visit([&](const auto& mesh) { sum.add(mesh); }, static_cast<const MeshKinds&>(data.mesh()));
  sum.add(data.point_ghost()), sum.add(data.cell_ghost());
  for (const Field* f : fields) sum.add(f->name), sum.add(association_name(f->association)), sum.add(f->array);
  return *data.memo().keep(key, sum.text(), key.size() + 32);
}

}  // namespace sg
