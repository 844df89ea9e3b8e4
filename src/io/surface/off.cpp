// SPDX-License-Identifier: Apache-2.0
// OFF and its variants COFF, NOFF, STOFF, CNOFF, ..., as text and binary (big-endian): vertices with normals, colours and texture
// coordinates, faces with colours. Source: Geomview manual, "OFF Files".
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "io/formats.h"
#include "io/text/mesh_text.h"
#include "io/text/text_scan.h"

namespace sg {

namespace {

struct OffHeader {
  bool texture = false, colors = false, normals = false, binary = false;
  size_t end = 0;  ///< behind the letters "OFF"
};

// The variant that the first letters name; false when they name none.
bool parse_off_header(std::string_view text, OffHeader& h) {
  size_t p = 0;
  while (p < text.size() && (is_space(text[p]) || text[p] == '#')) {
    if (text[p] == '#') p = std::min(text.find('\n', p), text.size());
    else ++p;
  }
  auto take = [&](std::string_view s) {
    if (text.substr(p, s.size()) != s) return false;
    p += s.size();
    return true;
  };
  h.texture = take("ST");
  h.colors = take("C");
  h.normals = take("N");
  if (!take("OFF")) return false;
  h.end = p;
  // "OFF8 6 12" is met, "OFFSET" is something else.
  return p == text.size() || is_space(text[p]) || is_digit(text[p]) || text[p] == '#';
}

struct OffMesh {
  size_t vertices = 0, faces = 0;
  std::vector<double> xyz;
  std::vector<float> normals, tcoords;
  std::vector<uint8_t> vertex_colors, face_colors;  ///< RGBA
  bool any_vertex_color = false, any_face_color = false;
  std::vector<int64_t> ids;
  std::vector<size_t> begin{0};
};

// Three or four numbers as a colour: 0..255 when whole numbers above 1, else 0..1. One number is an entry of a map: no colour.
bool add_color(const std::vector<double>& v, std::vector<uint8_t>& out) {
  uint8_t c[4] = {200, 200, 200, 255};
  const bool given = v.size() >= 3;
  bool bytes = false;
  for (double x : v) bytes = bytes || x > 1;
  for (size_t k = 0; given && k < std::min<size_t>(v.size(), 4); ++k)
    c[k] = uint8_t(std::lround(std::clamp(std::isnan(v[k]) ? 0 : bytes ? v[k] : v[k] * 255, 0.0, 255.0)));
  out.insert(out.end(), c, c + 4);
  return given;
}

// The numbers that are left on a line.
void rest_of_line(TextCursor& in, std::vector<double>& v) {
  v.clear();
  const std::string_view line = in.line();
  const char *p = line.data(), *end = p + line.size();
  for (double x = 0; (p = skip_blanks(p, end)) < end && scan_number(p, end, x);) v.push_back(x);
}

void read_text(const std::string& path, std::string_view text, const OffHeader& h, OffMesh& m) {
  TextCursor in(text, path, '#');
  in.seek(h.end);
  m.vertices = in.count("the number of vertices", 6);
  m.faces = in.count("the number of faces", 2);
  std::vector<double> rest;
  rest_of_line(in, rest);  // the number of edges, which is not needed
  for (size_t i = 0; i < m.vertices; ++i) {
    for (int a = 0; a < 3; ++a) {
      const double x = in.number("a coordinate");
      if (!std::isfinite(x)) in.fail("a coordinate that is not finite");
      m.xyz.push_back(x);
    }
    for (int a = 0; h.normals && a < 3; ++a) m.normals.push_back(float(in.number("a normal")));
    rest_of_line(in, rest);
    if (h.texture) {
      if (rest.size() < 2) in.fail("a vertex has no texture coordinates");
      m.tcoords.insert(m.tcoords.end(), rest.end() - 2, rest.end());
      rest.resize(rest.size() - 2);
    }
    m.any_vertex_color = add_color(rest, m.vertex_colors) || m.any_vertex_color;
  }
  for (size_t f = 0; f < m.faces; ++f) {
    const size_t n = in.count("the number of corners of a face", 2);
    if (n == 0) in.fail("a face has no corners");
    for (size_t k = 0; k < n; ++k) m.ids.push_back(in.index("vertex", 0, int64_t(m.vertices)));
    m.begin.push_back(m.ids.size());
    rest_of_line(in, rest);
    m.any_face_color = add_color(rest, m.face_colors) || m.any_face_color;
  }
}

void read_binary(const std::string& path, std::string_view bytes, size_t p, const OffHeader& h, OffMesh& m) {
  auto need = [&](uint64_t n, const char* what) {
    if (bytes.size() - p < n) fail_data(fmt::format("byte {}: the file ends in {}", p, what), path);
  };
  auto integer = [&](const char* what) {
    need(4, what);
    p += 4;
    return int64_t(load<int32_t>(bytes.data() + p - 4, true));
  };
  auto real = [&] {
    p += 4;
    return load<float>(bytes.data() + p - 4, true);
  };
  const int64_t nv = integer("the header"), nf = integer("the header");
  integer("the header");
  const uint64_t per_vertex = 12 + (h.normals ? 12 : 0) + (h.colors ? 16 : 0) + (h.texture ? 8 : 0);
  if (nv < 0 || nf < 0 || uint64_t(nv) > bytes.size() / per_vertex || uint64_t(nf) > bytes.size() / 8)
    fail_data(fmt::format("{} vertices and {} faces in a file of {} bytes", nv, nf, bytes.size()), path);
  m.vertices = size_t(nv), m.faces = size_t(nf);
  need(m.vertices * per_vertex, "the vertices");
  for (size_t i = 0; i < m.vertices; ++i) {
    for (int a = 0; a < 3; ++a) m.xyz.push_back(double(real()));
    for (int a = 0; h.normals && a < 3; ++a) m.normals.push_back(real());
    if (h.colors) {
      std::vector<double> c(4);
      for (double& x : c) x = double(real());
      m.any_vertex_color = add_color(c, m.vertex_colors);
    }
    for (int a = 0; h.texture && a < 2; ++a) m.tcoords.push_back(real());
  }
  for (double x : m.xyz)
    if (!std::isfinite(x)) fail_data("a coordinate that is not finite", path);
  for (size_t f = 0; f < m.faces; ++f) {
    const int64_t n = integer("a face");
    if (n < 1 || uint64_t(n) > (bytes.size() - p) / 4) fail_data(fmt::format("byte {}: a face has {} corners", p, n), path);
    for (int64_t k = 0; k < n; ++k) {
      const int64_t id = integer("a face");
      if (id < 0 || id >= nv) fail_data(fmt::format("byte {}: vertex {} does not exist", p, id), path, fmt::format("there are {}", nv));
      m.ids.push_back(id);
    }
    m.begin.push_back(m.ids.size());
    const int64_t colors = integer("a face");
    if (colors < 0 || colors > 4) fail_data(fmt::format("byte {}: a colour has {} numbers", p, colors), path);
    need(uint64_t(colors) * 4, "a face's colour");
    std::vector<double> c;
    for (int64_t k = 0; k < colors; ++k) c.push_back(double(real()));
    m.any_face_color = add_color(c, m.face_colors) || m.any_face_color;
  }
}

CellArray list_of(const OffMesh& m, const std::vector<size_t>& faces) {
  CellArray r;
  if (faces.empty()) return r;
  std::vector<int32_t> ids, offsets{0};
  bool same = true;
  for (size_t f : faces) {
    for (size_t k = m.begin[f]; k < m.begin[f + 1]; ++k) ids.push_back(int32_t(m.ids[k]));
    offsets.push_back(int32_t(ids.size()));
    same = same && offsets.back() - offsets[offsets.size() - 2] == offsets[1];
  }
  r.connectivity = Array::from_vector(std::move(ids));
  if (same) r.fixed = offsets[1];
  else r.offsets = Array::from_vector(std::move(offsets));
  return r;
}

}  // namespace

bool sniff_off(std::span<const std::byte> head) {
  OffHeader h;
  return parse_off_header({reinterpret_cast<const char*>(head.data()), head.size()}, h);
}

Data read_off(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  const std::string_view text = file.text();
  OffHeader h;
  if (!parse_off_header(text, h)) fail_data("does not begin with OFF", path, "OFF, COFF, NOFF, STOFF");
  OffMesh m;
  const size_t line = std::min(text.find('\n', h.end), text.size());
  if (text.substr(h.end, line - h.end).find("BINARY") != std::string_view::npos)
    read_binary(path, text, std::min(line + 1, text.size()), h, m);
  else read_text(path, text, h, m);
  if (m.ids.size() > size_t(INT32_MAX) || m.vertices > size_t(INT32_MAX)) fail_data("has more than 2^31 corners", path);

  // Faces of one or two corners are vertices and lines; cells come in the order of a surface.
  std::vector<size_t> kind[3];
  for (size_t f = 0; f < m.faces; ++f) kind[std::min<size_t>(m.begin[f + 1] - m.begin[f], 3) - 1].push_back(f);
  SurfaceMesh surface;
  surface.points.xyz = Array::from_vector(std::move(m.xyz), 3);
  surface.vertices = list_of(m, kind[0]);
  surface.lines = list_of(m, kind[1]);
  surface.polygons = list_of(m, kind[2]);
  FieldSet fields;
  if (h.normals) fields.add({"Normals", Association::point, Array::from_vector(std::move(m.normals), 3), "", Role::normals});
  if (h.texture) fields.add({"TCoords", Association::point, Array::from_vector(std::move(m.tcoords), 2), "", Role::tcoords});
  if (m.any_vertex_color) fields.add({"RGBA", Association::point, Array::from_vector(std::move(m.vertex_colors), 4), "", Role::colors});
  if (m.any_face_color) {
    std::vector<uint8_t> sorted;
    for (const auto& faces : kind)
      for (size_t f : faces)
        sorted.insert(sorted.end(), m.face_colors.begin() + ptrdiff_t(4 * f), m.face_colors.begin() + ptrdiff_t(4 * f + 4));
    fields.add({"RGBA", Association::cell, Array::from_vector(std::move(sorted), 4), "", Role::colors});
  }
  return make_dataset(std::move(surface), std::move(fields));
}

}  // namespace sg
