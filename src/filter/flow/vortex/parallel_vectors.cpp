// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/parallel_vectors.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>

#include "base/parallel.h"
#include "data/cell_reader.h"
#include "data/cell_topology.h"
#include "filter/field/point_cell.h"
#include "filter/flow/eigen_general.h"
#include "filter/flow/flow_parts.h"
#include "filter/mesh/append.h"
#include "filter/probe/field_sampler.h"
#include "filter/scalar/isolines.h"

namespace sg {

namespace {

constexpr double pi = 3.14159265358979323846;

// A corner of a tetrahedron: a point of the mesh, or the middle of a cell (number: points of the mesh + cell).
struct Corner {
  int64_t id;
  Vec3 at, a, b;
  double most_a, most_b;  // lengths of a and b in the cells around: what counts as nothing
  bool parallel;          // here
};

// A point of the lines belongs to a corner, to an edge between two or to a triangle between three; smaller ids first, none = -1. So what
// lies exactly on an edge is the same point for all triangles there.
struct Key {
  std::array<int64_t, 3> corners;
  int place;  // which of up to three solutions
  friend auto operator<=>(const Key&, const Key&) = default;
};

struct Found {
  Key key;
  Vec3 at;
  double s[3];          // barycentric, in the order of the key
  double x[4];          // in the tetrahedron
  unsigned corners;     // of the tetrahedron, those that the key names, in bits
  double ratio, angle;  // a cos(angle) = b sin(angle), in units of the tetrahedron's largest values; (-pi/2, pi/2]
  int64_t cell;
};

struct Segment {
  Key from, to;
  int64_t cell;
};

Mat3 columns(Vec3 a, Vec3 b, Vec3 c) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.m[i][0] = a[i], m.m[i][1] = b[i], m.m[i][2] = c[i];
  return m;
}

double largest(const Mat3& m) {
  double most = 0;
  for (const auto& row : m.m)
    for (const double e : row) most = std::max(most, std::abs(e));
  return most;
}

// Can the cross product of the two fields vanish between these corners? Its components are quadratic forms in the barycentric
// coordinates: no, when all coefficients of one have the same sign. `at(i)`: the fields of corner i; `least`: what counts as nothing.
template <class At>
bool may_vanish(size_t n, double least, At&& at) {
  bool plus[3] = {true, true, true}, minus[3] = {true, true, true};
  for (size_t i = 0; i < n; ++i) {
    const auto [a, b] = at(i);
    for (size_t j = i; j < n; ++j) {
      const auto [c, d] = at(j);
      const Vec3 w = cross(a, d) + cross(c, b);
      for (int k = 0; k < 3; ++k) plus[k] &= w[k] > least, minus[k] &= w[k] < -least;
    }
    if (!(plus[0] | minus[0] | plus[1] | minus[1] | plus[2] | minus[2])) return true;
  }
  return false;
}
bool are_parallel(Vec3 a, Vec3 b, double most_a, double most_b, double nothing) {
  const Vec3 c = cross(a, b);
  return dot(c, c) <= nothing * nothing * (most_a * most_a) * (most_b * most_b);
}

// Places t in (0, 1) of an edge where the fields are parallel. Each component of their cross product is a quadratic polynomial, whose
// roots are tried; one may have a double root where another has a simple one, which is exact. Places beside a corner that is one itself
// do not count.
int solve_edge(const Corner& p, const Corner& q, double nothing, double out[2]) {
  const Vec3 c00 = cross(p.a, p.b), c0 = cross(p.a, q.b) + cross(q.a, p.b), c11 = cross(q.a, q.b);
  const double most_a = std::max(p.most_a, q.most_a), most_b = std::max(p.most_b, q.most_b), near = 1e3 * nothing;
  std::pair<double, double> tried[6];  // what is left of the cross product, place
  int count = 0;
  for (int k = 0; k < 3; ++k) {  // c00 (1-t)^2 + c0 t (1-t) + c11 t^2 = e t^2 + f t + g
    const double e = c00[k] - c0[k] + c11[k], f = c0[k] - 2 * c00[k], g = c00[k], most = std::max({std::abs(e), std::abs(f), std::abs(g)});
    const double d = f * f - 4 * e * g;
    if (!(most > 0) || d < -1e-12 * most * most) continue;
    const double h = -0.5 * (f + (f < 0 ? -1 : 1) * std::sqrt(std::max(d, 0.0)));
    for (const double t : {e != 0 ? h / e : -1, h != 0 ? g / h : -1}) {
      if (!(t >= (p.parallel ? near : 0) && t <= (q.parallel ? 1 - near : 1))) continue;
      const Vec3 a = p.a * (1 - t) + q.a * t, b = p.b * (1 - t) + q.b * t;
      if (are_parallel(a, b, most_a, most_b, nothing)) tried[count++] = {length(cross(a, b)), t};
    }
  }
  std::sort(tried, tried + count);
  int n = 0;
  for (int k = 0; k < count && n < 2; ++k)
    if (n == 0 || std::abs(tried[k].second - out[0]) > std::max(near, 1e-6)) out[n++] = tried[k].second;
  return n;
}

// All s >= 0 with sum 1 and A s parallel to B s. The ratio is infinite where B s = 0.
int solve_triangle(const Corner* c[3], Found out[3]) {
  const Mat3 a = columns(c[0]->a, c[1]->a, c[2]->a), b = columns(c[0]->b, c[1]->b, c[2]->b);
  const double la = largest(a), lb = largest(b);
  if (!(la > 0 && lb > 0)) return 0;
  const double da = std::abs(determinant(a)) / (la * la * la), db = std::abs(determinant(b)) / (lb * lb * lb);
  if (!(da >= 1e-12 || db >= 1e-12)) return 0;
  const bool by_b = db >= da;
  const Mat3 m = by_b ? inverse(b) * a : inverse(a) * b;
  const GeneralEigenvalues e = general_eigenvalues(m);
  int n = 0;
  for (int k = 0; k < (e.complex_pair ? 1 : 3); ++k) {
    if (!std::isfinite(e.real[k])) continue;
    if (k > 0 && e.real[k] == e.real[k - 1]) continue;
    Vec3 s = eigenvector_of(m, e.real[k]);
    const double sum = s.x + s.y + s.z;
    if (sum == 0) continue;
    s = s / sum;
    if (!(s.x >= 0 && s.y >= 0 && s.z >= 0)) continue;
    Found& f = out[n++];
    f.s[0] = s.x, f.s[1] = s.y, f.s[2] = s.z;
    f.at = c[0]->at * s.x + c[1]->at * s.y + c[2]->at * s.z;
    f.ratio = by_b ? e.real[k] : 1 / e.real[k];
  }
  return n;
}

// Is there a place in the tetrahedron where the fields have this angle? The null vector of a 3x4 matrix, by its minors.
bool inside_at(const Corner* c[4], double la, double lb, double angle) {
  Vec3 d[4];
  for (int k = 0; k < 4; ++k) d[k] = c[k]->a * (std::cos(angle) / la) - c[k]->b * (std::sin(angle) / lb);
  const double x[4] = {determinant(columns(d[1], d[2], d[3])), -determinant(columns(d[0], d[2], d[3])),
                       determinant(columns(d[0], d[1], d[3])), -determinant(columns(d[0], d[1], d[2]))};
  const bool plus = x[0] >= 0 && x[1] >= 0 && x[2] >= 0 && x[3] >= 0, minus = x[0] <= 0 && x[1] <= 0 && x[2] <= 0 && x[3] <= 0;
  return plus != minus;
}

// The corners of a face of the open cell: of curved cells without the nodes of its edges and inside.
std::span<const uint32_t> face_corners(CellReader& reader, size_t f) {
  const auto nodes = reader.face(f);
  if (!is_high_order(reader.type())) return nodes;
  return nodes.first(cell_faces(reader.type(), reader.ids().size(), reader.orders()).corners[f]);
}

// Corners come first in the nodes of a cell.
size_t corner_count(const CellReader& reader) {
  if (!is_high_order(reader.type())) return reader.ids().size();
  const CellType t = linear_type(reader.type());
  return t == CellType::tetra ? 4 : t == CellType::pyramid ? 5 : t == CellType::wedge ? 6 : 8;
}

// The solid cells in which the fields may be parallel. Of their points: the largest lengths of both fields in those cells around, and
// where the fields are parallel. Points of faces on which they are parallel everywhere (walls, where nothing moves) are none.
struct Around {
  std::vector<size_t> cells;
  bool solid = false;
  std::vector<double> most_a, most_b;
  std::vector<uint8_t> parallel;

