// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/advect.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "filter/flow/texture/back_trace.h"
#include "filter/flow/texture/frame.h"

namespace sg {

using namespace texture;

void describe(Schema& s, AdvectParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  s("carry", p.carry, "Point fields to advect, from the second input if there is one; default: all scalars and colours.");
  s("time", p.time,
    "How long to advect; negative: backwards. Default: the time in which the largest speed covers a tenth of the longest side.")
      .unit("time");
  s("steps", p.steps, "Number of steps of the paths; 0: enough to keep each step below a cell of the data.").range(0, 1e6);
  s("border", p.border, "What flows in from outside: clamp (the value at the border) or nan (no value).");
  s("dye", p.dye, "Points x,y,z,x,y,z,... that release dye continuously.").unit("length");
  s("dye_radius", p.dye_radius, "Radius of the dye sources; 0: a fiftieth of the longest side.").unit("length").at_least(0);
  s("resolution", p.resolution, "Pixels along the longest side; 0: those of the grid, refined to 1024 (flat) or 128 (solid) where coarser.")
      .range(0, 100000);
}

namespace {

struct Carried {
  Field field;  // without its array
  Array from, to;
  std::byte* out;
};

// Fields to be carried and room for them.
std::vector<Carried> fields_to_carry(const Frame& f, const DatasetPtr& image, const AdvectParams& p) {
  const FieldSet& of = image ? image->fields() : f.fields;
  std::vector<Field> chosen;
  if (!p.carry.empty())
    for (const std::string& name : p.carry) chosen.push_back(of.require(name, Association::point));
  else
    for (const Field& field : of)
      if (field.association == Association::point && (field.components() == 1 || field.role == Role::colors)) chosen.push_back(field);
  if (chosen.empty() && p.dye.empty())
    fail_usage("there is no scalar or colour to advect", "advect", "name a point field with carry=NAME, or make one with dye=x,y,z");
  std::vector<Carried> r;
  for (Field& field : chosen) {
    Carried c;
    const ElementType type = field.array.type();
    c.from = image ? field_on_frame(f, image, field, "advect") : field.array;
    const bool bytes = type == ElementType::u8 && field.role == Role::colors;
    c.to = Array::make_raw(bytes ? type : type == ElementType::f64 ? type : ElementType::f32, f.size(), field.components(), &c.out);
    c.field = std::move(field);
    r.push_back(std::move(c));
  }
  return r;
}

void take_value(const Carried& c, const Frame& f, const BackPath& p, size_t pixel, bool none) {
  const PixelWeights w(f.dimension, f.n, p.x);
  const int components = c.field.components();
  dispatch(c.from, [&](auto v) {
    for (int k = 0; k < components; ++k) {
      double x = none ? std::numeric_limits<double>::quiet_NaN() : 0.0;
      for (int i = 0; i < w.count; ++i)
        if (w.weight[i] > 0) x += w.weight[i] * double(v(w.pixel[i], k));
      const size_t to = pixel * size_t(components) + size_t(k);
      switch (c.to.type()) {
        case ElementType::u8: reinterpret_cast<uint8_t*>(c.out)[to] = x == x ? uint8_t(std::clamp(x, 0.0, 255.0) + 0.5) : uint8_t(0); break;
        case ElementType::f64: reinterpret_cast<double*>(c.out)[to] = x; break;
        default: reinterpret_cast<float*>(c.out)[to] = float(x);
      }
    }
  });
}

}  // namespace

DatasetPtr advect(const DatasetPtr& input, const DatasetPtr& image, const AdvectParams& p, Context& context) {
  const Frame f = make_frame(input, p.field.name, p.resolution, "advect", context);
  if (p.dye.size() % 3 != 0) fail_usage(fmt::format("dye has {} numbers", p.dye.size()), "advect", "give three per point: x,y,z");
  const PixelFlow flow(f, context);
  const double longest = std::max({f.n[0], f.n[1], f.n[2]}), speed = flow.largest_speed();
  const double time = p.time.value_or(speed > 0 ? 0.1 * longest / speed : 0.0);
  const double wanted = p.steps > 0 ? double(p.steps) : std::ceil(std::abs(time) * speed / std::min(8.0, f.pixels_per_cell));
  if (!(wanted <= 1e6))
    fail_usage(fmt::format("the flow travels {:.3g} pixels in this time", wanted), "advect",
               "use a shorter time, or at most 1000000 steps");
  if (!p.time) context.info(fmt::format("advect: time {}", short_number(time)));

  std::vector<Carried> carried = fields_to_carry(f, image, p);
  BackTrace how;
  how.steps = int64_t(wanted);
  if (how.steps > 0) how.h = -time / double(how.steps);
  for (size_t i = 0; i < p.dye.size(); i += 3) how.dye.push_back(f.to_pixels({p.dye[i], p.dye[i + 1], p.dye[i + 2]}));
  std::copy_n(f.pitch, 3, how.pitch);
  const bool clamp = p.border == InflowBorder::clamp;
  const double radius = p.dye_radius > 0 ? p.dye_radius : longest * f.pitch[0] / 50;
  float* dye = nullptr;
  Array dyed;
  if (!p.dye.empty()) dyed = Array::make<float>(f.size(), 1, &dye);

  parallel_for(
      f.size(), 1024,
      [&](size_t begin, size_t end) {
        std::vector<BackPath> paths(end - begin);
        for (size_t i = begin; i < end; ++i) {
          double* x = paths[i - begin].x;
          x[0] = double(i % size_t(f.n[0])), x[1] = double(i / size_t(f.n[0]) % size_t(f.n[1]));
          x[2] = double(i / (size_t(f.n[0]) * size_t(f.n[1])));
        }
        trace_back(flow, how, paths.data(), paths.size());
        for (size_t i = begin; i < end; ++i) {
          const BackPath& path = paths[i - begin];
          for (const Carried& c : carried) take_value(c, f, path, i, !flow.has_value(i) || (path.left && !clamp));
          if (dye) {
            const double d = std::sqrt(path.nearest) / radius, t = std::clamp(2 - 2 * d, 0.0, 1.0);
            dye[i] = float(t * t * (3 - 2 * t));
          }
        }
      },
      &context);

  std::vector<Field> more;
  for (Carried& c : carried) {
    c.field.array = c.to;
    more.push_back(std::move(c.field));
  }
  if (dye) more.push_back({"dye", Association::point, std::move(dyed), "", more.empty() ? Role::scalars : Role::none});
  return frame_dataset(f, std::move(more));
}

Data advect_of(const std::vector<Data>& inputs, const AdvectParams& p, Context& context) {
  const DatasetPtr image = inputs.size() > 1 ? single_dataset(inputs[1], "advect") : nullptr;
  return over_parts(inputs[0], "advect", context, [&](const DatasetPtr& d) { return advect(d, image, p, context); });
}

}  // namespace sg
