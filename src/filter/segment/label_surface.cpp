// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/label_surface.h"

#include <type_traits>

#include "base/parallel.h"
#include "data/lattice.h"

namespace sg {

void describe(Schema& s, LabelSurfaceParams& p) {
  s("field", p.field, "Point field of labels; default: the active scalar.");
  s("background", p.background, "Label that is nothing.");
  s("labels", p.labels, "Only these labels; default: all but the background.");
}

namespace {

struct Face {
  uint32_t i, j, k;  // wanted sample
  uint8_t side;      // 2*axis + (0 towards lower, 1 towards higher index)
};

// Corners of the face of sample (i,j,k) on `side` in the lattice of voxel corners, outward order.
void corner_indices(const Face& f, std::array<uint32_t, 3> (&corner)[4]) {
  const int axis = f.side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool high = f.side & 1;
  for (int c = 0; c < 4; ++c) {
    const int step = high ? c : 3 - c;
    std::array<uint32_t, 3> p{f.i, f.j, f.k};
    p[size_t(axis)] += high ? 1 : 0;
    p[size_t(u)] += step == 1 || step == 2 ? 1 : 0;
    p[size_t(v)] += step >= 2 ? 1 : 0;
    corner[c] = p;
  }
}

}  // namespace

DatasetPtr label_surface(const DatasetPtr& input, const LabelSurfaceParams& params, Context& context) {
  const auto* grid = input->as<UniformGrid>();
  if (!grid)
    fail_usage(fmt::format("works on uniform grids, this is {}", input->kind()), "label_surface",
               "use threshold and faces for other meshes");
  const Field* field = params.field.empty() ? input->fields().active(1) : &input->fields().require(params.field.name, Association::point);
  if (!field || field->association != Association::point || field->components() != 1)
    fail_usage("needs a point field with one component", "label_surface");
  const auto d = grid->dims;
  if (d[0] >= UINT32_MAX || d[1] >= UINT32_MAX || d[2] >= UINT32_MAX) fail_usage("the grid is too large", "label_surface");

  // Which samples are wanted, then one pass per slice for the faces; slices are joined in order.
  std::vector<std::vector<Face>> slices(d[2]);
  dispatch(field->array, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    auto wanted = [&](T x) {
      if (double(x) == params.background || !(x == x)) return false;
      return params.labels.empty() || std::find(params.labels.begin(), params.labels.end(), int64_t(x)) != params.labels.end();
    };
    parallel_for(
        d[2], 1,
        [&](size_t begin, size_t end) {
          for (size_t k = begin; k < end; ++k)
            for (size_t j = 0; j < d[1]; ++j)
              for (size_t i = 0; i < d[0]; ++i) {
                const size_t id = i + d[0] * (j + d[1] * k);
                if (!wanted(v[id])) continue;
                const size_t index[3] = {i, j, k}, stride[3] = {1, d[0], d[0] * d[1]};
                for (size_t side = 0; side < 6; ++side) {
                  const size_t a = side / 2;
                  const bool border = side & 1 ? index[a] + 1 == d[a] : index[a] == 0;
                  if (border || !wanted(v[side & 1 ? id + stride[a] : id - stride[a]]))
                    slices[k].push_back({uint32_t(i), uint32_t(j), uint32_t(k), uint8_t(side)});
                }
              }
        },
        &context);
  });
  std::vector<size_t> offset(slices.size() + 1);
  for (size_t k = 0; k < slices.size(); ++k) offset[k] = slices[k].size();
  const size_t faces = exclusive_scan(offset);
  if (faces * 4 > INT32_MAX) fail_usage("the surface has more than 500 million faces", "label_surface", "choose fewer labels");

  // Corners are numbered in the order of their lattice index, shared between faces: two layers of ids at a time.
  const size_t layer = (d[0] + 1) * (d[1] + 1);
  std::vector<int32_t> ids[2] = {std::vector<int32_t>(layer, -1), std::vector<int32_t>(layer, -1)};
  int32_t* connectivity = nullptr;
  SurfaceMesh mesh;
  mesh.polygons.fixed = 4;
  mesh.polygons.connectivity = Array::make<int32_t>(faces * 4, 1, &connectivity);
  std::vector<float> xyz;
  std::vector<int64_t> sample(faces);
  const Vec3 center = input->bounds().empty() ? Vec3{} : input->bounds().center();
  mesh.points.origin = center;
  for (size_t k = 0, at = 0; k < d[2]; ++k) {
    context.check();
    for (const Face& f : slices[k]) {
      std::array<uint32_t, 3> corner[4];
      corner_indices(f, corner);
      for (int c = 0; c < 4; ++c) {
        int32_t& id = ids[(corner[c][2] - k)][corner[c][0] + (d[0] + 1) * size_t(corner[c][1])];
        if (id < 0) {
          id = int32_t(xyz.size() / 3);
          const Vec3 index{double(corner[c][0]) - 0.5, double(corner[c][1]) - 0.5, double(corner[c][2]) - 0.5};
          const Vec3 p = grid->origin + grid->direction * (grid->spacing * index) - center;
          xyz.insert(xyz.end(), {float(p.x), float(p.y), float(p.z)});
        }
        connectivity[at * 4 + size_t(c)] = id;
      }
      sample[at++] = int64_t(f.i + d[0] * (f.j + d[1] * size_t(f.k)));
    }
    std::swap(ids[0], ids[1]);
    std::fill(ids[1].begin(), ids[1].end(), -1);
  }
  if (determinant(grid->direction) * grid->spacing.x * grid->spacing.y * grid->spacing.z < 0)  // a mirrored grid turns faces inside out
    for (size_t q = 0; q < faces; ++q) std::reverse(connectivity + q * 4, connectivity + q * 4 + 4);
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts out;
  out.mesh = std::move(mesh);
  for (const Field& f : input->fields()) {
    if (f.association != Association::point) continue;
    std::byte* bytes = nullptr;
    Field carried{f.name, Association::cell, Array::make_raw(f.array.type(), faces, f.components(), &bytes), f.unit, f.role};
    dispatch(f.array, [&](auto v) {
      using T = std::remove_cvref_t<decltype(v[0])>;
      for (size_t q = 0; q < faces; ++q)
        for (int c = 0; c < v.components; ++c) reinterpret_cast<T*>(bytes)[q * size_t(v.components) + size_t(c)] = v(size_t(sample[q]), c);
    });
    out.fields.add(std::move(carried));
  }
  if (faces == 0) context.info("label_surface: no sample carries a wanted label; the surface is empty");
  return make_dataset(std::move(out));
}

}  // namespace sg
