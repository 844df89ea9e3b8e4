// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/nearest_whole.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/trusted.h"
#include "filter/mesh/clip/clip_impl.h"
#include "filter/mesh/surface_builder.h"

namespace sg::clipping {

namespace {

constexpr size_t points_per_chunk = 1 << 14;

struct Shares {
  const Build& build;
  const Plane<double>& t;  // of each cut, from the end with the smaller id
};

template <class T>
T rounded(double v) {
  if constexpr (std::is_floating_point_v<T>) return T(v);
  else return nearest_whole<T>(v);
}

bool is_direction(const Field& f) {
  const ElementType t = f.array.type();
  return f.role == Role::normals && f.components() == 3 && (t == ElementType::f32 || t == ElementType::f64);
}

// A point field: kept values, blends along cut edges, blends inside cells.
Array carried(const Array& a, const Shares& s, bool direction) {
  const size_t kept = s.build.kept, cuts = s.build.cuts.size(), inner = s.build.inner_first.size() - 1;
  std::byte* bytes = nullptr;
  Array r = Array::make_raw(a.type(), kept + cuts + inner, a.components(), &bytes);
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    const auto n = size_t(v.components);
    T* out = reinterpret_cast<T*>(bytes);
    // Directions are as long as the blend of the lengths.
    auto long_at = [&](size_t k) { return length(Vec3(double(v(k, 0)), double(v(k, 1)), double(v(k, 2)))); };
    auto stretch = [](T* m, double wanted) {
      const double is = length(Vec3(double(m[0]), double(m[1]), double(m[2])));
      for (size_t c = 0; c < 3 && is > 0; ++c) m[c] = T(double(m[c]) * (wanted / is));
    };
    if (s.build.rows) copy_lattice_points(a, s.build.rows->grid, s.build.rows->ranks, bytes);
    else
      parallel_for(kept, points_per_chunk, [&](size_t begin, size_t end) {
        if (n == 1)
          for (size_t i = begin; i < end; ++i) out[i] = v[s.build.points[i]];
        else
          for (size_t i = begin; i < end; ++i)
            for (size_t c = 0; c < n; ++c) out[i * n + c] = v(s.build.points[i], int(c));
      });
    parallel_for(cuts, points_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const uint64_t name = s.build.cuts[i], p = name >> 32, q = name & 0xffffffffu;
        for (size_t c = 0; c < n; ++c)
          out[(kept + i) * n + c] =
              rounded<T>(double(v(std::min(p, q), int(c))) * (1 - s.t[i]) + double(v(std::max(p, q), int(c))) * s.t[i]);
        if (direction) {
          const double wanted = long_at(std::min(p, q)) * (1 - s.t[i]) + long_at(std::max(p, q)) * s.t[i];
          stretch(out + (kept + i) * n, wanted);
        }
      }
    });
    parallel_for(inner, points_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (size_t c = 0; c < n; ++c) {
          const size_t first = s.build.inner_first[i];
          const auto base = double(v(s.build.inner_points[first], int(c)));
          double sum = base;
          for (size_t k = first + 1; k < s.build.inner_first[i + 1]; ++k)
            sum += s.build.inner_weights[k] * (double(v(s.build.inner_points[k], int(c))) - base);
          out[(kept + cuts + i) * n + c] = rounded<T>(sum);
          if (!direction || c + 1 < n) continue;
          const double first_long = long_at(s.build.inner_points[first]);
          double wanted = first_long;
          for (size_t k = first + 1; k < s.build.inner_first[i + 1]; ++k)
            wanted += s.build.inner_weights[k] * (long_at(s.build.inner_points[k]) - first_long);
          stretch(out + (kept + cuts + i) * n, wanted);
        }
    });
  });
  return r;
}

