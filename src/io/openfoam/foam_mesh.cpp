// SPDX-License-Identifier: Apache-2.0
#include "io/openfoam/foam_mesh.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "io/openfoam/foam_file.h"

namespace sg::openfoam {

namespace {

void read_boundary(const std::string& path, FoamMesh& m) {
  FoamFile f(path);
  const size_t n = f.count("the number of patches");
  f.expect("(", "the patches");
  for (size_t i = 0; i < n; ++i) {
    Patch p;
    p.name = f.next();
    f.expect("{", fmt::format("patch '{}'", p.name));
    for (;;) {
      const std::string key(f.next());
      if (key == "}") break;
      if (key.empty()) f.fail("ends within a patch");
      if (key == "type") p.type = f.next(), f.expect(";", "an entry");
      else if (key == "nFaces") p.count = f.count("the number of faces"), f.expect(";", "an entry");
      else if (key == "startFace") p.start = f.count("the first face"), f.expect(";", "an entry");
      else if (key == "inGroups" && f.peek() != "(" && f.peek() != ";") {
        if (f.peek() == "List<word>") f.next();
        if (f.peek() != "(") f.count("the number of groups");
        f.expect("(", "the groups");
        for (std::string_view w = f.next(); w != ")"; w = f.next()) {
          if (w.empty()) f.fail("ends within the groups of a patch");
          p.groups.emplace_back(w);
        }
        f.expect(";", "an entry");
      } else if (key[0] == '#') f.skip_directive();
      else f.skip_entry();
    }
    if (p.start > m.faces() || p.count > m.faces() - p.start)
      f.fail(fmt::format("patch '{}' has the faces {} to {}, but there are {}", p.name, p.start, p.start + p.count, m.faces()));
    if (p.count > 0 && p.start < m.neighbour.size()) f.fail(fmt::format("patch '{}' begins among the internal faces", p.name));
    m.patches.push_back(std::move(p));
  }
  f.expect(")", "the patches");
}

void read_zones(const std::string& path, FoamMesh& m) {
  FoamFile f(path);
  const size_t n = f.count("the number of zones");
  if (n == 0) return;
  f.expect("(", "the zones");
  for (size_t i = 0; i < n; ++i) {
    Zone z;
    z.name = f.next();
    f.expect("{", fmt::format("zone '{}'", z.name));
    for (;;) {
      const std::string key(f.next());
      if (key == "}") break;
      if (key.empty()) f.fail("ends within a zone");
      if (key == "cellLabels") {
        if (f.peek() == "List<label>") f.next();
        z.cells = f.labels("the cells of a zone");
        f.expect(";", "an entry");
      } else {
        f.skip_entry();
      }
    }
    for (const int32_t c : z.cells)
      if (c < 0 || size_t(c) >= m.cells) f.fail(fmt::format("zone '{}' has the cell {}, but there are {}", z.name, c, m.cells));
    m.zones.push_back(std::move(z));
  }
}

void check_mesh(const FoamMesh& m, const std::string& faces, const std::string& owner) {
  const size_t points = m.points.count();
  for (const int32_t p : m.face_ids)
    if (p < 0 || size_t(p) >= points) fail_data(fmt::format("a face has the point {}, but there are {}", p, points), faces);
  if (m.face_begin.size() != m.owner.size() + 1)
    fail_data(fmt::format("{} owners for {} faces", m.owner.size(), m.face_begin.size() - 1), owner);
  if (m.neighbour.size() > m.owner.size()) fail_data(fmt::format("{} neighbours for {} faces", m.neighbour.size(), m.owner.size()), owner);
}

/// The faces around each cell, by number; those that it does not own are ~number.
struct CellFaces {
  std::vector<size_t> begin;
  std::vector<int64_t> face;
};

CellFaces faces_of_cells(const FoamMesh& m) {
  CellFaces r;
  r.begin.assign(m.cells + 1, 0);
  for (const int32_t c : m.owner) ++r.begin[size_t(c)];
  for (const int32_t c : m.neighbour) ++r.begin[size_t(c)];
  r.face.resize(exclusive_scan(r.begin));
  std::vector<size_t> at = r.begin;
  for (size_t f = 0; f < m.faces(); ++f) {
    r.face[at[size_t(m.owner[f])]++] = int64_t(f);
    if (f < m.neighbour.size()) r.face[at[size_t(m.neighbour[f])]++] = ~int64_t(f);
  }
  return r;
}

/// One cell as its faces, and what it is. Not thread-safe: one per thread.
class CellShaper {
 public:
  CellShaper(const FoamMesh& m, const CellFaces& faces) : m_(m), faces_(faces) {}

