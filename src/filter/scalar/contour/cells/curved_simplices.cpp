// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/cells/curved_simplices.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_topology.h"

namespace sg::contouring {

namespace {

// Noise bends wherever it is divided. Smooth surfaces that fill the mesh need some 16 / tolerance simplices, the tolerance in parts of the
// mesh's size: several times that is enough.
constexpr double most_by_tolerance = 128, most_per_simplex = 256, always_simplices = 1 << 16, most_simplices = 1 << 22;
constexpr size_t around_edge = 5;                                                 // simplices, each of which becomes two
constexpr uint8_t ends[6][2] = {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}};  // the first three: those of a triangle
int edge_count(const Simplex& s) { return s.corners == 3 ? 3 : 6; }

// Length of the gradient of the linear function on a simplex; the largest slope along an edge where it is flat.
double slope(const std::array<Vec3, 4>& x, const std::array<double, 4>& f, int corners) {
  const Vec3 a = x[1] - x[0], b = x[2] - x[0];
  const double fa = f[1] - f[0], fb = f[2] - f[0];
  double steepest = 0;
  for (int i = 0; i < corners; ++i)
    for (int j = 0; j < i; ++j)
      if (const double l = length(x[size_t(i)] - x[size_t(j)]); l > 0)
        steepest = std::max(steepest, std::abs(f[size_t(i)] - f[size_t(j)]) / l);
  double g = 0;
  if (corners == 3) {
    const Vec3 n = cross(a, b);
    const double area2 = dot(n, n);
    g = length(cross(b, n) * fa + cross(n, a) * fb) / area2;
  } else {
    const Vec3 c = x[3] - x[0];
    const double volume = dot(a, cross(b, c));
    g = length(cross(b, c) * fa + cross(c, a) * fb + cross(a, b) * (f[3] - f[0])) / std::abs(volume);
  }
  return std::isfinite(g) ? g : steepest;
}

}  // namespace

CellMap& CellField::open(size_t cell) {
  if (cell != cell_) {
    cell_ = cell;
    map_.open(cell);
    const auto ids = map_.reader().ids();
    node_values_.resize(ids.size());
    for (size_t k = 0; k < ids.size(); ++k) node_values_[k] = f_[size_t(ids[k])];
    weights_.resize(ids.size());
  }
  return map_;
}

const std::vector<double>& CellField::weights(Vec3 rst) {
  CellPlace place;
  place.rst = rst;
  map_.weights(place, weights_);
  return weights_;
}

double CellField::value(Vec3 rst) {
  weights(rst);
  double s = 0;
  for (size_t k = 0; k < weights_.size(); ++k) s += weights_[k] * node_values_[k];
  return s;
}

Vec3 CellField::gradient(Vec3 rst) {
  CellPlace place;
  place.rst = rst;
  return map_.gradient(place, node_values_);
}

CurvedSimplices::CurvedSimplices(const DatasetPtr& dataset, View<double> values, double value, double tolerance, Context& context)
    : dataset_(dataset), f_(values), value_(value), tolerance_(tolerance), context_(context) {
  CellField field(dataset, values);
  const CellReader reader(dataset);
  for (size_t c = 0; c < reader.count(); ++c) {
    if (c % 1024 == 0) context.check();
    if (!reader.hidden(c)) start(c, field);
  }
  const double needed = most_by_tolerance * dataset->bounds().diagonal() / tolerance + most_per_simplex * double(simplices_.size());
  const auto most = size_t(needed < most_simplices ? std::max(needed, always_simplices) : most_simplices);
  for (int round = 0; round < 40; ++round) {
    context.check();
    find_middles();
    const size_t marked = mark(round);
    if (marked == 0) break;
    if (simplices_.size() + around_edge * marked > most) {
      context.info("contour: curved cells are not subdivided further, since there are too many parts; use a larger tolerance");
      break;
    }
    halve();
  }
  middles_.clear();
}

uint32_t CurvedSimplices::point_of(int64_t id, Vec3 rst, CellField& field) {
  const auto [at, fresh] = corner_.try_emplace(id, uint32_t(points_.size()));
  if (fresh) points_.push_back({field.position(rst), field.value(rst)});
  return at->second;
}

