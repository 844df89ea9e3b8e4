// SPDX-License-Identifier: Apache-2.0
// glTF 2.0: every primitive of every mesh that a node of the scene places becomes a surface, its points and normals moved by the
// node. One primitive gives a surface, several a Collection of them. Materials hang on the field of their numbers. Animations and skins are
// left out.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "data/fields/label_names.h"
#include "image/image.h"
#include "io/formats.h"
#include "io/gltf/gltf_document.h"
#include "io/gltf/gltf_scene.h"

namespace sg {

namespace {

constexpr size_t deepest_node = 1000;
constexpr uint64_t most_copies = 256;  ///< times the size of the buffers that instances may take, above a quarter of a GiB

struct Linear {
  Mat3 points, normals;  ///< normals: cofactors, so that a flat scaling is met too
  bool identity, moves_only, mirrored;
};

Linear linear_of(const Mat4& m) {
  Linear l;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) l.points.m[i][j] = m.m[i][j];
  const double det = determinant(l.points);
  l.mirrored = det < 0;
  for (int i = 0; i < 3; ++i) {
    const int a = (i + 1) % 3, b = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int c = (j + 1) % 3, e = (j + 2) % 3;
      const double cofactor = l.points.m[a][c] * l.points.m[b][e] - l.points.m[a][e] * l.points.m[b][c];
      l.normals.m[i][j] = l.mirrored ? -cofactor : cofactor;
    }
  }
  l.identity = m == Mat4();
  l.moves_only = l.points == Mat3();
  return l;
}

// f(vector of doubles) of the first three components of each tuple, the others as they are.
template <class F>
Array moved(const Array& in, F&& f) {
  float* out = nullptr;
  const int n = in.components();
  Array r = Array::make<float>(in.count(), n, &out);
  const auto v = in.view<float>();
  parallel_for(in.count(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 p = f(Vec3(double(v(i, 0)), double(v(i, 1)), double(v(i, 2))));
      for (int c = 0; c < n; ++c) out[i * size_t(n) + size_t(c)] = c < 3 ? float(p[c]) : v(i, c);
    }
  });
  return r;
}

struct Reader {
  const ReadOptions& options;
  Context& context;
  const GltfDocument& doc;
  std::vector<Collection::Part> parts{};
  uint64_t taken = 0;
  bool any_without = false;  ///< a primitive has no material
  bool short_names = true;   ///< of all materials together

  bool wanted(const std::string& name) const {
    return !options.header_only &&
           (options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end());
  }

  std::vector<int32_t> corners(const GltfPrimitive& p, size_t points, const std::string& where) const {
    std::vector<int32_t> ids;
    if (p.indices < 0) {
      ids.resize(points);
      for (size_t i = 0; i < points; ++i) ids[i] = int32_t(i);
      return ids;
    }
    const GltfAccessor& a = doc.accessors[size_t(p.indices)];
    if (a.components != 1 || (a.type != ElementType::u8 && a.type != ElementType::u16 && a.type != ElementType::u32))
      fail_data(fmt::format("{}: indices are not unsigned integers", where), doc.path);
    const Array indices = gltf_array(doc, p.indices, true);
    ids.resize(indices.count());
    dispatch(indices, [&](auto v) {
      for (size_t i = 0; i < v.count; ++i) {
        if (!(double(v[i]) < double(points)))
          fail_data(fmt::format("{}: index {} at position {} is out of range for {} points", where, v[i], i, points), doc.path);
        ids[i] = int32_t(v[i]);
      }
    });
    return ids;
  }

  void add_cells(SurfaceMesh& mesh, int mode, std::vector<int32_t> ids, bool mirrored, const std::string& where) const {
    const size_t n = ids.size(), least = mode == 0 ? 0 : mode < 4 ? 2 : 3;
    if (n < least && n > 0) fail_data(fmt::format("{}: {} corners are too few for its mode {}", where, n, mode), doc.path);
    if ((mode == 1 && n % 2) || (mode == 4 && n % 3))
      fail_data(fmt::format("{}: {} corners are not a multiple of {}", where, n, mode == 1 ? 2 : 3), doc.path);
    auto cells = [](std::vector<int32_t> list, int fixed) {
      CellArray c;
      c.connectivity = Array::from_vector(std::move(list));
      c.fixed = fixed;
      return c;
    };
    auto one = [](std::vector<int32_t> list) {
      CellArray c;
      c.offsets = Array::from_vector(std::vector<int32_t>{0, int32_t(list.size())});
      c.connectivity = Array::from_vector(std::move(list));
      return c;
    };
    if (n == 0) return;
    switch (mode) {
      case 0: mesh.vertices = cells(std::move(ids), 1); return;
      case 1: mesh.lines = cells(std::move(ids), 2); return;
      case 2: ids.push_back(ids[0]); [[fallthrough]];
      case 3: mesh.lines = one(std::move(ids)); return;
      case 5:
        if (!mirrored) {
          mesh.strips = one(std::move(ids));
          return;
        }
        break;
    }
    std::vector<int32_t> triangles;
    if (mode == 4) triangles = std::move(ids);
    for (size_t k = 2; mode != 4 && k < n; ++k) {
      const size_t odd = k % 2;
      if (mode == 5) triangles.insert(triangles.end(), {ids[k - 2], ids[k - 1 + odd], ids[k - odd]});
      else triangles.insert(triangles.end(), {ids[0], ids[k - 1], ids[k]});
    }
    // A mirroring node turns triangles inside out; they are turned back.
    for (size_t k = 0; mirrored && k + 2 < triangles.size(); k += 3) std::swap(triangles[k + 1], triangles[k + 2]);
    mesh.polygons = cells(std::move(triangles), 3);
  }