  CellType open(size_t cell) {
    begin_ = faces_.begin[cell], count_ = faces_.begin[cell + 1] - begin_;
    size_t triangles = 0, quads = 0;
    for (size_t k = 0; k < count_; ++k) {
      const size_t n = points(k).size();
      triangles += size_t(n == 3), quads += size_t(n == 4);
    }
    type = CellType::polyhedron;
    if (quads == 6 && count_ == 6) prism(CellType::hexahedron, 4);
    else if (triangles == 2 && quads == 3 && count_ == 5) prism(CellType::wedge, 3);
    else if (triangles == 4 && quads == 1 && count_ == 5) cone(CellType::pyramid, 4);
    else if (triangles == 4 && count_ == 4) cone(CellType::tetra, 3);
    if (type == CellType::polyhedron) {
      ids.clear();
      for (size_t k = 0; k < count_; ++k) ids.insert(ids.end(), points(k).begin(), points(k).end());
      std::sort(ids.begin(), ids.end());
      ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    }
    return type;
  }

  size_t face_count() const { return count_; }
  std::span<const int32_t> points(size_t k) const {
    const int64_t f = faces_.face[begin_ + k];
    return m_.face(size_t(f < 0 ? ~f : f));
  }
  /// Whether the face is listed counter-clockwise as seen from outside.
  bool outward(size_t k) const { return faces_.face[begin_ + k] >= 0; }

  CellType type = CellType::polyhedron;
  std::vector<int32_t> ids;

 private:
  // The first face of n points becomes the base, counter-clockwise as seen from within.
  size_t take_base(size_t n) {
    size_t base = 0;
    while (points(base).size() != n) ++base;
    const auto p = points(base);
    ids.assign(p.begin(), p.end());
    if (outward(base)) std::reverse(ids.begin(), ids.end());
    return base;
  }
  bool in_base(int32_t p, size_t n) const { return std::find(ids.begin(), ids.begin() + ptrdiff_t(n), p) != ids.begin() + ptrdiff_t(n); }

  // The one point that edges of the other faces lead to from p, away from the base; -1 when there is none or several.
  int32_t above(int32_t p, size_t base, size_t n) const {
    int32_t found = -1;
    for (size_t k = 0; k < count_; ++k) {
      if (k == base) continue;
      const auto q = points(k);
      for (size_t i = 0; i < q.size(); ++i) {
        if (q[i] != p) continue;
        for (const int32_t next : {q[(i + 1) % q.size()], q[(i + q.size() - 1) % q.size()]}) {
          if (in_base(next, n)) continue;
          if (found >= 0 && found != next) return -1;
          found = next;
        }
      }
    }
    return found;
  }

  bool distinct() const {
    std::array<int32_t, 8> s{};
    std::copy(ids.begin(), ids.end(), s.begin());
    std::sort(s.begin(), s.begin() + ptrdiff_t(ids.size()));
    return std::adjacent_find(s.begin(), s.begin() + ptrdiff_t(ids.size())) == s.begin() + ptrdiff_t(ids.size());
  }
  // Some face has just the points ids[from..], in that order around it, either way.
  bool has_face(size_t base, size_t n) const {
    for (size_t k = 0; k < count_; ++k) {
      const auto q = points(k);
      if (k == base || q.size() != n) continue;
      const auto first = std::find(q.begin(), q.end(), ids[n]);
      if (first == q.end()) continue;
      const auto at = size_t(first - q.begin());
      bool up = true, down = true;
      for (size_t i = 0; i < n; ++i) {
        up = up && q[(at + i) % n] == ids[n + i];
        down = down && q[(at + n - i) % n] == ids[n + i];
      }
      if (up || down) return true;
    }
    return false;
  }

  void prism(CellType t, size_t n) {
    const size_t base = take_base(n);
    for (size_t i = 0; i < n; ++i) {
      const int32_t p = above(ids[i], base, n);
      if (p < 0) return;
      ids.push_back(p);
    }
    if (distinct() && has_face(base, n)) type = t;
  }

  void cone(CellType t, size_t n) {
    const size_t base = take_base(n);
    const int32_t apex = above(ids[0], base, n);
    if (apex < 0) return;
    for (size_t k = 0; k < count_; ++k)
      for (const int32_t p : points(k))
        if (p != apex && !in_base(p, n)) return;
    ids.push_back(apex);
    if (distinct()) type = t;
  }