template <class At>
Array places(const At& at, const Build& b, Plane<double>& t, const Job& job) {
  const size_t kept = b.kept, cuts = b.cuts.size(), inner = b.inner_first.size() - 1;
  double* xyz = nullptr;
  Array r = Array::make<double>(kept + cuts + inner, 3, &xyz);
  auto put = [&](size_t i, Vec3 p) { xyz[3 * i] = p.x, xyz[3 * i + 1] = p.y, xyz[3 * i + 2] = p.z; };
  const Values values = job.values();
  t.resize(cuts);
  if (b.rows) write_lattice_positions(Lattice(job.in->mesh()).view(), b.rows->grid, b.rows->ranks, xyz);
  else
    parallel_for(kept, points_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) put(i, at(b.points[i]));
    });
  parallel_for(cuts, points_per_chunk, [&](size_t begin, size_t end) {
    std::vector<Vec3> from(end - begin), to(end - begin);
    for (size_t i = begin; i < end; ++i) {
      const uint64_t name = b.cuts[i], p = name >> 32, q = name & 0xffffffffu;
      from[i - begin] = at(std::min(p, q)), to[i - begin] = at(std::max(p, q));
      t[i] = share_of(name, values, job.keep);
    }
    if (job.curved) job.curved.refine(from, to, std::span(t.data() + begin, end - begin));
    for (size_t i = begin; i < end; ++i) put(kept + i, lerp(from[i - begin], to[i - begin], t[i]));
  });
  parallel_for(inner, points_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 base = at(b.inner_points[b.inner_first[i]]);
      Vec3 sum = base;
      for (size_t k = b.inner_first[i] + 1; k < b.inner_first[i + 1]; ++k) sum += (at(b.inner_points[k]) - base) * b.inner_weights[k];
      put(kept + cuts + i, sum);
    }
  });
  return r;
}

// Ids as i32 where they fit: half the memory.
Array id_array(Plane<uint32_t> ids, size_t range) {
  if (range > size_t(INT32_MAX)) {
    int64_t* out = nullptr;
    Array r = Array::make<int64_t>(ids.size(), 1, &out);
    std::copy(ids.begin(), ids.end(), out);
    return r;
  }
  auto owner = std::make_shared<const Plane<uint32_t>>(std::move(ids));
  return Array(Buffer{owner, reinterpret_cast<const std::byte*>(owner->data()), owner->size() * 4}, ElementType::i32, owner->size());
}

}  // namespace

DatasetPtr finish(const Job& job, Build b) {
  const Dataset& in = *job.in;
  Plane<double> t;
  UnstructuredMesh mesh;
  if (is_lattice(in.mesh())) {
    const Lattice lattice(in.mesh());
    const LatticeView& v = lattice.view();
    const auto nx = uint32_t(v.dims[0]), ny = uint32_t(v.dims[1]);
    mesh.points.xyz =
        places([&](uint64_t i) { return v.position(uint32_t(i) % nx, uint32_t(i) / nx % ny, uint32_t(i) / nx / ny); }, b, t, job);
  } else {
    const PointReader reader(in.as<UnstructuredMesh>()->points);
    mesh.points.xyz = places([&](uint64_t i) { return reader[i]; }, b, t, job);
  }
  mesh.cells.connectivity = std::move(b.connectivity);
  mesh.cells.offsets = std::move(b.offsets);
  mesh.cells.fixed = b.fixed;
  mesh.types = std::move(b.types);
  mesh.single_type = b.single;
  mesh.faces = std::move(b.faces);
  mesh.polyhedron_faces = std::move(b.polyhedron_faces);

  DatasetParts out;
  out.mesh = std::move(mesh);
  const Shares shares{b, t};
  for (const Field& f : in.fields())
    if (f.association == Association::point) out.fields.add(f.with(carried(f.array, shares, is_direction(f))));
  carry_gathered(out.fields, in.fields(), Association::cell, b.source, Association::cell);
  carry_whole(out.fields, in.fields());
  if (!in.fields().find("original_cell", Association::cell))
    out.fields.add({"original_cell", Association::cell, id_array(std::move(b.source), in.cell_count()), {}, Role::global_ids});
  out.notes = in.notes();
  out.time = in.time();
  return make_trusted_dataset(std::move(out));
}

}  // namespace sg::clipping
