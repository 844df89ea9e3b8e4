// SPDX-License-Identifier: Apache-2.0
#include "io/gltf/gltf_document.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/text/json.h"
#include "base/text/text.h"
#include "io/gltf/gltf_bytes.h"
#include "io/gltf/gltf_materials.h"
#include "io/gltf/gltf_scene.h"

namespace sg {

namespace {

// Extensions that change looks only, or what this reader does anyway.
bool is_harmless(std::string_view name) {
  for (std::string_view start : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_"})
    if (name.starts_with(start)) return true;
  return name == "KHR_mesh_quantization" || name == "KHR_animation_pointer" || name == "KHR_xmp_json_ld";
}

// Walks the JSON; reports its location when something is wrong.
struct Parser {
  const std::string& path;
  const Json& root;

  [[noreturn]] void fail(const std::string& where, const std::string& what) const { fail_data(fmt::format("{}: {}", where, what), path); }

  uint64_t whole(const Json& o, const char* key, uint64_t otherwise, const std::string& where) const {
    const Json* v = o.find(key);
    if (!v) return otherwise;
    if (v->is_whole()) return v->whole();
    if (v->is_real() && v->number() >= 0 && v->number() < 9e15 && std::floor(v->number()) == v->number()) return uint64_t(v->number());
    fail(where, fmt::format("'{}' is not a whole number of 0 or more", key));
  }
  // An index into the list `of`, or -1 when there is none.
  int place(const Json& o, const char* key, const char* of, const std::string& where) const {
    if (!o.contains(key)) return -1;
    return checked(whole(o, key, 0, where), of, where, key);
  }
  int checked(uint64_t i, const char* of, const std::string& where, const char* key) const {
    const size_t n = root[of].items().size();
    if (i >= n) fail(where, fmt::format("'{}' is {}, but there are {} {}", key, i, n, of));
    return int(i);
  }
  std::string name(const Json& o) const { return o["name"].text(); }
  // Calls f(object, "accessor 3") for each entry of a list of the root.
  template <class F>
  void each(const char* list, const char* one, F&& f) const {
    const Json* found = root.find(list);
    if (!found) return;
    if (!found->is_list()) fail(list, "is not a list");
    size_t n = 0;
    for (const Json& o : found->items()) {
      const std::string where = fmt::format("{} {}", one, n++);
      if (!o.is_object()) fail(where, "is not an object");
      f(o, where);
    }
  }
  template <size_t n>
  bool numbers(const Json& o, const char* key, double (&out)[n], const std::string& where) const {
    const Json* list = o.find(key);
    if (!list) return false;
    if (!list->is_list() || list->size() != n) fail(where, fmt::format("'{}' is not a list of {} numbers", key, n));
    for (size_t i = 0; i < n; ++i) {
      const Json& v = (*list)[i];
      if (!v.is_number() || !std::isfinite(v.number())) fail(where, fmt::format("'{}' contains something that is not a number", key));
      out[i] = v.number();
    }
    return true;
  }

  ElementType type(const Json& o, const std::string& where) const {
    switch (whole(o, "componentType", 0, where)) {
      case 5120: return ElementType::i8;
      case 5121: return ElementType::u8;
      case 5122: return ElementType::i16;
      case 5123: return ElementType::u16;
      case 5125: return ElementType::u32;
      case 5126: return ElementType::f32;
    }
    fail(where, "'componentType' is not one of 5120, 5121, 5122, 5123, 5125, 5126");
  }

  GltfAccessor accessor(const Json& o, const std::string& where) const {
    GltfAccessor a;
    a.view = place(o, "bufferView", "bufferViews", where);
    a.offset = whole(o, "byteOffset", 0, where);
    a.count = whole(o, "count", 0, where);
    a.type = type(o, where);
    const std::string shape = o["type"].text();
    constexpr std::pair<std::string_view, int> shapes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                           {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    a.components = 0;
    for (const auto& [known, n] : shapes)
      if (shape == known) a.components = n;
    if (a.components == 0) fail(where, fmt::format("'type' is '{}', not SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4", shape));
    a.normalized = o["normalized"].boolean();
    if (const Json* s = o.find("sparse")) {
      if (!(*s)["indices"].is_object() || !(*s)["values"].is_object()) fail(where, "'sparse' has no 'indices' and 'values'");
      const Json &i = (*s)["indices"], &v = (*s)["values"];
      GltfSparse& sparse = a.sparse.emplace();
      sparse.count = whole(*s, "count", 0, where);
      sparse.indices_view = place(i, "bufferView", "bufferViews", where);
      sparse.values_view = place(v, "bufferView", "bufferViews", where);
      sparse.indices_offset = whole(i, "byteOffset", 0, where);
      sparse.values_offset = whole(v, "byteOffset", 0, where);
      sparse.indices_type = type(i, where);
      if (sparse.indices_view < 0 || sparse.values_view < 0) fail(where, "'sparse' does not name a bufferView");
      if (sparse.count > a.count) fail(where, fmt::format("{} sparse values of {}", sparse.count, a.count));
    }
    return a;
  }

  GltfNode node(const Json& o, const std::string& where) const {
    GltfNode n;
    n.name = name(o);
    n.mesh = place(o, "mesh", "meshes", where);
    if (const Json* c = o.find("children")) {
      if (!c->is_list()) fail(where, "'children' is not a list");
      for (const Json& child : c->items()) {
        if (!child.is_whole()) fail(where, "'children' contains something that is not a node number");
        n.children.push_back(checked(child.whole(), "nodes", where, "children"));
      }
    }
    double m[16];
    if (numbers(o, "matrix", m, where)) {
      for (int i = 0; i < 16; ++i) n.matrix.m[i % 4][i / 4] = m[i];
      return n;
    }
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    numbers(o, "translation", t, where);
    numbers(o, "rotation", q, where);
    numbers(o, "scale", s, where);
    const double l = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(l > 0) || !std::isfinite(l)) fail(where, "'rotation' is not a rotation");
    const double x = q[0] / l, y = q[1] / l, z = q[2] / l, w = q[3] / l;
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) n.matrix.m[i][j] = r[i][j] * s[j];
      n.matrix.m[i][3] = t[i];
    }
    return n;
  }