  Around(const CellReader& proto, std::span<const Vec3> a, std::span<const Vec3> b, double nothing, Context& context)
      : most_a(a.size(), 0), most_b(a.size(), 0), parallel(a.size(), 0) {
    find_cells(proto, a, b, nothing, context);
    std::atomic<size_t> count{0};
    parallel_for(a.size(), 1 << 14, [&](size_t begin, size_t end) {
      size_t here = 0;
      for (size_t i = begin; i < end; ++i) {
        most_a[i] = std::sqrt(most_a[i]), most_b[i] = std::sqrt(most_b[i]);
        here += parallel[i] = most_a[i] > 0 && most_b[i] > 0 && are_parallel(a[i], b[i], most_a[i], most_b[i], nothing);
      }
      count += here;
    });
    if (count > 2) leave_out_areas(proto, a, b, nothing, context);
  }

 private:
  void find_cells(const CellReader& proto, std::span<const Vec3> a, std::span<const Vec3> b, double nothing, Context& context) {
    constexpr size_t grain = 1 << 12;
    std::vector<std::vector<size_t>> found((proto.count() + grain - 1) / grain);
    std::vector<uint8_t> some(found.size(), 0);
    parallel_for(
        proto.count(), grain,
        [&](size_t begin, size_t end) {
          CellReader reader(proto);
          for (size_t c = begin; c < end; ++c) {
            if (reader.hidden(c)) continue;
            reader.open(c);
            if (reader.dimension() != 3) continue;
            some[begin / grain] = 1;
            const auto ids = reader.ids().first(corner_count(reader));
            double la = 0, lb = 0;
            for (const int64_t id : ids) {
              la = std::fmax(la, dot(a[size_t(id)], a[size_t(id)]));
              lb = std::fmax(lb, dot(b[size_t(id)], b[size_t(id)]));
            }
            const auto at = [&](size_t i) { return std::pair<Vec3, Vec3>(a[size_t(ids[i])], b[size_t(ids[i])]); };
            if (!may_vanish(ids.size(), nothing * std::sqrt(la * lb), at)) continue;
            found[begin / grain].push_back(c);
            for (const int64_t id : ids) raise(most_a[size_t(id)], la), raise(most_b[size_t(id)], lb);
          }
        },
        &context);
    for (const auto& f : found) cells.insert(cells.end(), f.begin(), f.end());
    solid = std::find(some.begin(), some.end(), 1) != some.end();
  }
  static void raise(double& most, double to) {
    std::atomic_ref<double> m(most);
    double before = m.load(std::memory_order_relaxed);
    while (before < to && !m.compare_exchange_weak(before, to, std::memory_order_relaxed)) {
    }
  }
  void leave_out_areas(const CellReader& proto, std::span<const Vec3> a, std::span<const Vec3> b, double nothing, Context& context) {
    std::vector<uint8_t> area(parallel.size(), 0);
    CellReader reader(proto);
    for (const size_t c : cells) {
      context.check();
      reader.open(c);
      const auto ids = reader.ids();
      if (std::count_if(ids.begin(), ids.end(), [&](int64_t id) { return parallel[size_t(id)] != 0; }) < 3) continue;
      for (size_t f = 0; f < reader.face_count(); ++f) {
        const auto face = face_corners(reader, f);
        Vec3 u, w;
        double la = 0, lb = 0;
        bool all = true;
        for (const uint32_t k : face) {
          const auto i = size_t(ids[k]);
          u += a[i], w += b[i], la += most_a[i], lb += most_b[i], all &= parallel[i] != 0;
        }
        if (!all || !are_parallel(u, w, la, lb, nothing)) continue;
        for (const uint32_t k : face) area[size_t(ids[k])] = 1;
      }
    }
    for (size_t i = 0; i < area.size(); ++i) parallel[i] &= uint8_t(!area[i]);
  }
};

constexpr int most_points = 28;  // corners, two on each edge, three on each face

// The points of the lines on the border of a tetrahedron, each once.
struct TetraPoints {
  const Corner (&c)[4];
  double nothing;
  Found here[most_points];
  int n = 0;
  Vec3 product[4][4];    // of the corners' fields, both ways
  bool line[4][4] = {};  // edges on which the fields are parallel all along

