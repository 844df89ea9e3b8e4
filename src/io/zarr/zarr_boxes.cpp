// SPDX-License-Identifier: Apache-2.0
// Boxes of numbers out of chunks.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/file/file.h"
#include "base/parallel.h"
#include "data/memory/byte_cache.h"
#include "io/zarr/zarr_image.h"

namespace sg::zarr {

namespace {

// Where x, y and z run inside a chunk.
struct ChunkShape {
  std::array<size_t, 3> size{1, 1, 1}, stride{0, 0, 0};  // in elements
  size_t first = 0;                                      // of the fixed axes
  std::vector<size_t> at;                                // of the chunk; x, y, z to be filled in
};

ChunkShape chunk_shape(const Box& box) {
  const ZarrArray& a = box.array;
  ChunkShape s;
  s.at.resize(a.shape.size());
  size_t stride = 1;
  for (size_t i = a.shape.size(); i-- > 0;) {
    bool space = false;
    for (size_t d = 0; d < 3; ++d)
      if (box.axis[d] == int(i)) s.size[d] = a.chunk[i], s.stride[d] = stride, space = true;
    if (!space) s.at[i] = box.fixed[i] / a.chunk[i], s.first += box.fixed[i] % a.chunk[i] * stride;
    stride *= a.chunk[i];
  }
  return s;
}

// The wanted samples of one axis that lie in chunk `c`: numbers [begin, end) of the part.
struct Run {
  size_t begin, end;
};
Run run_in(const LatticePart& p, size_t axis, size_t c, size_t size) {
  auto first_from = [&](size_t at) {  // number of the first wanted sample at or behind `at`
    return at <= p.lo[axis] ? size_t(0) : std::min(p.count[axis], (at - p.lo[axis] + p.stride[axis] - 1) / p.stride[axis]);
  };
  return {first_from(c * size), first_from((c + 1) * size)};
}

template <size_t SIZE>
void copy_row(const std::byte* from, ptrdiff_t step, std::byte* to, ptrdiff_t to_step, size_t n) {
  for (size_t i = 0; i < n; ++i, from += step, to += to_step) std::memcpy(to, from, SIZE);
}

struct Copy {
  const LatticePart& part;
  const ChunkShape& shape;
  size_t element, tuple;
  std::byte* out;

