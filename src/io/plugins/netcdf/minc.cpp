// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/netcdf/minc.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <tuple>

#include <netcdf.h>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice_crop.h"
#include "io/volume/direction.h"
#include "io/volume/nifti_header.h"

namespace sg::nc {

namespace {

constexpr const char* spaces[] = {"xspace", "yspace", "zspace"};

struct MincLayout {
  std::vector<int> axes;   // places in image.dims of the volume's axes, slowest first
  std::vector<int> space;  // 0 x, 1 y, 2 z for each of them
  int vector = -1;         // place of vector_dimension
  int time = -1;
  size_t components = 1;
};

MincLayout layout_of(const NcFile& file, const Variable& image) {
  MincLayout l;
  for (size_t k = 0; k < image.dims.size(); ++k) {
    const std::string& name = file.dimensions()[size_t(image.dims[k])].name;
    const auto at = std::find(std::begin(spaces), std::end(spaces), name);
    if (name == "vector_dimension") l.vector = int(k), l.components = image.shape[k];
    else if (at != std::end(spaces)) l.axes.push_back(int(k)), l.space.push_back(int(at - std::begin(spaces)));
    else if (name == "time") l.time = int(k);
    else file.fail(fmt::format("has the dimension '{}'", name), image.name, "supported: xspace, yspace, zspace, time and vector_dimension");
  }
  for (size_t a = 0; a < l.axes.size(); ++a)
    if (std::count(l.space.begin(), l.space.end(), l.space[a]) > 1) file.fail("has the same direction twice", image.name);
  if (l.axes.empty() || l.components < 1 || l.components > 64) file.fail("is not a volume", image.name);
  return l;
}

UniformGrid grid_of(const NcFile& file, const Variable& image, const MincLayout& l) {
  // MINC's world is NIfTI's: +x right, +y anterior, +z superior.
  UniformGrid g;
  Vec3 direction[3];
  Vec3 origin(0, 0, 0);
  bool named[3] = {false, false, false};
  const auto n = int(l.axes.size());
  for (int a = 0; a < n; ++a) {
    // The file's fastest dimension is our first axis.
    const auto k = size_t(n - 1 - a);
    const int space = l.space[k];
    const Variable* v = file.find(spaces[space]);
    double start = 0, step = 1;
    Vec3 cosines(space == 0, space == 1, space == 2);
    if (v) {
      start = file.number(v, "start").value_or(0);
      step = file.number(v, "step").value_or(1);
      if (const auto c = file.numbers(v, "direction_cosines"); c.size() == 3) cosines = Vec3(c[0], c[1], c[2]);
    }
    if (!std::isfinite(start) || !std::isfinite(step) || step == 0)
      file.fail(fmt::format("starts at {} with a step of {}", start, step), spaces[space]);
    named[space] = true;
    g.dims[size_t(a)] = image.shape[size_t(l.axes[k])];
    g.spacing[a] = std::fabs(step);
    direction[a] = step < 0 ? cosines * -1.0 : cosines;
    origin = origin + cosines * start;
  }
  // A slice keeps its place along the direction that it lacks.
  for (int s = 0; s < 3; ++s)
    if (const Variable* v = named[s] ? nullptr : file.find(spaces[s]))
      if (const auto start = file.number(v, "start")) origin[s] += *start;
  g.direction = direction_of(direction, n, file.path());
  g.origin = origin;
  turn(g, nifti_axes);
  return g;
}

// Stored numbers with the sign given by "signtype": netCDF's types are signed, MINC's bytes are not.
Array with_sign(const NcFile& file, const Variable& image, const Array& read) {
  const std::string sign = file.text(&image, "signtype");
  const bool is_unsigned = sign.empty() ? image.type == NC_BYTE : sign.starts_with("unsigned");
  if (!is_unsigned) return read;
  const ElementType t = read.type() == ElementType::i8    ? ElementType::u8
                        : read.type() == ElementType::i16 ? ElementType::u16
                        : read.type() == ElementType::i32 ? ElementType::u32
                                                          : read.type();
  return Array(read.buffer(), t, read.count());
}

std::pair<double, double> type_range(ElementType t) {
  switch (t) {
    case ElementType::u8: return {0, 255};
    case ElementType::i8: return {-128, 127};
    case ElementType::u16: return {0, 65535};
    case ElementType::i16: return {-32768, 32767};
    case ElementType::u32: return {0, 4294967295.0};
    case ElementType::i32: return {-2147483648.0, 2147483647.0};
    default: return {0, 1};
  }
}

// real = (stored - valid_min) / (valid_max - valid_min) * (max - min) + min, with min and max of the slice.
class Scaling {
 public:
  Scaling(const NcFile& file, const Variable& image, ElementType type) {
    std::tie(lo_, hi_) = type_range(type);
    if (const auto r = file.numbers(&image, "valid_range"); r.size() == 2) lo_ = std::min(r[0], r[1]), hi_ = std::max(r[0], r[1]);
    if (const auto v = file.number(&image, "valid_min")) lo_ = *v;
    if (const auto v = file.number(&image, "valid_max")) hi_ = *v;
    low_ = file.find("image-min"), high_ = file.find("image-max");
    // Floating point images are real values already.
    used_ = !is_float(type) && low_ && high_ && low_->is_number() && high_->is_number() && low_->dims == high_->dims && hi_ > lo_;
    if (!used_) return;
    for (size_t k = 0; k < low_->dims.size(); ++k)
      if (k >= image.dims.size() || low_->dims[k] != image.dims[k])
        file.fail("must have the slowest dimensions of 'image'", low_->name, "expected one number per slice");
    min_ = file.doubles(*low_), max_ = file.doubles(*high_);
    for (size_t k = low_->dims.size(); k < image.dims.size(); ++k) slice_ *= image.shape[k];
  }
  bool used() const { return used_; }
  size_t slice() const { return slice_; }
  size_t slices() const { return min_.size(); }
  // factor and offset of a slice
  std::pair<double, double> of(size_t slice) const {
    const double factor = (max_[slice] - min_[slice]) / (hi_ - lo_);
    return {factor, min_[slice] - lo_ * factor};
  }