void CurvedSimplices::add_simplex(Simplex s) {
  for (int i = 0; i < s.corners; ++i)
    for (int j = 0; j < i; ++j)
      if (s.v[size_t(i)] == s.v[size_t(j)]) return;  // a cell with merged corners
  const Vec3 a = s.rst[1] - s.rst[0], b = s.rst[2] - s.rst[0];
  const double turn = s.corners == 3 ? cross(a, b).z : dot(a, cross(b, s.rst[3] - s.rst[0]));
  if (turn < 0) std::swap(s.v[1], s.v[2]), std::swap(s.rst[1], s.rst[2]);
  simplices_.push_back(s);
}

void CurvedSimplices::start(size_t cell, CellField& field) {
  CellMap& map = field.open(cell);
  const CellReader& reader = map.reader();
  if (reader.dimension() < 2) return;
  const auto ids = reader.ids();
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (double x : field.nodes()) {
    if (!std::isfinite(x)) return;
    lo = std::min(lo, x), hi = std::max(hi, x);
  }
  // Bezier cells stay between their numbers; others swing beyond them, the more the higher the order.
  const CellShape* shape = CellShape::find(reader.type(), ids.size(), reader.orders());
  if (!shape || shape->dimension() < 2)
    fail_usage(fmt::format("cell {} is a {} in a mesh with curved cells", cell, cell_type_info(reader.type()).name), "contour",
               "tessellate the mesh first: -f tessellate");
  const auto orders = shape->orders();
  const int order = std::max({orders[0], orders[1], orders[2], shape->degree()});
  const double reach = order == 1 || is_bezier(reader.type()) ? 0 : (order == 2 ? 0.5 : 1.0) * (hi - lo);
  if (!(lo - reach <= value_ && value_ <= hi + reach)) return;
  int rounds = 0;
  while (1 << rounds < order) ++rounds;
  rounds_[uint32_t(cell)] = uint8_t(rounds);

  const CellType base = linear_type(reader.type());
  const LinearTopology& t = *linear_topology(base);
  Simplex s;
  s.cell = uint32_t(cell);
  auto put = [&](size_t k, size_t corner) {
    s.rst[k] = shape->node(corner);
    s.v[k] = point_of(ids[corner], s.rst[k], field);
  };
  // A polygon from its lowest corner.
  auto fan = [&](std::span<const uint8_t> face, auto&& emit) {
    size_t low = 0;
    for (size_t k = 1; k < face.size(); ++k)
      if (ids[face[k]] < ids[face[low]]) low = k;
    for (size_t k = 1; k + 1 < face.size(); ++k) emit(face[low], face[(low + k) % face.size()], face[(low + k + 1) % face.size()]);
  };
  if (shape->dimension() == 2) {
    s.corners = 3;
    const std::array<uint8_t, 4> ring = base == CellType::pixel ? std::array<uint8_t, 4>{0, 1, 3, 2} : std::array<uint8_t, 4>{0, 1, 2, 3};
    fan(std::span(ring).first(size_t(t.corners)), [&](uint8_t a, uint8_t b, uint8_t c) {
      put(0, a), put(1, b), put(2, c);
      add_simplex(s);
    });
    return;
  }
  const Mat3 j = map.jacobian(shape->center());
  s.flipped = dot(j * Vec3(1, 0, 0), cross(j * Vec3(0, 1, 0), j * Vec3(0, 0, 1))) < 0;
  uint8_t low = 0;
  for (uint8_t k = 1; k < t.corners; ++k)
    if (ids[k] < ids[low]) low = k;
  for (size_t f = 0; f < t.face_count(); ++f) {
    const auto face = t.face(f);
    if (std::find(face.begin(), face.end(), low) != face.end()) continue;
    fan(face, [&](uint8_t a, uint8_t b, uint8_t c) {
      put(0, a), put(1, b), put(2, c), put(3, low);
      add_simplex(s);
    });
  }
}

// Field and place in the middle of every edge, in the first cell that has it.
void CurvedSimplices::find_middles() {
  struct Wanted {
    uint64_t key;
    uint32_t simplex;
    uint8_t edge;
  };
  std::vector<Wanted> wanted;
  for (size_t i = 0; i < simplices_.size(); ++i)
    for (int e = 0; e < edge_count(simplices_[i]); ++e) {
      const Simplex& s = simplices_[i];
      const uint64_t k = key(s.v[ends[e][0]], s.v[ends[e][1]]);
      if (middles_.try_emplace(k).second) wanted.push_back({k, uint32_t(i), uint8_t(e)});
    }
  std::vector<Point> found(wanted.size());
  parallel_for(
      wanted.size(), 512,
      [&](size_t begin, size_t end) {
        CellField field(dataset_, f_);
        for (size_t i = begin; i < end; ++i) {
          const Simplex& s = simplices_[wanted[i].simplex];
          field.open(s.cell);
          const Vec3 rst = (s.rst[ends[wanted[i].edge][0]] + s.rst[ends[wanted[i].edge][1]]) * 0.5;
          found[i] = {field.position(rst), field.value(rst)};
        }
      },
      &context_);
  for (size_t i = 0; i < wanted.size(); ++i) middles_[wanted[i].key].at = found[i];
}