  void add_fields(const GltfPrimitive& p, const Linear& l, size_t points, FieldSet& fields, const std::string& where) const {
    for (const auto& [key, accessor] : p.attributes) {
      if (key == "POSITION") continue;
      const std::string name = key.size() > 1 && key[0] == '_' ? key.substr(1) : key;
      if (!wanted(name)) continue;
      if (doc.accessors[size_t(accessor)].count != points)
        fail_data(fmt::format("{}: '{}' has {} values for {} points", where, key, doc.accessors[size_t(accessor)].count, points), doc.path);
      const bool color = key.starts_with("COLOR_");
      Array a = gltf_array(doc, accessor, color && doc.accessors[size_t(accessor)].type == ElementType::u8);
      const bool vector = key == "NORMAL" || key == "TANGENT";
      if (vector && a.components() < 3) fail_data(fmt::format("{}: '{}' has {} components", where, key, a.components()), doc.path);
      if (vector) a = a.converted(ElementType::f32);
      if (key == "NORMAL" && !l.moves_only) a = moved(a, [&](Vec3 v) { return normalize(l.normals * v); });
      if (key == "TANGENT" && !l.moves_only) a = moved(a, [&](Vec3 v) { return normalize(l.points * v); });
      const Role role = key == "NORMAL" ? Role::normals : key.starts_with("TEXCOORD_") ? Role::tcoords : color ? Role::colors : Role::none;
      fields.add({name, Association::point, std::move(a), "", role});
    }
  }

  DatasetPtr surface(const GltfPrimitive& p, const Mat4& m, const std::string& where) {
    int position = -1;
    for (const auto& [key, accessor] : p.attributes)
      if (key == "POSITION") position = accessor;
    if (position < 0) return nullptr;  // allowed: morph targets or an extension give the points
    const GltfAccessor& a = doc.accessors[size_t(position)];
    if (a.components != 3) fail_data(fmt::format("{}: positions have {} components", where, a.components), doc.path);
    if (a.count > uint64_t(INT32_MAX)) fail_data(fmt::format("{}: more than 2^31 points", where), doc.path);

    const Linear l = linear_of(m);
    SurfaceMesh mesh;
    mesh.points.xyz = gltf_array(doc, position).converted(ElementType::f32);
    taken += mesh.points.xyz.bytes();
    if (taken > (uint64_t(1) << 28) && taken / most_copies > doc.backed)
      fail_data("instances its meshes so often that they would fill more than 256 MiB", doc.path);
    if (!l.identity) mesh.points.xyz = moved(mesh.points.xyz, [&](Vec3 v) { return l.points * v + Vec3(m.m[0][3], m.m[1][3], m.m[2][3]); });
    const auto xyz = mesh.points.xyz.view<float>();
    for (size_t i = 0; i < xyz.count; ++i)
      if (!std::isfinite(xyz(i, 0)) || !std::isfinite(xyz(i, 1)) || !std::isfinite(xyz(i, 2)))
        fail_data(fmt::format("{}: point {} is not finite", where, i), doc.path);
    add_cells(mesh, p.mode, corners(p, xyz.count, where), l.mirrored, where);

    DatasetParts r;
    add_fields(p, l, xyz.count, r.fields, where);
    const size_t cells = mesh.vertices.size() + mesh.lines.size() + mesh.polygons.size() + mesh.strips.size();
    if (p.material >= 0) {
      const GltfMaterial& material = doc.materials[size_t(p.material)];
      if (!material.name.empty()) r.notes.emplace_back("material", material.name);
      const float* c = material.base_color;
      if (wanted("BaseColorMultiplier"))
        r.fields.add({"BaseColorMultiplier", Association::whole, Array::from_vector(std::vector<float>(c, c + 4), 4), "", Role::none});
    }
    if (p.material >= 0 && !r.fields.with_role(Role::colors)) add_base_color(doc.materials[size_t(p.material)], cells, r.fields);
    add_material_ids(p.material, cells, r);
    r.mesh = std::move(mesh);
    return make_dataset(std::move(r));
  }