  TetraPoints(const Corner (&corners)[4], double least) : c(corners), nothing(least) {
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) product[i][j] = cross(c[i].a, c[j].b) + cross(c[j].a, c[i].b);
  }
  // See may_vanish(): between these corners, in bits.
  bool may_hold(unsigned corners) const {
    double la = 0, lb = 0;
    for (int i = 0; i < 4; ++i)
      if (corners >> i & 1) la = std::max(la, c[i].most_a), lb = std::max(lb, c[i].most_b);
    const double least = nothing * la * lb;
    bool plus[3] = {true, true, true}, minus[3] = {true, true, true};
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) {
        if (~corners & (1u << i | 1u << j)) continue;
        const Vec3 w = product[i][j];
        for (int k = 0; k < 3; ++k) plus[k] &= w[k] > least, minus[k] &= w[k] < -least;
      }
    return !(plus[0] | minus[0] | plus[1] | minus[1] | plus[2] | minus[2]);
  }

  void add(unsigned corners, const double* x, int place) {
    Found& f = here[n++];
    f.corners = corners;
    f.key = {{-1, -1, -1}, place};
    f.at = {};
    Vec3 a, b;
    int m = 0;
    for (int k = 0; k < 4; ++k) {
      f.x[k] = corners >> k & 1 ? x[k] : 0;
      if (!(corners >> k & 1)) continue;
      f.key.corners[size_t(m)] = c[k].id, f.s[m++] = x[k];
      f.at += c[k].at * x[k], a += c[k].a * x[k], b += c[k].b * x[k];
    }
    f.ratio = dot(a, b) / dot(b, b);
    if (!std::isfinite(f.ratio)) f.ratio = HUGE_VAL;
  }

  void solve() {
    for (int i = 0; i < 4; ++i) {
      double x[4] = {};
      x[i] = 1;
      if (c[i].parallel) add(1u << i, x, 0);
    }
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) solve_on_edge(i, j);
    for (int skip = 0; skip < 4; ++skip) solve_on_face(skip);
  }
  void solve_on_edge(int i, int j) {
    if (c[i].parallel && c[j].parallel) {
      line[i][j] = are_parallel(c[i].a + c[j].a, c[i].b + c[j].b, 2 * std::max(c[i].most_a, c[j].most_a),
                                2 * std::max(c[i].most_b, c[j].most_b), nothing);
      if (line[i][j]) return;
    }
    if (!may_hold(1u << i | 1u << j)) return;
    double t[2];
    const int places = solve_edge(c[i], c[j], nothing, t);
    for (int k = 0; k < places; ++k) {
      double x[4] = {};
      x[i] = 1 - t[k], x[j] = t[k];
      add(1u << i | 1u << j, x, k);
    }
  }
  // Inside of the face: not beside points on its edges, and not where a line lies in it, of which those are the ends.
  void solve_on_face(int skip) {
    int t[3];
    for (int k = 0, m = 0; k < 4; ++k)
      if (k != skip) t[m++] = k;
    const unsigned face = 15u & ~(1u << skip);
    if (line[t[0]][t[1]] || line[t[0]][t[2]] || line[t[1]][t[2]] || !may_hold(face)) return;
    const int before = n;
    for (int i = 0; i < before; ++i)
      for (int j = i + 1; j < before; ++j)
        if (!((here[i].corners | here[j].corners) & ~face) && straight(i, j)) return;
    const Corner* corners[3] = {&c[t[0]], &c[t[1]], &c[t[2]]};
    Found solved[3];
    const int more = solve_triangle(corners, solved);
    for (int k = 0; k < more; ++k) {
      double x[4] = {};
      for (int m = 0; m < 3; ++m) x[t[m]] = solved[k].s[m];
      bool beside = false;
      for (int i = 0; i < before && !beside; ++i) {
        double off = here[i].corners & ~face ? 1 : 0;
        for (int m = 0; m < 4; ++m) off = std::max(off, std::abs(here[i].x[m] - x[m]));
        beside = off <= 1e3 * nothing;
      }
      if (beside) continue;
      add(face, x, k);
      here[n - 1].ratio = solved[k].ratio, here[n - 1].at = solved[k].at;
    }
  }

  // Are the fields parallel half way between two points, and no third point there?
  bool straight(int i, int j) const {
    Vec3 a, b;
    double most_a = 0, most_b = 0, along = 0;
    for (int k = 0; k < 4; ++k) {
      const double x = 0.5 * (here[i].x[k] + here[j].x[k]);
      a += c[k].a * x, b += c[k].b * x;
      along += (here[j].x[k] - here[i].x[k]) * (here[j].x[k] - here[i].x[k]);
      if (((here[i].corners | here[j].corners) >> k) & 1) most_a = std::max(most_a, c[k].most_a), most_b = std::max(most_b, c[k].most_b);
    }
    if (!are_parallel(a, b, most_a, most_b, nothing)) return false;
    for (int m = 0; m < n; ++m) {
      if (m == i || m == j) continue;
      double t = 0, off = 0;
      for (int k = 0; k < 4; ++k) t += (here[m].x[k] - here[i].x[k]) * (here[j].x[k] - here[i].x[k]) / along;
      for (int k = 0; k < 4; ++k) off = std::max(off, std::abs(here[i].x[k] + t * (here[j].x[k] - here[i].x[k]) - here[m].x[k]));
      if (t > 0 && t < 1 && off <= 1e3 * nothing) return false;
    }
    return true;
  }
  // Both on the border of one face: a line between them may as well belong to the tetrahedron on its other side.
  bool on_one_face(int i, int j) const {
    const unsigned both = here[i].corners | here[j].corners;
    return both != 15u && here[i].corners != here[j].corners;
  }
  // False where one field vanishes and the other too: their angle is any.
  bool has_angle(int i) const {
    Vec3 a, b;
    double most_a = 0, most_b = 0;
    for (int k = 0; k < 4; ++k) {
      a += c[k].a * here[i].x[k], b += c[k].b * here[i].x[k];
      most_a = std::max(most_a, c[k].most_a), most_b = std::max(most_b, c[k].most_b);
    }
    return length(a) > nothing * most_a || length(b) > nothing * most_b;
  }
};

