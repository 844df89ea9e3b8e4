// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/parallel_vectors.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "data/cell_reader.h"
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
};

struct Key {
  std::array<int64_t, 3> triangle;
  int place;  // which of up to three solutions
  friend auto operator<=>(const Key&, const Key&) = default;
};

struct Found {
  Key key;
  Vec3 at;
  double s[3];          // barycentric, in the order of the key
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
// coordinates: no, when all coefficients of one have the same sign.
bool may_vanish(std::span<const Corner> c) {
  bool plus[3] = {true, true, true}, minus[3] = {true, true, true};
  for (size_t i = 0; i < c.size(); ++i)
    for (size_t j = i; j < c.size(); ++j) {
      const Vec3 w = cross(c[i].a, c[j].b) + cross(c[j].a, c[i].b);
      for (int k = 0; k < 3; ++k) plus[k] &= w[k] > 0, minus[k] &= w[k] < 0;
    }
  return !(plus[0] | minus[0] | plus[1] | minus[1] | plus[2] | minus[2]);
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

struct Work {
  std::vector<Found> found;
  std::vector<Segment> segments;
  std::vector<Corner> corners, ring;

  void tetra(const Corner& p, const Corner& q, const Corner& r, const Corner& s, int64_t cell) {
    const Corner* c[4] = {&p, &q, &r, &s};
    std::sort(c, c + 4, [](const Corner* l, const Corner* m) { return l->id < m->id; });
    const Corner all[4] = {*c[0], *c[1], *c[2], *c[3]};
    for (const Corner& k : all)
      if (!std::isfinite(dot(k.a, k.b))) return;
    if (!may_vanish(all)) return;
    Found here[12];
    int n = 0;
    for (int skip = 0; skip < 4; ++skip) {
      const Corner* t[3];
      for (int k = 0, m = 0; k < 4; ++k)
        if (k != skip) t[m++] = c[k];
      const Corner three[3] = {*t[0], *t[1], *t[2]};
      if (!may_vanish(three)) continue;
      const int more = solve_triangle(t, here + n);
      for (int k = 0; k < more; ++k) here[n + k].key = {{t[0]->id, t[1]->id, t[2]->id}, k}, here[n + k].cell = cell;
      n += more;
    }
    if (n < 2) return;
    double la = 0, lb = 0;
    for (const Corner& k : all) la = std::max(la, length(k.a)), lb = std::max(lb, length(k.b));
    for (int k = 0; k < n; ++k) here[k].angle = std::atan(here[k].ratio * lb / la);
    std::sort(here, here + n, [](const Found& l, const Found& m) { return l.angle != m.angle ? l.angle < m.angle : l.key < m.key; });
    bool used[12] = {};
    const auto join = [&](int i, int j) {
      segments.push_back({here[i].key, here[j].key, cell});
      used[i] = used[j] = true;
    };
    if (n == 2) {
      join(0, 1);  // in and out; the angle may well be the same all along
    } else {
      for (int i = 0; i + 1 < n; ++i)
        if (inside_at(c, la, lb, (here[i].angle + here[i + 1].angle) / 2)) join(i, i + 1);
      if (inside_at(c, la, lb, (here[n - 1].angle + here[0].angle + pi) / 2)) join(n - 1, 0);
    }
    for (int i = 0; i < n; ++i)
      if (used[i]) found.push_back(here[i]);
  }

  void cell(CellReader& reader, std::span<const Vec3> a, std::span<const Vec3> b, int64_t points) {
    const auto ids = reader.ids();
    const auto at = reader.at();
    const auto corner = [&](uint32_t k) { return Corner{ids[k], at[k], a[size_t(ids[k])], b[size_t(ids[k])]}; };
    const size_t faces = reader.face_count();
    corners.clear();
    if (linear_type(reader.type()) == CellType::tetra) {
      for (uint32_t k = 0; k < 4; ++k) corners.push_back(corner(k));
      tetra(corners[0], corners[1], corners[2], corners[3], int64_t(reader.cell()));
      return;
    }
    uint32_t used = 0;
    std::vector<uint8_t> seen(ids.size(), 0);
    Corner middle{points + int64_t(reader.cell()), {}, {}, {}};
    for (size_t f = 0; f < faces; ++f)
      for (const uint32_t k : reader.face(f))
        if (!seen[k])
          seen[k] = 1, corners.push_back(corner(k)), middle.at += corners.back().at, middle.a += corners.back().a,
          middle.b += corners.back().b, ++used;
    if (used == 0 || !may_vanish(corners)) return;
    middle.at = middle.at / double(used), middle.a = middle.a / double(used), middle.b = middle.b / double(used);
    for (size_t f = 0; f < faces; ++f) {
      ring.clear();
      for (const uint32_t k : reader.face(f)) ring.push_back(corner(k));
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

ParallelLines parallel_lines(const DatasetPtr& data, std::span<const Vec3> a, std::span<const Vec3> b, Context& context) {
  const CellReader proto(data);
  constexpr size_t grain = 1 << 12;
  std::vector<Work> parts((proto.count() + grain - 1) / grain);
  std::vector<uint8_t> solid(parts.size(), 0);
  const auto points = int64_t(data->point_count());
  parallel_for(
      proto.count(), grain,
      [&](size_t begin, size_t end) {
        CellReader reader(proto);
        Work& work = parts[begin / grain];
        for (size_t c = begin; c < end; ++c) {
          if (reader.hidden(c)) continue;
          reader.open(c);
          if (reader.dimension() != 3) continue;
          solid[begin / grain] = 1;
          work.cell(reader, a, b, points);
        }
      },
      &context);
  if (std::none_of(solid.begin(), solid.end(), [](uint8_t s) { return s; }))
    fail_usage("lines where two vector fields are parallel need cells with a volume", "parallel_vectors",
               "in a plane the counterpart is a point: critical_points");

  // Each point once: those of shared faces were found by both cells, in the same bits.
  std::vector<Found> all;
  for (Work& w : parts) all.insert(all.end(), w.found.begin(), w.found.end());
  std::stable_sort(all.begin(), all.end(), [](const Found& l, const Found& r) { return l.key < r.key; });
  all.erase(std::unique(all.begin(), all.end(), [](const Found& l, const Found& r) { return l.key == r.key; }), all.end());
  ParallelLines out;
  CellReader reader(proto);
  std::vector<int64_t> middle;
  for (const Found& f : all) {
    ParallelPoint p{f.at, uint32_t(out.ids.size()), 0, f.cell, f.ratio};
    for (int k = 0; k < 3; ++k) {
      const int64_t id = f.key.triangle[size_t(k)];
      if (id < points) {
        out.ids.push_back(id), out.weights.push_back(f.s[k]);
        continue;
      }
      reader.open(size_t(id - points));
      middle.clear();
      for (size_t face = 0; face < reader.face_count(); ++face)
        for (const uint32_t n : reader.face(face))
          if (std::find(middle.begin(), middle.end(), reader.ids()[n]) == middle.end()) middle.push_back(reader.ids()[n]);
      for (const int64_t m : middle) out.ids.push_back(m), out.weights.push_back(f.s[k] / double(middle.size()));
    }
    p.count = uint32_t(out.ids.size()) - p.first;
    out.points.push_back(p);
  }
  const auto number = [&](const Key& key) {
    return uint32_t(std::lower_bound(all.begin(), all.end(), key, [](const Found& l, const Key& r) { return l.key < r; }) - all.begin());
  };
  for (const Work& w : parts)
    for (const Segment& s : w.segments) {
      out.segments.push_back(number(s.from)), out.segments.push_back(number(s.to));
      out.cells.push_back(s.cell);
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
  const std::vector<Vec3> a = point_vectors(in, flow_field_of(*in, p.a.name, "parallel_vectors"), context);
  const std::vector<Vec3> b = point_vectors(in, flow_field_of(*in, p.b.name, "parallel_vectors"), context);
  return parallel_lines_mesh(in, parallel_lines(in, a, b, context), context);
}

}  // namespace

Data parallel_vectors(const Data& in, const ParallelVectorsParams& p, Context& context) {
  std::string field = p.a.name;
  return each_flow_mesh(
      flow_meshes(in, field, "parallel_vectors"), [&](const DatasetPtr& d) { return of_mesh(d, p, context); }, context);
}

}  // namespace sg
