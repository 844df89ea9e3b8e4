// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/h5_pack.h"

#include <algorithm>
#include <cstring>

#include <libdeflate.h>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::h5 {

namespace {

using Extents = std::vector<hsize_t>;

struct Compressor {
  libdeflate_compressor* c;
  explicit Compressor(int level) : c(libdeflate_alloc_compressor(level)) {}
  ~Compressor() { libdeflate_free_compressor(c); }
  Compressor(const Compressor&) = delete;
};

// The numbers of the chunk that begins at `at`; what lies outside the dataset is 0.
void gather(const std::byte* values, const Extents& dims, const Extents& chunk, const Extents& at, size_t size,
            std::vector<std::byte>& out) {
  std::fill(out.begin(), out.end(), std::byte(0));
  const size_t rank = dims.size(), last = rank - 1;
  const size_t run = size_t(std::min(chunk[last], dims[last] - at[last])) * size;
  Extents i(rank, 0);
  for (;;) {
    hsize_t from = 0, to = 0;
    for (size_t a = 0; a < rank; ++a) from = from * dims[a] + at[a] + i[a], to = to * chunk[a] + i[a];
    std::memcpy(out.data() + to * size, values + from * size, run);
    size_t a = last;
    for (; a > 0; --a) {  // the next row
      if (++i[a - 1] < std::min(chunk[a - 1], dims[a - 1] - at[a - 1])) break;
      i[a - 1] = 0;
    }
    if (a == 0) return;
  }
}

void shuffle(std::vector<std::byte>& data, size_t size) {
  if (size < 2) return;
  std::vector<std::byte> out(data.size());
  const size_t n = data.size() / size;
  for (size_t b = 0; b < size; ++b)
    for (size_t i = 0; i < n; ++i) out[b * n + i] = data[i * size + b];
  data = std::move(out);
}

}  // namespace

bool write_packed(hid_t set, const std::byte* values, const Extents& dims, const Extents& chunk, size_t element_size, int level,
                  const Context& context) {
  Extents counts(dims.size());
  size_t bytes = element_size, chunks = 1;
  for (size_t a = 0; a < dims.size(); ++a) {
    counts[a] = (dims[a] + chunk[a] - 1) / chunk[a];
    bytes *= chunk[a], chunks *= counts[a];
  }
  const size_t batch = 64;
  std::vector<std::vector<std::byte>> packed(batch);
  std::vector<Extents> places(batch);
  for (size_t begin = 0; begin < chunks; begin += batch) {
    const size_t n = std::min(batch, chunks - begin);
    parallel_for(
        n, 4,
        [&](size_t from, size_t to) {
          const Compressor compressor(level);
          if (!compressor.c) fail_data("there is not enough memory to compress chunks");
          std::vector<std::byte> data(bytes);
          for (size_t k = from; k < to; ++k) {
            Extents& at = places[k];
            at.resize(dims.size());
            for (size_t a = dims.size(), rest = begin + k; a-- > 0; rest /= counts[a]) at[a] = rest % counts[a] * chunk[a];
            data.resize(bytes);
            gather(values, dims, chunk, at, element_size, data);
            shuffle(data, element_size);
            packed[k].resize(libdeflate_zlib_compress_bound(compressor.c, data.size()));
            packed[k].resize(libdeflate_zlib_compress(compressor.c, data.data(), data.size(), packed[k].data(), packed[k].size()));
          }
        },
        &context);
    for (size_t k = 0; k < n; ++k)
      if (H5Dwrite_chunk(set, H5P_DEFAULT, 0, places[k].data(), packed[k].size(), packed[k].data()) < 0) return false;
  }
  return true;
}

}  // namespace sg::h5
