// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/label_surface.h"

#include <algorithm>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/fields/known_looks.h"
#include "filter/segment/label_nets.h"
#include "filter/segment/samples.h"

namespace sg {

void describe(Schema& s, LabelSurfaceParams& p) {
  s("field", p.field, "Field of labels; default: the first label field, else the active scalar.").takes(fields::scalars);
  s("background", p.background, "Background label.");
  s("labels", p.labels, "Labels to use; default: all except the background.");
  s("smooth", p.smooth, "Smooth the surfaces instead of keeping the voxel faces.");
  s("iterations", p.iterations, "Number of smoothing steps.").range(0, 10000);
  s("walls", p.walls, "Also make the faces between two labels.");
}

namespace {

// Place of a corner moved by `offset`: between the samples before and after it, and half a step beyond the outermost.
double place(const std::vector<double>& at, uint32_t corner, float offset) {
  const size_t n = at.size();
  if (n == 1) return at[0] + (double(corner) - 0.5 + double(offset));
  const double t = double(corner) - 0.5 + double(offset);
  const size_t i = size_t(std::clamp(t, 0.0, double(n - 2)));
  return at[i] + (at[i + 1] - at[i]) * (t - double(i));
}

Points place_vertices(const Dataset& in, const SampleImage& image, const LabelNet& net, const std::vector<float>& offset) {
  std::vector<uint32_t> corner(net.vertices() * 3);
  net.fill_corners(corner.data());
  const auto* uniform = in.as<UniformGrid>();
  const Vec3 center = in.bounds().empty() ? Vec3{} : in.bounds().center();
  Points points;
  points.origin = center;
  float* xyz = nullptr;
  points.xyz = Array::make<float>(net.vertices(), 3, &xyz);
  parallel_for(net.vertices(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      Vec3 p;
      for (int a = 0; a < 3; ++a) p[a] = place(image.at[size_t(a)], corner[v * 3 + size_t(a)], offset[v * 3 + size_t(a)]);
      p = (uniform ? uniform->origin + uniform->direction * p : p) - center;
      for (int a = 0; a < 3; ++a) xyz[v * 3 + size_t(a)] = float(p[a]);
    }
  });
  return points;
}

// Whether a grid with these axes reverses orientation.
bool mirrored(const Dataset& in, const SampleImage& image) {
  double sign = 1;
  for (const auto& x : image.at) sign *= x.size() > 1 && x.back() < x.front() ? -1 : 1;
  if (const auto* uniform = in.as<UniformGrid>()) sign *= determinant(uniform->direction);
  return sign < 0;
}

template <class T>
Array sides_array(const LabelCodes& codes, const std::vector<int64_t>& samples, double background) {
  T* out = nullptr;
  Array a = Array::make<T>(samples.size() / 2, 2, &out);
  parallel_for(samples.size(), 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int32_t c = samples[i] < 0 ? 0 : codes.code[size_t(samples[i])];
      out[i] = c == 0 ? T(background) : T(codes.label(c));
    }
  });
  return a;
}

}  // namespace

DatasetPtr label_surface(const DatasetPtr& input, const LabelSurfaceParams& params, Context& context) {
  if (!(params.background == std::floor(params.background)) || !(std::abs(params.background) < 0x1p53))
    fail_usage("the background is not a whole number", "label_surface background");
  const SampleImage image = sample_image(*input, params.field, "label_surface", true);
  const LabelCodes codes = label_codes(image, params.background, params.labels, "label_surface", context);
  const LabelNet net(codes.code.data(), image.dims, params.walls, context);

  SurfaceMesh mesh;
  int32_t* connectivity = nullptr;
  mesh.polygons.fixed = 4;
  mesh.polygons.connectivity = Array::make<int32_t>(net.faces() * 4, 1, &connectivity);
  std::vector<int64_t> samples(net.faces() * 2);
  net.fill_faces(connectivity, samples.data());
  if (mirrored(*input, image))
    for (size_t q = 0; q < net.faces(); ++q) std::reverse(connectivity + q * 4, connectivity + q * 4 + 4);
  mesh.points = place_vertices(*input, image, net, net.relaxed(params.smooth ? params.iterations : 0));

  DatasetParts out;
  out.mesh = std::move(mesh);
  out.time = input->time();
  out.notes = input->notes();  // names of labels, what the axes measure
  std::vector<int64_t> first(net.faces());
  for (size_t q = 0; q < net.faces(); ++q) first[q] = samples[q * 2];
  // The labels come first, so that they are what is coloured.
  FieldSet carried;
  carried.add(image.field);
  for (Field f : input->fields()) {
    if (f.name == image.field.name) continue;
    if (f.role == Role::scalars) f.role = Role::none;
    carried.add(std::move(f));
  }
  carry_gathered(out.fields, carried, image.field.association, first, Association::cell);
  mark_result(out.fields, image.field.name, Association::cell);
  carry_whole(out.fields, input->fields());
  const bool wide = !codes.table.empty() || std::abs(params.background) > double(INT32_MAX);
  out.fields.add({"sides", Association::cell,
                  wide ? sides_array<int64_t>(codes, samples, params.background) : sides_array<int32_t>(codes, samples, params.background),
                  "", Role::none});
  if (net.faces() == 0) context.info("label_surface: no sample has one of the selected labels; the surface is empty");
  return make_dataset(std::move(out));
}

}  // namespace sg