  GltfMesh mesh(const Json& o, const std::string& where) const {
    GltfMesh m;
    m.name = name(o);
    if (!o["primitives"].is_list()) fail(where, "has no 'primitives'");
    for (const Json& p : o["primitives"].items()) {
      const std::string here = fmt::format("{}, primitive {}", where, m.primitives.size());
      if (!p["attributes"].is_object()) fail(here, "has no 'attributes'");
      GltfPrimitive& r = m.primitives.emplace_back();
      for (const auto& [key, value] : p["attributes"].members()) {
        if (!value.is_whole()) fail(here, fmt::format("attribute '{}' is not an accessor number", key));
        r.attributes.emplace_back(key, checked(value.whole(), "accessors", here, key.c_str()));
      }
      r.indices = place(p, "indices", "accessors", here);
      r.material = place(p, "material", "materials", here);
      r.mode = int(std::min<uint64_t>(whole(p, "mode", 4, here), 99));
      if (r.mode > 6) fail(here, fmt::format("'mode' is {}, not 0 to 6", r.mode));
      // Without its extension a compressed primitive has accessors that no view backs.
      if (p["extensions"].contains("KHR_draco_mesh_compression")) {
        for (const auto& [key, accessor] : r.attributes)
          if (!root["accessors"][size_t(accessor)].contains("bufferView")) fail(here, "is compressed with KHR_draco_mesh_compression");
      }
    }
    return m;
  }

  void check_extensions(Context& context) const {
    for (const Json& e : root["extensionsRequired"].items()) {
      const std::string extension = e.is_text() ? e.text() : e.dump();
      if (!is_harmless(extension))
        fail_data(fmt::format("needs the extension {}, which is not supported", extension), path,
                  extension.find("compression") != std::string::npos ? "save it without compression" : "");
    }
    for (const char* list : {"animations", "skins"})
      if (root.contains(list)) context.info(fmt::format("{}: {} are ignored; the mesh is drawn without them", path, list));
  }

