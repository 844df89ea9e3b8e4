// SPDX-License-Identifier: Apache-2.0
#include "io/minc/minc_volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "data/lattice_crop.h"
#include "io/volume/direction.h"
#include "io/volume/nifti_header.h"

namespace sg::minc {

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

namespace {

[[noreturn]] void refuse(const Volume& v, const std::string& problem, const std::string& object, std::string hint = {}) {
  fail_data(problem, fmt::format("{}: '{}'", v.path, object), std::move(hint));
}

struct Layout {
  std::vector<size_t> axes;  // places among the image's dimensions of the volume's axes, slowest first
  std::vector<int> space;    // 0 x, 1 y, 2 z for each of them
  int vector = -1;           // place of vector_dimension
  int time = -1;
  size_t components = 1;
};

int space_of(const std::string& name) {
  const auto at = std::find(std::begin(spaces), std::end(spaces), name);
  return at == std::end(spaces) ? -1 : int(at - std::begin(spaces));
}

Layout layout_of(const Volume& v) {
  Layout l;
  for (size_t k = 0; k < v.dims.size(); ++k) {
    const Dimension& d = v.dims[k];
    if (d.name == "vector_dimension") l.vector = int(k), l.components = d.length;
    else if (space_of(d.name) >= 0) l.axes.push_back(k), l.space.push_back(space_of(d.name));
    else if (d.name == "time") l.time = int(k);
    else refuse(v, fmt::format("has the dimension '{}'", d.name), v.image, "supported: xspace, yspace, zspace, time and vector_dimension");
  }
  for (const int s : l.space)
    if (std::count(l.space.begin(), l.space.end(), s) > 1) refuse(v, "has the same direction twice", v.image);
  if (l.axes.empty() || l.components < 1 || l.components > 64) refuse(v, "is not a volume", v.image);
  return l;
}

UniformGrid grid_of(const Volume& v, const Layout& l) {
  // MINC's world is NIfTI's: +x right, +y anterior, +z superior.
  UniformGrid g;
  Vec3 direction[3];
  Vec3 origin(0, 0, 0);
  const auto n = int(l.axes.size());
  for (int a = 0; a < n; ++a) {
    // The file's fastest dimension is our first axis.
    const auto k = size_t(n - 1 - a);
    const int space = l.space[k];
    const Dimension& d = v.dims[l.axes[k]];
    const double start = d.start.value_or(0), step = d.step.value_or(1);
    const Vec3 cosines = d.cosines.value_or(Vec3(space == 0, space == 1, space == 2));
    if (!std::isfinite(start) || !std::isfinite(step) || step == 0)
      refuse(v, fmt::format("starts at {} with a step of {}", start, step), d.name);
    g.dims[size_t(a)] = d.length;
    g.spacing[a] = std::fabs(step);
    direction[a] = step < 0 ? cosines * -1.0 : cosines;
    origin = origin + cosines * start;
  }
  // A slice keeps its place along the direction that it lacks.
  for (const Dimension& d : v.others)
    if (const int s = space_of(d.name); s >= 0 && d.start && std::count(l.space.begin(), l.space.end(), s) == 0) {
      if (!std::isfinite(*d.start)) refuse(v, fmt::format("starts at {}", *d.start), d.name);
      origin = origin + d.cosines.value_or(Vec3(s == 0, s == 1, s == 2)) * *d.start;
    }
  g.direction = direction_of(direction, n, v.path);
  g.origin = origin;
  turn(g, nifti_axes);
  return g;
}

// real = (stored - valid_min) / (valid_max - valid_min) * (max - min) + min, with min and max of the slice.
class Scaling {
 public:
  explicit Scaling(const Volume& v) : v_(v) {
    std::tie(lo_, hi_) = type_range(v.type);
    lo_ = v.valid_min.value_or(lo_), hi_ = v.valid_max.value_or(hi_);
    // Floating point images are real values already.
    used_ = !is_float(v.type) && !v.min.empty() && v.min.size() == v.max.size() && hi_ > lo_;
    size_t slices = 1;
    for (size_t k = 0; k < v.dims.size(); ++k) (k < v.scaled_dims ? slices : slice_) *= v.dims[k].length;
    if (used_ && slices != v.min.size())
      refuse(v, fmt::format("has {} ranges of real values", v.min.size()), v.image,
             fmt::format("expected one for each of {} slices", slices));
  }
  bool used() const { return used_; }
  size_t slice() const { return slice_; }
  size_t slices() const { return v_.min.size(); }
  // factor and offset of a slice
  std::pair<double, double> of(size_t slice) const {
    const double factor = (v_.max[slice] - v_.min[slice]) / (hi_ - lo_);
    return {factor, v_.min[slice] - lo_ * factor};
  }
  // Whether real values are the stored numbers.
  bool is_identity() const {
    for (size_t s = 0; s < slices(); ++s)
      if (of(s) != std::pair(1.0, 0.0)) return false;
    return true;
  }

