// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/packets/packet_lines.h"

#include <algorithm>

#include "base/parallel.h"
#include "filter/flow/cursors/tet_cursor.h"

namespace sg::packets {

namespace {

// Bits of three numbers of 10 bits in turn: seeds that are near each other in space get near each other in order.
uint32_t morton(Vec3 unit) {
  uint32_t code = 0;
  for (int a = 0; a < 3; ++a) {
    const auto v = uint32_t(std::clamp(unit[a] * 1024, 0.0, 1023.0));
    for (uint32_t b = 0; b < 10; ++b) code |= (v >> b & 1) << (3 * b + uint32_t(a));
  }
  return code;
}

// Seeds that lie in the mesh's box, by place.
std::vector<uint32_t> in_order(std::span<const Vec3> seeds, const Box3& box) {
  const Vec3 size = box.size();
  std::vector<std::pair<uint32_t, uint32_t>> keys;
  for (size_t i = 0; i < seeds.size(); ++i) {
    Vec3 u;
    for (int a = 0; a < 3; ++a) u[a] = size[a] > 0 ? (seeds[i][a] - box.lo[a]) / size[a] : 0;
    if (u.x >= -1e-6 && u.y >= -1e-6 && u.z >= -1e-6 && u.x <= 1 + 1e-6 && u.y <= 1 + 1e-6 && u.z <= 1 + 1e-6)
      keys.emplace_back(morton(u), uint32_t(i));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<uint32_t> order;
  for (const auto& [key, i] : keys) order.push_back(i);
  return order;
}

// Traces items in chunks by f(items, lines), and puts the lines at their seeds.
template <class Item, class F>
void trace_chunks(const std::vector<Item>& items, const std::vector<uint32_t>& seed, std::vector<Piece>& out, SeedLines& keep, F&& f,
                  Context& context) {
  // Lines do not depend on their chunk, so that its size may depend on the threads.
  const size_t grain = std::clamp<size_t>(items.size() / (4 * size_t(std::max(thread_count(), 1))) + 1, 64, 4096);
  const size_t first = keep.keep.size();
  keep.keep.resize(first + (items.size() + grain - 1) / grain);
  parallel_for(
      items.size(), grain,
      [&](size_t begin, size_t end) {
        auto lines = std::make_unique<Lines>();
        f(std::span(items).subspan(begin, end - begin), *lines);
        for (const Line& l : lines->lines) out[seed[begin + l.item]] = {l.first, l.count, l.stop};
        keep.keep[first + begin / grain] = std::move(lines);
      },
      &context);
}

// All requested directions.
template <class Item, class F>
void trace_directions(std::vector<Item> items, std::vector<uint32_t> seed, size_t seeds, TraceDirection direction, SeedLines& out, F&& f,
                      Context& context) {
  out.backward.resize(seeds), out.forward.resize(seeds);
  if (direction != TraceDirection::forward) {
    trace_chunks(
        items, seed, out.backward, out, [&](std::span<const Item> some, Lines& lines) { f(-1.0f, some, lines); }, context);
    if (direction == TraceDirection::backward) return;
    // A closed line is whole already.
    size_t n = 0;
    for (size_t i = 0; i < items.size(); ++i) {
      const Piece& p = out.backward[seed[i]];
      if (p.count == 0 || p.stop == StopReason::closed) continue;
      items[n] = items[i], seed[n] = seed[i], ++n;
    }
    items.resize(n), seed.resize(n);
  }
  trace_chunks(
      items, seed, out.forward, out, [&](std::span<const Item> some, Lines& lines) { f(1.0f, some, lines); }, context);
}

bool knows(const TraceOptions& o) {
  return o.scheme == Scheme::rk4 || o.scheme == Scheme::midpoint || (o.scheme == Scheme::dormand_prince && o.tolerance >= 1e-12);
}

std::optional<SeedLines> trace_in_grid(const FlowField& field, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& o,
                                       Context& context) {
  const LatticeFlow& l = field.access().lattice;
  if (l.separable || l.flat_axis >= 0 || 3 * (l.cells[0] + 1) * (l.cells[1] + 1) * (l.cells[2] + 1) >= size_t(INT32_MAX))
    return std::nullopt;
  GridInput g;
  g.v = field.f32(), g.length = l.length;
  for (int a = 0; a < 3; ++a) {
    g.cells[a] = int32_t(l.cells[size_t(a)]), g.stride[a] = int32_t(3 * l.stride[size_t(a)]);
    for (int b = 0; b < 3; ++b) g.to_grid[a][b] = l.rows[a][b], g.to_world[a][b] = l.step[b][a];
  }
  SeedLines out;
  out.origin = l.origin;
  std::vector<GridItem> items;
  std::vector<uint32_t> seed;
  for (const uint32_t i : in_order(seeds, field.dataset()->bounds())) {
    GridItem item;
    bool in = true;
    for (int a = 0; a < 3; ++a) {
      const double q = dot(l.rows[a], seeds[i] - l.origin), n = double(l.cells[size_t(a)]);
      in = in && q >= -1e-9 && q <= n + 1e-9;
      const double c = std::clamp(std::floor(q), 0.0, n - 1);
      item.cell[a] = int32_t(c), item.f[a] = std::clamp(q - c, 0.0, 1.0);
    }
    if (in) items.push_back(item), seed.push_back(i);
  }
  trace_directions(
      std::move(items), std::move(seed), seeds.size(), direction, out,
      [&](float sign, std::span<const GridItem> some, Lines& lines) { trace_grid(g, o, sign, some, lines); }, context);
  return out;
}

std::optional<SeedLines> trace_in_tets(const FlowField& field, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& o,
                                       Context& context) {
  const FlowAccess& access = field.access();
  const SimplexArrays& s = access.simplices;
  if (!s.f32) return std::nullopt;
  TetInput t;
  t.points = s.f32, t.v = field.f32(), t.across = access.tets->data();
  t.wide_ids = s.cells.connectivity.wide;
  const size_t first = s.cells.begin(0);
  if (t.wide_ids) t.ids = static_cast<const int64_t*>(s.cells.connectivity.data) + first;
  else t.ids = static_cast<const int32_t*>(s.cells.connectivity.data) + first;
  SeedLines out;
  out.origin = s.origin;

  // Where the seeds are: walks from one to the next, a chunk at a time.
  const PointVectors vectors{field.f32(), nullptr, 3};
  const Box3 box = access.start->box;
  const auto in_box = [&](Vec3 x) {
    for (int a = 0; a < 3; ++a)
      if (!(x[a] >= box.lo[a] && x[a] <= box.hi[a])) return false;
    return true;
  };
  const std::vector<uint32_t> order = in_order(seeds, box);
  std::vector<TetItem> all(order.size());
  parallel_for(
      order.size(), 256,
      [&](size_t begin, size_t end) {
        std::optional<LocatorCursor> tree;
        for (size_t i = begin; i < end; ++i) {
          const Vec3 x = seeds[order[i]], rel = x - s.origin;
          for (int a = 0; a < 3; ++a) all[i].x[a] = rel[a];
          TetCursor cursor(access, vectors);  // from the bin of the seed, whatever was asked before
          const TetCursor::Found found = cursor.find(x);
          all[i].cell = found == TetCursor::Found::here ? int32_t(cursor.cell()) : -1;
          if (found != TetCursor::Found::lost) continue;
          if (!tree) tree.emplace(*access.locator());
          all[i].cell = int32_t(tree->find(x));
        }
      },
      &context);
  std::vector<TetItem> items;
  std::vector<uint32_t> seed;
  for (size_t i = 0; i < all.size(); ++i)
    if (all[i].cell >= 0) items.push_back(all[i]), seed.push_back(order[i]);

  trace_directions(
      std::move(items), std::move(seed), seeds.size(), direction, out,
      [&](float sign, std::span<const TetItem> some, Lines& lines) {
        std::optional<LocatorCursor> tree;
        TetInput own = t;
        own.locate = [&](Vec3 x) -> int64_t {
          x += s.origin;
          if (!in_box(x)) return -1;
          if (!tree) tree.emplace(*access.locator());
          return tree->find(x);
        };
        trace_tets(own, o, sign, some, lines);
      },
      context);
  return out;
}

}  // namespace

std::optional<SeedLines> trace(const FlowField& field, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& o,
                               Context& context) {
  const FlowAccess& access = field.access();
  if (!field.f32() || field.components() != 3 || access.any_hidden || !knows(o)) return std::nullopt;
  if (access.kind == FlowAccess::Kind::lattice) return trace_in_grid(field, seeds, direction, o, context);
  if (access.kind == FlowAccess::Kind::tets) return trace_in_tets(field, seeds, direction, o, context);
  return std::nullopt;
}

}  // namespace sg::packets