  GltfDocument document(std::string_view chunk, const MappedFile& file) const {
    GltfDocument d;
    d.path = path;
    each("buffers", "buffer", [&](const Json& o, const std::string& where) {
      const uint64_t length = whole(o, "byteLength", 0, where);
      GltfBuffer b;
      if (o["uri"].is_text()) b = gltf_uri(o["uri"].text(), path, where);
      else if (d.buffers.empty() && chunk.data()) b = {file.owner(), chunk};
      else if (o["extensions"].contains("EXT_meshopt_compression")) fail(where, "is compressed with EXT_meshopt_compression");
      else fail(where, "has neither 'uri' nor bytes in this file");
      if (length > b.bytes.size()) fail(where, fmt::format("has {} bytes, but its 'byteLength' is {}", b.bytes.size(), length));
      b.bytes = b.bytes.substr(0, size_t(length));
      d.backed += length;
      d.buffers.push_back(std::move(b));
    });
    each("bufferViews", "bufferView", [&](const Json& o, const std::string& where) {
      GltfView v;
      v.buffer = place(o, "buffer", "buffers", where);
      if (v.buffer < 0) fail(where, "does not name a buffer");
      v.offset = whole(o, "byteOffset", 0, where);
      v.length = whole(o, "byteLength", 0, where);
      v.stride = whole(o, "byteStride", 0, where);
      const uint64_t size = d.buffers[size_t(v.buffer)].bytes.size();
      if (v.offset > size || v.length > size - v.offset)
        fail(where, fmt::format("bytes {} + {} lie beyond the {} bytes of its buffer", v.offset, v.length, size));
      d.views.push_back(v);
    });
    each("accessors", "accessor", [&](const Json& o, const std::string& where) { d.accessors.push_back(accessor(o, where)); });
    each("meshes", "mesh", [&](const Json& o, const std::string& where) { d.meshes.push_back(mesh(o, where)); });
    each("nodes", "node", [&](const Json& o, const std::string& where) { d.nodes.push_back(node(o, where)); });
    each("materials", "material", [&](const Json& o, const std::string& where) {
      GltfMaterial m;
      m.name = name(o);
      double c[4];
      if (numbers(o["pbrMetallicRoughness"], "baseColorFactor", c, where))
        for (int i = 0; i < 4; ++i) m.base_color[i] = float(c[i]);
      d.materials.push_back(m);
    });
    add_roots(d);
    return d;
  }

  void add_roots(GltfDocument& d) const {
    const std::vector<Json>& scenes = root["scenes"].items();
    if (!scenes.empty()) {
      const int scene = std::max(place(root, "scene", "scenes", "the scene"), 0);
      const Json& s = scenes[size_t(scene)];
      if (!s.is_object()) fail("the scene", "is not an object");
      for (const Json& n : s["nodes"].items()) {
        if (!n.is_whole()) fail("the scene", "'nodes' contains something that is not a node number");
        d.roots.push_back(checked(n.whole(), "nodes", "the scene", "nodes"));
      }
      return;
    }
    std::vector<bool> child(d.nodes.size(), false);
    for (const GltfNode& n : d.nodes)
      for (int c : n.children) child[size_t(c)] = true;
    for (size_t i = 0; i < d.nodes.size(); ++i)
      if (!child[i]) d.roots.push_back(int(i));
  }
};

}  // namespace

GltfDocument read_gltf_document(const std::string& path, Context& context) {
  const MappedFile file(path);
  const GltfChunks chunks = gltf_chunks(file);
  const Json root = parse_json(chunks.json, path);
  if (!root["asset"].is_object()) fail_data("is JSON, but has no 'asset': it is not glTF", path);
  const Json& v = root["asset"]["version"];
  const std::string version = v.is_text() ? v.text() : "?";
  if (!version.starts_with("2")) fail_data(fmt::format("is glTF {}", version), path, "version 2.0 is supported");
  const Parser parser{path, root};
  parser.check_extensions(context);
  GltfDocument document = parser.document(chunks.binary, file);
  take_cameras_and_lights(root, document, context);
  if (!document.materials.empty()) {
    auto table = std::make_shared<MaterialTable>();
    int64_t number = 0;
    for (MaterialLook& look : gltf_looks(root, document, context)) table->looks[++number] = std::move(look);
    document.looks = std::move(table);
  }
  return document;
}

}  // namespace sg