  const FoamMesh& m_;
  const CellFaces& faces_;
  size_t begin_ = 0, count_ = 0;
};

}  // namespace

FoamMesh read_mesh(const std::function<std::string(const std::string&)>& find) {
  FoamMesh m;
  auto need = [&](const char* name) {
    std::string path = find(name);
    if (path.empty())
      fail_data(fmt::format("the mesh lacks the file '{}'", name), {}, "a polyMesh needs points, faces, owner, neighbour and boundary");
    return path;
  };
  const std::string faces = need("faces"), owner = need("owner");
  {
    FoamFile f(need("points"));
    m.points.xyz = f.tuples(3, "points");
  }
  FoamFile(faces).faces(m.face_begin, m.face_ids);
  m.owner = FoamFile(owner).labels("owners");
  if (const std::string path = find("neighbour"); !path.empty()) m.neighbour = FoamFile(path).labels("neighbours");
  // Old meshes write -1 for the boundary faces.
  while (!m.neighbour.empty() && m.neighbour.back() == -1) m.neighbour.pop_back();
  int64_t most = -1;
  for (const auto* list : {&m.owner, &m.neighbour})
    for (const int32_t c : *list) {
      if (c < 0) fail_data(fmt::format("a face belongs to cell {}", c), owner);
      most = std::max<int64_t>(most, c);
    }
  m.cells = size_t(most + 1);
  // Every cell has faces, so more cells than faces have sides are a wrong number.
  if (m.cells > m.owner.size() + m.neighbour.size())
    fail_data(fmt::format("a face belongs to cell {}, but {} faces cannot bound that many cells", most, m.owner.size()), owner);
  check_mesh(m, faces, owner);
  if (const std::string path = find("boundary"); !path.empty()) read_boundary(path, m);
  if (const std::string path = find("cellZones"); !path.empty()) read_zones(path, m);
  return m;
}

UnstructuredMesh make_cells(const FoamMesh& m, Context& context) {
  const CellFaces faces = faces_of_cells(m);
  constexpr size_t grain = 4096;
  std::vector<uint8_t> types(m.cells);
  std::vector<size_t> ids(m.cells + 1), cell_faces(m.cells + 1), face_ids(m.cells + 1);
  parallel_for(
      m.cells, grain,
      [&](size_t begin, size_t end) {
        CellShaper s(m, faces);
        for (size_t c = begin; c < end; ++c) {
          types[c] = uint8_t(s.open(c));
          ids[c] = s.ids.size();
          if (s.type != CellType::polyhedron) continue;
          cell_faces[c] = s.face_count();
          for (size_t k = 0; k < s.face_count(); ++k) face_ids[c] += s.points(k).size();
        }
      },
      &context);
  const size_t all_ids = exclusive_scan(ids), all_faces = exclusive_scan(cell_faces), all_face_ids = exclusive_scan(face_ids);
  UnstructuredMesh r;
  r.points = m.points;
  int32_t *out = nullptr, *face_out = nullptr;
  int64_t *ends = nullptr, *face_ends = nullptr, *cell_begin = nullptr;
  r.cells.connectivity = Array::make<int32_t>(all_ids, 1, &out);
  const bool polyhedra = all_faces > 0;
  if (polyhedra) {
    r.faces.connectivity = Array::make<int32_t>(all_face_ids, 1, &face_out);
    r.faces.offsets = Array::make<int64_t>(all_faces + 1, 1, &face_ends);
    r.polyhedron_faces = Array::make<int64_t>(m.cells + 1, 1, &cell_begin);
    face_ends[0] = 0, cell_begin[m.cells] = int64_t(all_faces);
  }
  parallel_for(
      m.cells, grain,
      [&](size_t begin, size_t end) {
        CellShaper s(m, faces);
        for (size_t c = begin; c < end; ++c) {
          s.open(c);
          std::copy(s.ids.begin(), s.ids.end(), out + ids[c]);
          if (polyhedra) cell_begin[c] = int64_t(cell_faces[c]);
          if (s.type != CellType::polyhedron) continue;
          size_t at = face_ids[c];
          for (size_t k = 0; k < s.face_count(); ++k) {
            const auto p = s.points(k);
            if (s.outward(k)) std::copy(p.begin(), p.end(), face_out + at);
            else std::reverse_copy(p.begin(), p.end(), face_out + at);
            at += p.size();
            face_ends[cell_faces[c] + k + 1] = int64_t(at);
          }
        }
      },
      &context);
  const bool one_type = std::all_of(types.begin(), types.end(), [&](uint8_t t) { return t == types[0]; });
  if (one_type && !types.empty()) r.single_type = CellType(types[0]);
  const int fixed = one_type && !types.empty() ? cell_type_info(r.single_type).points : 0;
  if (fixed > 0) {
    r.cells.fixed = fixed;
  } else {
    r.cells.offsets = Array::make<int64_t>(m.cells + 1, 1, &ends);
    for (size_t c = 0; c <= m.cells; ++c) ends[c] = c == m.cells ? int64_t(all_ids) : int64_t(ids[c]);
  }
  if (!one_type) r.types = Array::from_vector(std::move(types));
  return r;
}

SurfaceMesh make_patch(const FoamMesh& m, const Patch& patch, std::vector<int64_t>& ids) {
  SurfaceMesh r;
  const auto first = size_t(m.face_begin[patch.start]), last = size_t(m.face_begin[patch.start + patch.count]);
  ids.assign(m.face_ids.begin() + ptrdiff_t(first), m.face_ids.begin() + ptrdiff_t(last));
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<int32_t> local(last - first);
  parallel_for(local.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      local[i] = int32_t(std::lower_bound(ids.begin(), ids.end(), int64_t(m.face_ids[first + i])) - ids.begin());
  });
  std::vector<int64_t> ends(patch.count + 1);
  for (size_t f = 0; f <= patch.count; ++f) ends[f] = m.face_begin[patch.start + f] - int64_t(first);
  r.polygons.connectivity = Array::from_vector(std::move(local));
  r.polygons.offsets = Array::from_vector(std::move(ends));
  r.points.xyz = gather(m.points.xyz, ids);
  r.points.origin = m.points.origin;
  return r;
}

}  // namespace sg::openfoam
