// SPDX-License-Identifier: Apache-2.0
#include "data/cells/own_indices.h"

#include <cstring>

#include "base/file/mapped_watch.h"
#include "base/parallel.h"

namespace sg {

namespace {

void own(Array& a) {
  if (a.empty() || !mapped_watch().holds(a.raw())) return;
  if (!a.packed()) {
    a = a.made_packed();
    return;
  }
  std::byte* to = nullptr;
  Array copy = Array::make_raw(a.type(), a.count(), a.components(), &to);
  parallel_for(a.bytes(), size_t(4) << 20, [&](size_t begin, size_t end) { std::memcpy(to + begin, a.raw() + begin, end - begin); });
  a = std::move(copy);
}

void own(CellArray& c) { own(c.connectivity), own(c.offsets); }

}  // namespace

void own_indices(Mesh& mesh) {
  if (auto* r = std::get_if<RectilinearGrid>(&mesh)) {
    own(r->x), own(r->y), own(r->z);
  } else if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) {
    own(u->cells), own(u->types), own(u->faces), own(u->polyhedron_faces), own(u->degrees);
  } else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) {
    own(s->vertices), own(s->lines), own(s->polygons), own(s->strips);
  }
}

}  // namespace sg