struct Work {
  double nothing = 0;  // what counts as parallel: |a x b| of the product of the largest around
  std::vector<Found> found;
  std::vector<Segment> segments;
  std::vector<Corner> corners, ring;

  void tetra(const Corner& p, const Corner& q, const Corner& r, const Corner& s, int64_t cell) {
    const Corner* c[4] = {&p, &q, &r, &s};
    std::sort(c, c + 4, [](const Corner* l, const Corner* m) { return l->id < m->id; });
    const Corner all[4] = {*c[0], *c[1], *c[2], *c[3]};
    for (const Corner& k : all)
      if (!std::isfinite(dot(k.a, k.b))) return;
    TetraPoints t(all, nothing);
    if (!t.may_hold(15)) return;
    t.solve();
    if (t.n < 2) return;
    double la = 0, lb = 0;
    for (const Corner& k : all) la = std::max(la, length(k.a)), lb = std::max(lb, length(k.b));
    for (int k = 0; k < t.n; ++k) t.here[k].angle = std::atan(t.here[k].ratio * lb / la), t.here[k].cell = cell;
    Found* const here = t.here;
    const int n = t.n;
    std::sort(here, here + n, [](const Found& l, const Found& m) { return l.angle != m.angle ? l.angle < m.angle : l.key < m.key; });
    bool used[most_points] = {}, joined[most_points][most_points] = {};
    const auto join = [&](int i, int j) {
      if (joined[i][j]) return;
      joined[i][j] = joined[j][i] = true;
      const bool turn = here[j].key < here[i].key;
      segments.push_back({here[turn ? j : i].key, here[turn ? i : j].key, cell});
      used[i] = used[j] = true;
    };
    const auto between = [&](int i, int j, double angle) { return t.has_angle(i) && t.has_angle(j) && inside_at(c, la, lb, angle); };
    if (n == 2 && !t.on_one_face(0, 1)) {
      join(0, 1);  // in and out; the angle may well be the same all along
    } else {
      for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j)
          if (t.straight(i, j)) join(i, j);
      for (int i = 0; i + 1 < n; ++i)
        if (between(i, i + 1, (here[i].angle + here[i + 1].angle) / 2)) join(i, i + 1);
      if (n > 2 && between(n - 1, 0, (here[n - 1].angle + here[0].angle + pi) / 2)) join(n - 1, 0);
    }
    for (int i = 0; i < n; ++i)
      if (used[i]) found.push_back(here[i]);
  }

  void cell(CellReader& reader, std::span<const Vec3> a, std::span<const Vec3> b, const Around& around, int64_t points) {
    const auto ids = reader.ids();
    const auto at = reader.at();
    const auto corner = [&](uint32_t k) {
      const auto i = size_t(ids[k]);
      return Corner{ids[k], at[k], a[i], b[i], around.most_a[i], around.most_b[i], around.parallel[i] != 0};
    };
    const size_t faces = reader.face_count();
    corners.clear();
    if (linear_type(reader.type()) == CellType::tetra) {
      for (uint32_t k = 0; k < 4; ++k) corners.push_back(corner(k));
      tetra(corners[0], corners[1], corners[2], corners[3], int64_t(reader.cell()));
      return;
    }
    const size_t used = corner_count(reader);
    Corner middle{points + int64_t(reader.cell()), {}, {}, {}, 0, 0, false};
    for (uint32_t k = 0; k < used; ++k) {
      corners.push_back(corner(k));
      middle.at += at[k], middle.a += corners.back().a, middle.b += corners.back().b;
    }
    middle.at = middle.at / double(used), middle.a = middle.a / double(used), middle.b = middle.b / double(used);
    for (const Corner& k : corners) middle.most_a = std::max(middle.most_a, k.most_a), middle.most_b = std::max(middle.most_b, k.most_b);
    middle.parallel = are_parallel(middle.a, middle.b, middle.most_a, middle.most_b, nothing);
    for (size_t f = 0; f < faces; ++f) {
      ring.clear();
      for (const uint32_t k : face_corners(reader, f)) ring.push_back(corner(k));
      if (ring.size() < 3) continue;
      std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), [](const Corner& l, const Corner& m) { return l.id < m.id; }),
                  ring.end());
      for (size_t k = 1; k + 1 < ring.size(); ++k) tetra(ring[0], ring[k], ring[k + 1], middle, int64_t(reader.cell()));
    }
  }
};

}  // namespace