// Drops what the surface cannot reach and numbers the middles of edges that must be halved. How many those are.
size_t CurvedSimplices::mark(int round) {
  size_t kept = 0;
  std::vector<uint64_t> marked;
  for (size_t i = 0; i < simplices_.size(); ++i) {
    const Simplex s = simplices_[i];
    const int edges = edge_count(s);
    std::array<Vec3, 4> x;
    std::array<double, 4> f{};
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (size_t k = 0; k < s.corners; ++k) {
      x[k] = points_[s.v[k]].x, f[k] = points_[s.v[k]].f;
      lo = std::min(lo, f[k]), hi = std::max(hi, f[k]);
    }
    double bend[6], off[6], most = 0;
    uint64_t keys[6];
    for (int e = 0; e < edges; ++e) {
      const size_t a = ends[e][0], b = ends[e][1];
      keys[e] = key(s.v[a], s.v[b]);
      const Point& m = middles_.find(keys[e])->second.at;
      bend[e] = std::abs(m.f - 0.5 * (f[a] + f[b]));
      off[e] = length(m.x - (x[a] + x[b]) * 0.5);
      most = std::max(most, bend[e]);
      lo = std::min(lo, m.f), hi = std::max(hi, m.f);
    }
    const bool first = round < rounds_[s.cell];
    const double margin = (first ? 4 : 2) * most;
    if (!(lo - margin <= value_ && value_ <= hi + margin)) continue;
    simplices_[kept++] = s;
    const double allowed = 0.5 * tolerance_, g = slope(x, f, s.corners);
    for (int e = 0; e < edges; ++e) {
      const double l = length(x[ends[e][0]] - x[ends[e][1]]);
      if (first || (l > tolerance_ && (off[e] > allowed || bend[e] > allowed * g))) marked.push_back(keys[e]);
    }
  }
  simplices_.resize(kept);
  std::sort(marked.begin(), marked.end());
  marked.erase(std::unique(marked.begin(), marked.end()), marked.end());
  for (uint64_t k : marked) {
    Middle& m = middles_[k];
    m.number = uint32_t(points_.size());
    points_.push_back(m.at);
  }
  if (points_.size() > size_t(UINT32_MAX) / 2) fail_usage("the surface has too many points", "contour", "use a larger tolerance");
  return marked.size();
}

void CurvedSimplices::halve() {
  constexpr size_t grain = 4096;
  std::vector<std::vector<Simplex>> parts(simplices_.size() / grain + 1);
  parallel_for(
      simplices_.size(), grain,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) split(simplices_[i], parts[begin / grain]);
      },
      &context_);
  simplices_.clear();
  for (const auto& p : parts) simplices_.insert(simplices_.end(), p.begin(), p.end());
  std::erase_if(middles_, [](const auto& m) { return m.second.number != UINT32_MAX; });  // those edges are gone
}

// The longest marked edge first; a tie by name. All of it follows from the edge alone.
void CurvedSimplices::split(const Simplex& s, std::vector<Simplex>& out) const {
  int best = -1;
  uint32_t middle = 0;
  double longest = -1;
  uint64_t name = 0;
  for (int e = 0; e < edge_count(s); ++e) {
    const uint32_t a = s.v[ends[e][0]], b = s.v[ends[e][1]];
    const uint64_t k = key(a, b);
    const auto m = middles_.find(k);
    if (m == middles_.end() || m->second.number == UINT32_MAX) continue;
    const Vec3 d = points_[std::max(a, b)].x - points_[std::min(a, b)].x;
    const double l = dot(d, d);
    if (l > longest || (l == longest && k > name)) best = e, longest = l, name = k, middle = m->second.number;
  }
  if (best < 0) {
    out.push_back(s);
    return;
  }
  const Vec3 rst = (s.rst[ends[best][0]] + s.rst[ends[best][1]]) * 0.5;
  for (const size_t end : {size_t(ends[best][0]), size_t(ends[best][1])}) {
    Simplex half = s;
    half.v[end] = middle, half.rst[end] = rst;
    split(half, out);
  }
}

}  // namespace sg::contouring