 private:
  const Variable *low_ = nullptr, *high_ = nullptr;
  double lo_ = 0, hi_ = 1;
  bool used_ = false;
  size_t slice_ = 1;
  std::vector<double> min_, max_;
};

/// Components stored one after the other in the file (vector_dimension is not the fastest) are interleaved.
struct Components {
  size_t components, points, inner = 1;  // inner: numbers from one component to the next
  Components(const MincLayout& l, const std::vector<size_t>& count, size_t numbers)
      : components(l.components), points(numbers / l.components) {
    for (size_t k = size_t(l.vector + 1); l.vector >= 0 && k < count.size(); ++k) inner *= count[k];
  }
  size_t place(size_t i) const {
    if (components == 1) return i;
    const size_t c = i / inner % components, point = i / (inner * components) * inner + i % inner;
    return point * components + c;
  }
};

Array real_values(const Array& stored, const Variable& image, const MincLayout& l, size_t step, const Scaling& scaling,
                  const Components& order) {
  float* out = nullptr;
  Array real = Array::make<float>(order.points, int(order.components), &out);
  // With a time dimension, one step is read: its slices are elsewhere in the file.
  size_t after = 1;
  for (size_t k = 0; l.time >= 0 && k < image.shape.size(); ++k)
    if (int(k) > l.time) after *= image.shape[k];
  const size_t steps = l.time >= 0 ? image.shape[size_t(l.time)] : 1;
  dispatch(stored, [&](const auto& v) {
    parallel_for(v.count, 1 << 16, [&](size_t begin, size_t end) {
      size_t known = SIZE_MAX;
      double factor = 1, offset = 0;
      for (size_t i = begin; i < end; ++i) {
        if (scaling.used()) {
          const size_t in_file = l.time >= 0 ? (i / after * steps + step) * after + i % after : i;
          const size_t slice = in_file / scaling.slice();
          if (slice != known) std::tie(factor, offset) = scaling.of(std::min(slice, scaling.slices() - 1)), known = slice;
        }
        out[order.place(i)] = float(double(v[i]) * factor + offset);
      }
    });
  });
  return real;
}

Array stored_values(const Array& stored, const Components& order) {
  if (order.components == 1) return stored;
  std::byte* out = nullptr;
  Array packed = Array::make_raw(stored.type(), order.points, int(order.components), &out);
  const size_t size = element_size(stored.type());
  parallel_for(stored.count(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) std::memcpy(out + order.place(i) * size, stored.raw() + i * size, size);
  });
  return packed;
}

}  // namespace