Data each_flow_mesh(const std::vector<DatasetPtr>& meshes, const std::function<DatasetPtr(const DatasetPtr&)>& f, Context& context) {
  if (meshes.size() == 1) return f(meshes.front());
  std::vector<Data> lines;
  for (const DatasetPtr& d : meshes) lines.push_back(f(d));
  return append(lines, {}, context);
}

std::vector<Vec3> point_vectors(const DatasetPtr& in, const Field& given, Context& context) {
  Field field = given;
  if (field.association == Association::cell)
    field = cell_to_point(in, {{field.name}}, context)->fields().require(field.name, Association::point);
  std::vector<Vec3> out(field.array.count());
  dispatch(field.array, [&](const auto& v) {
    parallel_for(out.size(), 1 << 14, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        out[i] = {double(v(i, 0)), v.components > 1 ? double(v(i, 1)) : 0.0, v.components > 2 ? double(v(i, 2)) : 0.0};
    });
  });
  return out;
}

ParallelLines parallel_lines(const DatasetPtr& data, std::span<const Vec3> a, std::span<const Vec3> b, Context& context, double nothing) {
  const CellReader proto(data);
  const Around around(proto, a, b, nothing, context);
  if (!around.solid)
    fail_usage("lines where two vector fields are parallel need cells with a volume", "parallel_vectors",
               "in a plane the counterpart is a point: critical_points");
  constexpr size_t grain = 1 << 10;
  std::vector<Work> parts((around.cells.size() + grain - 1) / grain);
  const auto points = int64_t(data->point_count());
  parallel_for(
      around.cells.size(), grain,
      [&](size_t begin, size_t end) {
        CellReader reader(proto);
        Work& work = parts[begin / grain];
        work.nothing = nothing;
        for (size_t k = begin; k < end; ++k) {
          reader.open(around.cells[k]);
          work.cell(reader, a, b, around, points);
        }
      },
      &context);

  // Each point once: those of shared faces were found by both cells, in the same bits.
  std::vector<Found> all;
  for (Work& w : parts) all.insert(all.end(), w.found.begin(), w.found.end());
  std::stable_sort(all.begin(), all.end(), [](const Found& l, const Found& r) { return l.key < r.key; });
  all.erase(std::unique(all.begin(), all.end(), [](const Found& l, const Found& r) { return l.key == r.key; }), all.end());
  ParallelLines out;
  CellReader reader(proto);
  for (const Found& f : all) {
    ParallelPoint p{f.at, uint32_t(out.ids.size()), 0, f.cell, f.ratio};
    for (int k = 0; k < 3; ++k) {
      const int64_t id = f.key.corners[size_t(k)];
      if (id < 0) break;
      if (id < points) {
        out.ids.push_back(id), out.weights.push_back(f.s[k]);
        continue;
      }
      reader.open(size_t(id - points));
      const auto middle = reader.ids().first(corner_count(reader));
      for (const int64_t m : middle) out.ids.push_back(m), out.weights.push_back(f.s[k] / double(middle.size()));
    }
    p.count = uint32_t(out.ids.size()) - p.first;
    out.points.push_back(p);
  }
  const auto number = [&](const Key& key) {
    return uint32_t(std::lower_bound(all.begin(), all.end(), key, [](const Found& l, const Key& r) { return l.key < r; }) - all.begin());
  };
  // Those in a face or along an edge were found by all tetrahedra there; the first counts.
  std::vector<std::array<uint32_t, 2>> ends;
  std::vector<int64_t> cells;
  for (const Work& w : parts)
    for (const Segment& s : w.segments) ends.push_back({number(s.from), number(s.to)}), cells.push_back(s.cell);
  std::vector<uint32_t> order(ends.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t l, uint32_t r) { return std::pair(ends[l], l) < std::pair(ends[r], r); });
  order.erase(std::unique(order.begin(), order.end(), [&](uint32_t l, uint32_t r) { return ends[l] == ends[r]; }), order.end());
  std::sort(order.begin(), order.end());
  for (const uint32_t k : order) {
    out.segments.insert(out.segments.end(), ends[k].begin(), ends[k].end());
    out.cells.push_back(cells[k]);
  }
  return out;
}

