// SPDX-License-Identifier: Apache-2.0
#include "io/mfem/vector_numbering.h"

#include <fmt/core.h>

#include "base/error.h"

namespace sg::mfem {

VectorNumbering::VectorNumbering(const Topology& t, const FeCollection& c, const std::string& where) : t_(t), where_(where) {
  number_entities(t);
  of_edge_ = entity_dofs(c, 2, t.dimension);
  if (t.dimension > 2) of_triangle_ = entity_dofs(c, 3, 3), of_square_ = entity_dofs(c, 4, 3);
  size_ = t.edges * of_edge_.size();
  for (const auto& f : t.face_corners) {
    face_first_.push_back(size_);
    size_ += f[3] < 0 ? of_triangle_.size() : of_square_.size();
  }
  for (int g = 0; g < geometry_count; ++g) inside_[size_t(g)] = inside_vector_dofs(Geometry(g), c);
  for (size_t e = 0; e < t.size(); ++e) {
    inside_first_.push_back(size_);
    size_ += inside_[size_t(t.geometry[e])];
  }
}

// Degrees of freedom `dofs` of an edge or face, in a frame that lies so in the one in which they are numbered.
void VectorNumbering::add(size_t first, const std::vector<VectorDof>& dofs, Vec3 origin, Vec3 x, Vec3 y) {
  const double across = x.x * y.y - x.y * y.x;
  for (const VectorDof& d : dofs) {
    const Vec3 at = origin + x * d.at.x + y * d.at.y,
               direction = x * d.direction.x + y * d.direction.y + Vec3(0, 0, across * d.direction.z);
    for (size_t k = 0; k < dofs.size(); ++k) {  // their directions are unit vectors
      const double factor = dot(direction, dofs[k].direction);
      if (factor != 0 && length(dofs[k].at - at) < 1e-9) now_.shares.push_back({first + k, factor});
    }
    now_.begin.push_back(uint32_t(now_.shares.size()));
  }
}

void VectorNumbering::add_face(size_t e, size_t f) {
  const auto& corners = info(t_.geometry[e]).faces[f];
  const size_t n = corners.size();
  const std::vector<VectorDof>& dofs = n == 3 ? of_triangle_ : of_square_;
  if (dofs.empty()) return;
  static constexpr Vec3 triangle[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, square[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto number = size_t(t_.face[t_.face_begin[e] + f]);
  const std::span<const int64_t> base = std::span(t_.face_corners[number]).first(n);
  const auto odd = [&]() { fail_data(fmt::format("face {} of element {} does not match the face of its neighbour", f, e), where_); };
  if ((t_.face_corners[number][3] < 0) != (n == 3)) odd();
  const auto place = [&](size_t k) {
    const int c = corner_in(base, t_.element(e)[size_t(corners[k])]);
    if (c < 0) odd();
    return n == 3 ? triangle[c] : square[c];
  };
  const Vec3 origin = place(0), x = place(1) - origin, y = place(n - 1) - origin;
  if (n == 4 && std::max(dot(x, x), dot(y, y)) > 1) odd();  // the corners go crosswise
  add(face_first_[number], dofs, origin, x, y);
}

const VectorNumbering::Shares& VectorNumbering::element(size_t e) {
  const GeometryInfo& g = info(t_.geometry[e]);
  now_.begin.assign(1, 0), now_.shares.clear();
  const auto v = t_.element(e);
  for (size_t k = 0; k < g.edges.size() && !of_edge_.empty(); ++k) {
    const auto [a, b] = g.edges[k];
    const bool forward = v[size_t(a)] < v[size_t(b)];
    // Turned by half a turn in the plane: RT's normals change sides with it.
    add(size_t(t_.edge[t_.edge_begin[e] + k]) * of_edge_.size(), of_edge_, {forward ? 0.0 : 1.0, 0, 0}, {forward ? 1.0 : -1.0, 0, 0},
        {0, 1, 0});
  }
  for (size_t f = 0; f < g.faces.size(); ++f) add_face(e, f);
  for (size_t k = 0; k < inside_[size_t(t_.geometry[e])]; ++k) {
    now_.shares.push_back({inside_first_[e] + k, 1});
    now_.begin.push_back(uint32_t(now_.shares.size()));
  }
  return now_;
}

}  // namespace sg::mfem
