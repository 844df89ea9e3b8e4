// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/lines/line_frames.h"

#include <algorithm>

namespace sg {

namespace {

Vec3 any_across(Vec3 t) {
  const Vec3 a(std::abs(t.x), std::abs(t.y), std::abs(t.z));
  const Vec3 axis = a.x <= a.y && a.x <= a.z ? Vec3(1, 0, 0) : a.y <= a.z ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  return normalize(cross(t, axis));
}

Vec3 reflect(Vec3 v, Vec3 across) {
  const double n = dot(across, across);
  return n > 0 ? v - across * (2 * dot(across, v) / n) : v;
}

// Normal at b from that at a: reflected in the plane half way, then in the one that takes the reflected tangent to b's.
Vec3 carried(const LineFrame& a, const LineFrame& b) {
  const Vec3 chord = b.at - a.at;
  const Vec3 n = reflect(a.normal, chord), t = reflect(a.tangent, chord);
  const Vec3 r = reflect(n, b.tangent - t);
  return normalize(r - b.tangent * dot(r, b.tangent));
}

}  // namespace

void make_frames(std::span<const Vec3> line, bool closed, Vec3 first, std::vector<LineFrame>& out) {
  const size_t n = line.size();
  out.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 in = i > 0 ? line[i] - line[i - 1] : closed ? line[0] - line[n - 1] : Vec3();
    const Vec3 on = i + 1 < n ? line[i + 1] - line[i] : closed ? line[0] - line[n - 1] : Vec3();
    Vec3 t = normalize(in) + normalize(on);
    if (length(t) < 1e-9) t = length(on) > 0 ? on : in;  // turns right back
    out[i].at = line[i], out[i].tangent = normalize(t);
  }
  const Vec3 t0 = out[0].tangent;
  Vec3 start = first - t0 * dot(first, t0);
  out[0].normal = length(start) > 1e-6 * length(first) && length(first) > 0 ? normalize(start) : any_across(t0);
  for (size_t i = 1; i < n; ++i) out[i].normal = carried(out[i - 1], out[i]);
  if (closed && n > 2) {
    const Vec3 back = carried(out[n - 1], out[0]);
    const double turn = std::atan2(dot(cross(out[0].normal, back), t0), dot(out[0].normal, back));
    for (size_t i = 1; i < n; ++i) {
      const double angle = -turn * double(i) / double(n);
      const Vec3 b = cross(out[i].tangent, out[i].normal);
      out[i].normal = out[i].normal * std::cos(angle) + b * std::sin(angle);
    }
  }
  for (LineFrame& f : out) f.binormal = cross(f.tangent, f.normal);
}

std::vector<LinePath> line_paths(const Dataset& data) {
  const SurfaceMesh& mesh = *data.as<SurfaceMesh>();
  const CellsView lines = cells_view(mesh.lines);
  std::vector<LinePath> out;
  for (size_t c = 0; c < lines.count; ++c) {
    LinePath path;
    path.cell = uint32_t(mesh.vertices.size() + c);
    Vec3 last(NAN, NAN, NAN);
    for (size_t k = lines.begin(c); k < lines.end(c); ++k) {
      const auto id = uint32_t(lines.connectivity[k]);
      const Vec3 x = mesh.points.at(id);
      if (!std::isfinite(x.x + x.y + x.z) || x == last) continue;
      path.points.push_back(id), last = x;
    }
    if (path.points.size() > 3 && mesh.points.at(path.points.front()) == mesh.points.at(path.points.back()))
      path.closed = true, path.points.pop_back();
    if (path.points.size() > 1) out.push_back(std::move(path));
  }
  return out;
}

}  // namespace sg