DatasetPtr parallel_lines_mesh(const DatasetPtr& data, const ParallelLines& lines, Context& context, std::vector<PointNumbers> more) {
  FieldSampler sampler(*data, lines.points.size());
  SampleBlock block;
  for (size_t i = 0; i < lines.points.size(); ++i) {
    const ParallelPoint& p = lines.points[i];
    block.add(i, p.cell, std::span(lines.ids).subspan(p.first, p.count), std::span(lines.weights).subspan(p.first, p.count));
    if (block.full()) sampler.write(block), block.count = 0;
  }
  sampler.write(block);
  DatasetParts parts;
  parts.fields = sampler.take();
  parts.fields.remove("valid", Association::point);
  SurfaceMesh mesh;
  mesh.points.origin = data->bounds().center();
  std::vector<double> xyz, ratio;
  for (const ParallelPoint& p : lines.points) {
    const Vec3 x = p.at - mesh.points.origin;
    xyz.insert(xyz.end(), {x.x, x.y, x.z});
    ratio.push_back(p.ratio);
  }
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.fixed = 2;
  mesh.lines.connectivity = Array::from_vector(std::vector<int32_t>(lines.segments.begin(), lines.segments.end()));
  parts.fields.add({"parallel ratio", Association::point, Array::from_vector(std::move(ratio)), "", Role::none});
  for (PointNumbers& m : more)
    parts.fields.add({std::move(m.name), Association::point, Array::from_vector(std::move(m.values)), "", Role::none});
  parts.mesh = std::move(mesh), parts.notes = data->notes(), parts.time = data->time();
  const bool none = lines.segments.empty();
  const DatasetPtr segments = make_dataset(std::move(parts));
  return none ? segments : polylines(segments, {}, context);
}

namespace {

DatasetPtr of_mesh(const DatasetPtr& in, const ParallelVectorsParams& p, Context& context) {
  if (p.b.empty())
    fail_usage("there is no second vector field", "parallel_vectors", "b=FIELD names it; a=FIELD the first (default: the active vectors)");
  const Field first = flow_field_of(*in, p.a.name, "parallel_vectors"), second = flow_field_of(*in, p.b.name, "parallel_vectors");
  const std::vector<Vec3> a = point_vectors(in, first, context), b = point_vectors(in, second, context);
  const double nothing = std::max(parallel_within(first.array.type()), parallel_within(second.array.type()));
  return parallel_lines_mesh(in, parallel_lines(in, a, b, context, nothing), context);
}

}  // namespace

Data parallel_vectors(const Data& in, const ParallelVectorsParams& p, Context& context) {
  std::string field = p.a.name;
  return each_flow_mesh(
      flow_meshes(in, field, "parallel_vectors"), [&](const DatasetPtr& d) { return of_mesh(d, p, context); }, context);
}

}  // namespace sg