  void operator()(const std::byte* chunk, const std::byte* fill, const std::array<size_t, 3>& c) const {
    Run r[3];
    for (size_t a = 0; a < 3; ++a) r[a] = run_in(part, a, c[a], shape.size[a]);
    auto offset = [&](size_t a, size_t number) { return (part.lo[a] + number * part.stride[a] - c[a] * shape.size[a]) * shape.stride[a]; };
    const size_t n = r[0].end - r[0].begin;
    const ptrdiff_t step = chunk ? ptrdiff_t(part.stride[0] * shape.stride[0] * element) : 0, to_step = ptrdiff_t(tuple * element);
    for (size_t k = r[2].begin; k < r[2].end; ++k)
      for (size_t j = r[1].begin; j < r[1].end; ++j) {
        const std::byte* from = chunk ? chunk + (shape.first + offset(0, r[0].begin) + offset(1, j) + offset(2, k)) * element : fill;
        std::byte* to = out + ((k * part.count[1] + j) * part.count[0] + r[0].begin) * tuple * element;
        if (step == to_step && tuple == 1 && size_t(step) == element) std::memcpy(to, from, n * element);
        else if (element == 1) copy_row<1>(from, step, to, to_step, n);
        else if (element == 2) copy_row<2>(from, step, to, to_step, n);
        else if (element == 4) copy_row<4>(from, step, to, to_step, n);
        else copy_row<8>(from, step, to, to_step, n);
      }
  }
};

std::shared_ptr<const Array> load_chunk(const ZarrArray& array, const std::vector<size_t>& at) {
  static thread_local std::vector<std::byte> packed;
  if (!file_exists(array.chunk_path(at))) return nullptr;
  std::byte* out = nullptr;
  Array numbers = Array::make_raw(array.type, array.chunk_bytes() / element_size(array.type), 1, &out);
  if (!array.read_chunk(at, out, packed)) return nullptr;
  return std::make_shared<const Array>(std::move(numbers));
}

}  // namespace

Box box_of(const Image& image, size_t level, size_t step, size_t channel) {
  Box b{image.levels[level].array, {image.axis[0], image.axis[1], image.axis[2]}, {}};
  b.fixed.resize(b.array.shape.size());
  if (image.time_axis >= 0) b.fixed[size_t(image.time_axis)] = step;
  if (image.channel_axis >= 0) b.fixed[size_t(image.channel_axis)] = channel;
  return b;
}

void read_part(const Box& box, const LatticePart& part, std::byte* out, size_t tuple, const Chunks& chunks, const Context* context,
               bool parallel) {
  const ChunkShape shape = chunk_shape(box);
  const Copy copy{part, shape, element_size(box.array.type), tuple, out};
  std::array<size_t, 3> first{}, count{};
  for (size_t a = 0; a < 3; ++a) {
    first[a] = part.lo[a] / shape.size[a];
    count[a] = (part.lo[a] + (part.count[a] - 1) * part.stride[a]) / shape.size[a] + 1 - first[a];
  }
  const auto one = [&](size_t begin, size_t end) {
    std::vector<size_t> at = shape.at;
    for (size_t n = begin; n < end; ++n) {
      const std::array<size_t, 3> c = {first[0] + n % count[0], first[1] + n / count[0] % count[1], first[2] + n / count[0] / count[1]};
      bool any = true;
      for (size_t a = 0; a < 3; ++a) {
        const Run r = run_in(part, a, c[a], shape.size[a]);
        any = any && r.begin < r.end;
        if (box.axis[a] >= 0) at[size_t(box.axis[a])] = c[a];
      }
      if (!any) continue;
      const auto chunk = chunks(box.array, at);
      copy(chunk ? chunk->raw() : nullptr, box.array.fill, c);
    }
  };
  const size_t all = count[0] * count[1] * count[2];
  if (parallel) parallel_for(all, 1, one, context);
  else one(0, all);
}

Chunks fresh_chunks() { return load_chunk; }

bool any_chunk(const Box& box) {
  const std::string top = box.array.folder + (box.array.before.size() > 1 && box.array.before[1] == '/' ? box.array.before : "");
  if (!is_folder(top)) return false;
  for (const std::string& name : folder_entries(top))
    if ((name[0] >= '0' && name[0] <= '9') || name.starts_with("c.")) return true;
  return false;
}

namespace {

// The chunks of a box without gaps.
template <class F>
void for_each_chunk(const Box& box, const LatticePart& part, F&& f) {
  const ChunkShape shape = chunk_shape(box);
  std::array<size_t, 3> first{}, last{};
  for (size_t a = 0; a < 3; ++a) first[a] = part.lo[a] / shape.size[a], last[a] = (part.lo[a] + part.count[a] - 1) / shape.size[a];
  std::vector<size_t> at = shape.at;
  std::array<size_t, 3> c{};
  for (c[2] = first[2]; c[2] <= last[2]; ++c[2])
    for (c[1] = first[1]; c[1] <= last[1]; ++c[1])
      for (c[0] = first[0]; c[0] <= last[0]; ++c[0]) {
        for (size_t a = 0; a < 3; ++a)
          if (box.axis[a] >= 0) at[size_t(box.axis[a])] = c[a];
        f(box.array, at);
      }
}

// Levels that are whole multiples of the ones before, as far as there are some; the others are left out.
std::vector<size_t> usable_levels(const Image& image, std::vector<std::array<size_t, 3>>& coarseness) {
  std::vector<size_t> used{0};
  coarseness = {{1, 1, 1}};
  const auto fine = image.dims(0);
  for (size_t l = 1; l < image.levels.size(); ++l) {
    const auto n = image.dims(l);
    std::array<size_t, 3> c{};
    bool good = true, coarser = false;
    for (size_t a = 0; a < 3; ++a) {
      c[a] = size_t(std::max(1.0, std::round(image.levels[l].spacing[int(a)] / image.levels[0].spacing[int(a)])));
      // Spacings that do not go with the number of samples cannot be right.
      const double expected = double(fine[a]) / double(c[a]);
      good = good && c[a] <= (size_t(1) << 40) && std::abs(double(n[a]) - expected) <= 1.001 && c[a] % coarseness.back()[a] == 0;
      coarser = coarser || c[a] > coarseness.back()[a];
    }
    if (good && coarser) used.push_back(l), coarseness.push_back(c);
  }
  return used;
}

std::vector<BrickedVolume::Extremes> read_extremes(const Image& image, size_t channel, size_t step, const BrickedVolume& volume) {
  if (image.minmax.empty() || step > 0) return {};
  const auto array = open_array(image.minmax);
  const auto n = volume.blocks();
  if (!array || array->type != ElementType::f32 || array->shape.size() != 5 ||
      array->chunk != std::vector<size_t>({1, n[2], n[1], n[0], 2}) || channel >= array->shape[0])
    return {};
  std::vector<BrickedVolume::Extremes> e(n[0] * n[1] * n[2]);
  std::vector<std::byte> packed;
  const size_t at[] = {channel, 0, 0, 0, 0};
  if (!array->read_chunk(at, reinterpret_cast<std::byte*>(e.data()), packed)) return {};
  return e;
}

}  // namespace

BrickedPtr bricked(std::shared_ptr<const Image> image, size_t step, size_t channel, size_t cache) {
  auto v = std::make_shared<BrickedVolume>();
  v->field = image->channels[channel], v->unit = image->unit, v->type = image->levels[0].array.type, v->direction = image->direction;
  std::vector<std::array<size_t, 3>> coarseness;
  const std::vector<size_t> used = usable_levels(*image, coarseness);
  for (size_t i = 0; i < used.size(); ++i) {
    const UniformGrid g = image->grid(used[i]);
    v->levels.push_back({g.dims, g.origin, g.spacing, coarseness[i]});
  }
  v->extremes = read_extremes(*image, channel, step, *v);
  auto kept = std::make_shared<ByteCache<Array>>(cache);
  v->read = [=](size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> count, std::byte* out) {
    LatticePart part;
    part.dims = image->dims(used[level]), part.lo = lo, part.count = count;
    const Chunks chunks = [&](const ZarrArray& array, const std::vector<size_t>& at) -> std::shared_ptr<const Array> {
      uint64_t key = 0;
      for (size_t a = 0; a < at.size(); ++a) key = key * array.chunks(a) + at[a];
      key = key * image->levels.size() + used[level];
      const auto chunk = kept->get(key, [&] {
        auto c = load_chunk(array, at);
        if (!c) c = std::make_shared<const Array>();
        const size_t bytes = c->bytes() + 64;
        return std::pair(std::move(c), bytes);
      });
      return chunk->empty() ? nullptr : chunk;
    };
    read_part(box_of(*image, used[level], step, channel), part, out, 1, chunks, nullptr, false);
  };
  v->expect = [=](size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> count) {
    LatticePart part;
    part.dims = image->dims(used[level]), part.lo = lo, part.count = count;
    for_each_chunk(box_of(*image, used[level], step, channel), part, [](const ZarrArray& array, const std::vector<size_t>& at) {
      const int fd = ::open(array.chunk_path(at).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
      if (fd < 0) return;
      ::posix_fadvise(fd, 0, 0, POSIX_FADV_WILLNEED);
      ::close(fd);
    });
  };
  return v;
}

}  // namespace sg::zarr