 private:
  const Volume& v_;
  double lo_ = 0, hi_ = 1;
  bool used_ = false;
  size_t slice_ = 1;
};

/// Components stored one after the other in the file (vector_dimension is not the fastest) are interleaved.
struct Components {
  size_t components, points, inner = 1;  // inner: numbers from one component to the next
  Components(const Layout& l, const std::vector<size_t>& count, size_t numbers) : components(l.components), points(numbers / l.components) {
    for (size_t k = size_t(l.vector + 1); l.vector >= 0 && k < count.size(); ++k) inner *= count[k];
  }
  size_t place(size_t i) const {
    if (components == 1) return i;
    const size_t c = i / inner % components, point = i / (inner * components) * inner + i % inner;
    return point * components + c;
  }
};

// As Real: f32, or f64 where that holds more of the stored digits.
template <class Real>
Array real_values(const Array& stored, const Volume& volume, const Layout& l, size_t step, const Scaling& scaling,
                  const Components& order) {
  Real* out = nullptr;
  Array real = Array::make<Real>(order.points, int(order.components), &out);
  // With a time dimension, one step is read: its slices are elsewhere in the file.
  size_t after = 1;
  for (size_t k = 0; l.time >= 0 && k < volume.dims.size(); ++k)
    if (int(k) > l.time) after *= volume.dims[k].length;
  const size_t steps = l.time >= 0 ? volume.dims[size_t(l.time)].length : 1;
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
        out[order.place(i)] = Real(double(v[i]) * factor + offset);
      }
    });
  });
  return real;
}

bool is_wide_integer(ElementType t) { return t == ElementType::i32 || t == ElementType::u32; }

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

constexpr std::pair<const char*, const char*> modalities[] = {{"MRI", "MR"},   {"MRS", "MR"}, {"MRA", "MR"}, {"PET", "PT"}, {"SPECT", "NM"},
                                                              {"GAMMA", "NM"}, {"CT", "CT"},  {"DSA", "XA"}, {"DR", "DX"}};

}  // namespace

std::string modality_word(const std::string& minc) {
  const std::string bare = minc.substr(0, minc.find('_'));
  for (const auto& [theirs, dicom] : modalities)
    if (bare == theirs) return dicom;
  return "";
}

std::string minc_modality(const std::string& dicom) {
  for (const auto& [theirs, word] : modalities)
    if (dicom == word) {  // five letters each
      std::string padded(theirs);
      padded.resize(5, '_');
      return padded;
    }
  return "";
}

std::vector<double> times_of(const Volume& volume) {
  for (const Dimension& d : volume.dims)
    if (d.name == "time") {
      std::vector<double> times(d.length);
      for (size_t i = 0; i < d.length; ++i) times[i] = d.start.value_or(0) + d.step.value_or(1) * double(i);
      return times;
    }
  return {};
}

DatasetPtr read_volume(const Volume& volume, const ReadOptions& options, Context& context) {
  const Layout l = layout_of(volume);
  DatasetParts parts;
  parts.mesh = grid_of(volume, l);
  note_patient_frame(parts, nifti_space);
  std::vector<size_t> start(volume.dims.size(), 0), count;
  std::string uneven;
  for (const Dimension& d : volume.dims) {
    count.push_back(d.length);
    if (d.irregular && d.length > 2) uneven += (uneven.empty() ? "" : ", ") + d.name;
  }
  if (!uneven.empty()) {
    parts.notes.emplace_back("spacing", fmt::format("uneven along {}, drawn with the step that is stated", uneven));
    context.warn(fmt::format("{}: the spacing is uneven along {}; drawn with the step that is stated", volume.path, uneven));
  }
  size_t step = 0;
  if (l.time >= 0) {
    const std::vector<double> times = times_of(volume);
    if (times.empty()) refuse(volume, "has no time step", volume.image);
    step = chosen_step(times, options, volume.path);
    start[size_t(l.time)] = step, count[size_t(l.time)] = 1;
    parts.time = times[step];
  } else if (options.step > 0) {
    chosen_step({}, options, volume.path);  // throws
  }
  const auto wanted = [&](const char* name) {
    return !options.header_only &&
           (options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end());
  };
  if (!volume.modality.empty()) parts.notes.emplace_back("Modality", volume.modality);
  parts.notes.insert(parts.notes.end(), volume.notes.begin(), volume.notes.end());
  if (wanted("image") || wanted("ImageScalars")) {
    const Scaling scaling(volume);
    const Array stored = volume.read(start, count);
    const Components order(l, count, stored.count());
    const bool as_stored = scaling.used() && scaling.is_identity(),
               wide = element_size(stored.type()) > 4 || is_wide_integer(stored.type());
    if (wanted("image") && (scaling.used() || is_float(stored.type()))) {
      // Three numbers are displacements, but bytes, which are colours.
      const Role role = order.components == 3 && element_size(stored.type()) > 1 ? Role::vectors : Role::scalars;
      Array values = as_stored ? stored_values(stored, order)
                     : wide    ? real_values<double>(stored, volume, l, step, scaling, order)
                               : real_values<float>(stored, volume, l, step, scaling, order);
      Field f{"image", Association::point, std::move(values), volume.unit, role};
      turn(f, nifti_axes.matrix());
      parts.fields.add(std::move(f));
    }
    if (wanted("ImageScalars") && !is_float(stored.type()) && !as_stored)
      parts.fields.add({"ImageScalars", Association::point, stored_values(stored, order), {}, scaling.used() ? Role::none : Role::scalars});
  }
  const DatasetPtr d = make_dataset(std::move(parts));
  if (options.region.whole()) return d;
  return crop_lattice(*d, options.region.lo, options.region.hi, options.region.stride);
}

}  // namespace sg::minc