  // The number of the material on all cells: that of the document's list, so that parts share one numbering. Cells without a material have
  // the number before the first.
  void add_material_ids(int material, size_t cells, DatasetParts& parts) const {
    if (doc.materials.empty() || !wanted("MaterialIds")) return;
    int32_t* out = nullptr;
    Array ids = Array::make<int32_t>(cells, 1, &out);
    std::fill_n(out, cells, int32_t(material + 1));
    parts.fields.add({"MaterialIds", Association::cell, std::move(ids), "", Role::labels, {}, doc.looks});
    // All names in each part, as long as they are few: what selects by name or makes a legend knows those of the other parts, too.
    LabelNames names("MaterialIds");
    const auto add = [&](int m) {
      const std::string& name = doc.materials[size_t(m)].name;
      names.add(m + 1, name.empty() ? fmt::format("material {}", m) : name);
    };
    if (material < 0 || any_without) names.add(0, "no material");
    if (short_names)
      for (size_t m = 0; m < doc.materials.size(); ++m) add(int(m));
    else if (material >= 0) add(material);
    parts.notes.push_back(names.note());
  }

  // The colour of the material on all cells, unless it is the white that a picture is multiplied with.
  void add_base_color(const GltfMaterial& material, size_t cells, FieldSet& fields) const {
    const float* c = material.base_color;
    if (!wanted("BaseColor") || (c[0] == 1 && c[1] == 1 && c[2] == 1)) return;
    uint8_t* out = nullptr;
    Array colors = Array::make<uint8_t>(cells, 3, &out);
    for (size_t i = 0; i < 3 * cells; ++i) out[i] = uint8_t(std::clamp(srgb_encode(c[i % 3]), 0.0f, 1.0f) * 255 + 0.5f);
    fields.add({"BaseColor", Association::cell, std::move(colors), "", Role::colors});
  }

  void add_mesh(int number, const Mat4& m, const std::string& node_name) {
    const GltfMesh& mesh = doc.meshes[size_t(number)];
    std::string name = !node_name.empty() ? node_name : !mesh.name.empty() ? mesh.name : fmt::format("mesh {}", number);
    for (size_t k = 0; k < mesh.primitives.size(); ++k) {
      const std::string where = fmt::format("mesh {}, primitive {}", number, k);
      if (DatasetPtr d = surface(mesh.primitives[k], m, where))
        parts.push_back({mesh.primitives.size() > 1 ? fmt::format("{} {}", name, k) : name, std::move(d)});
      context.check();
    }
  }

  void add_scene() {
    struct Visit {
      int node;
      size_t depth;
      Mat4 matrix;
    };
    std::vector<bool> seen(doc.nodes.size(), false);
    std::vector<Visit> stack;
    for (size_t i = doc.roots.size(); i-- > 0;) stack.push_back({doc.roots[i], 0, Mat4()});
    while (!stack.empty()) {
      const Visit v = stack.back();
      stack.pop_back();
      const GltfNode& node = doc.nodes[size_t(v.node)];
      if (seen[size_t(v.node)])
        fail_data(fmt::format("node {} has several parents or is its own ancestor", v.node), doc.path,
                  "the nodes of a scene must form a tree");
      seen[size_t(v.node)] = true;
      if (v.depth > deepest_node) fail_data(fmt::format("nodes are nested more than {} deep", deepest_node), doc.path);
      const Mat4 m = v.matrix == Mat4() ? node.matrix : v.matrix * node.matrix;
      if (node.mesh >= 0) add_mesh(node.mesh, m, node.name);
      for (size_t i = node.children.size(); i-- > 0;) stack.push_back({node.children[i], v.depth + 1, m});
    }
  }

  // Names of parts distinguish them.
  void number_names() {
    std::vector<std::string> names;
    for (const auto& p : parts) names.push_back(p.name);
    std::sort(names.begin(), names.end());
    for (size_t i = 0; i < parts.size(); ++i) {
      const auto [first, last] = std::equal_range(names.begin(), names.end(), parts[i].name);
      if (last - first > 1) parts[i].name += fmt::format(" #{}", i);
    }
  }
};

}  // namespace

bool sniff_glb(std::span<const std::byte> head) { return head.size() >= 4 && std::memcmp(head.data(), "glTF", 4) == 0; }

Data read_gltf(const std::string& path, const ReadOptions& options, Context& context) {
  const GltfDocument doc = read_gltf_document(path, context);
  Reader r{options, context, doc};
  constexpr size_t most_names = 256, most_letters = 16384;
  size_t letters = 0;
  for (const GltfMaterial& m : doc.materials) letters += m.name.size();
  r.short_names = doc.materials.size() <= most_names && letters <= most_letters;
  for (const GltfMesh& mesh : doc.meshes)
    for (const GltfPrimitive& p : mesh.primitives) r.any_without = r.any_without || p.material < 0;
  if (!doc.nodes.empty()) r.add_scene();
  else
    for (size_t k = 0; k < doc.meshes.size(); ++k) r.add_mesh(int(k), Mat4(), "");
  if (r.parts.empty()) fail_data("no node of its scene has a mesh", path);
  note_scene(doc, r.parts[0].data);
  if (r.parts.size() == 1) return r.parts[0].data;
  r.number_names();
  auto all = std::make_shared<Collection>();
  all->parts = std::move(r.parts);
  return CollectionPtr(all);
}

}  // namespace sg