bool is_minc(const NcFile& file) {
  const Variable* image = file.find("image");
  if (!image || !image->is_number()) return false;
  for (const char* s : spaces)
    if (file.dim(s)) return true;
  return file.find("rootvariable") != nullptr;
}

namespace {

DatasetPtr read_volume(const NcFile& file, const ReadOptions& options) {
  const Variable& image = file.require("image");
  const MincLayout l = layout_of(file, image);
  DatasetParts parts;
  const UniformGrid grid = grid_of(file, image, l);
  parts.mesh = grid;
  note_patient_frame(parts, nifti_space);
  std::vector<size_t> start(image.shape.size(), 0), count = image.shape;
  size_t step = 0;
  if (l.time >= 0) {
    const size_t n = image.shape[size_t(l.time)];
    std::vector<double> times(n);
    const Variable* v = file.find("time");
    const double first = v ? file.number(v, "start").value_or(0) : 0, width = v ? file.number(v, "step").value_or(1) : 1;
    for (size_t i = 0; i < n; ++i) times[i] = first + width * double(i);
    step = chosen_step(times, options, file.path());
    if (n == 0) file.fail("has no time step", image.name);
    start[size_t(l.time)] = step, count[size_t(l.time)] = 1;
    parts.time = times[step];
  } else if (options.step > 0) {
    chosen_step({}, options, file.path());  // throws
  }
  const auto wanted = [&](const char* name) {
    return !options.header_only &&
           (options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end());
  };
  for (const char* name : {"history", "title"})
    if (std::string text = file.text(nullptr, name); !text.empty()) parts.notes.emplace_back(name, std::move(text));
  if (!wanted("image") && !wanted("ImageScalars")) return make_dataset(std::move(parts));

  const Array stored = with_sign(file, image, file.read(image, start, count, image.element()));
  const Scaling scaling(file, image, stored.type());
  const Components order(l, count, stored.count());
  if (wanted("image") && (scaling.used() || is_float(stored.type()))) {
    // Three numbers are displacements, but bytes, which are colours.
    const Role role = order.components == 3 && element_size(stored.type()) > 1 ? Role::vectors : Role::scalars;
    Field f{"image", Association::point, real_values(stored, image, l, step, scaling, order), file.text(&image, "units"), role};
    turn(f, nifti_axes.matrix());
    parts.fields.add(std::move(f));
  }
  if (wanted("ImageScalars") && !is_float(stored.type()))
    parts.fields.add({"ImageScalars", Association::point, stored_values(stored, order), {}, scaling.used() ? Role::none : Role::scalars});
  return make_dataset(std::move(parts));
}

}  // namespace

Data read_minc(const NcFile& file, const ReadOptions& options, Context&) {
  const DatasetPtr d = read_volume(file, options);
  if (options.region.whole()) return d;
  return crop_lattice(*d, options.region.lo, options.region.hi, options.region.stride);
}

}  // namespace sg::nc
