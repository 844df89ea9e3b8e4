// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/hdf5/h5_data.h"

#include <fmt/core.h>

#include <algorithm>

#include <libdeflate.h>

#include "base/bytes.h"
#include "base/error.h"
#include "base/parallel.h"

namespace sg::h5 {

namespace {

using Sizes = std::vector<uint64_t>;

// What is selected along one dimension, as far as one block (a chunk, or all) reaches: n indices, the first at `from` in the block
// and at `to` in the selection.
struct Span {
  uint64_t from = 0, to = 0, n = 0;
};
Span span_of(uint64_t start, uint64_t count, uint64_t stride, uint64_t block_begin, uint64_t block_size) {
  const uint64_t first = start >= block_begin ? 0 : (block_begin - start + stride - 1) / stride;
  const uint64_t index = start + first * stride;
  if (first >= count || index >= block_begin + block_size) return {};
  return {index - block_begin, first, std::min(count - first, (block_begin + block_size - 1 - index) / stride + 1)};
}

// Copies the selected part of a block to its places in the output.
void scatter(const std::byte* block, const Sizes& block_dims, const std::vector<Span>& spans, const Sizes& count, const Sizes& stride,
             size_t size, std::byte* out) {
  const size_t rank = block_dims.size();
  for (const Span& s : spans)
    if (s.n == 0) return;
  Sizes i(rank, 0);
  const size_t last = rank - 1;
  for (;;) {
    uint64_t from = 0, to = 0;
    for (size_t a = 0; a < rank; ++a) {
      from = from * block_dims[a] + spans[a].from + i[a] * stride[a];
      to = to * count[a] + spans[a].to + i[a];
    }
    if (stride[last] == 1) std::memcpy(out + to * size, block + from * size, spans[last].n * size);
    else
      for (uint64_t k = 0; k < spans[last].n; ++k) std::memcpy(out + (to + k) * size, block + (from + k * stride[last]) * size, size);
    size_t a = last;
    for (; a > 0; --a) {  // the next row
      if (++i[a - 1] < spans[a - 1].n) break;
      i[a - 1] = 0;
    }
    if (a == 0) return;
  }
}

uint32_t fletcher32(const std::byte* p, size_t n) {
  uint32_t a = 0, b = 0;
  auto fold = [](uint32_t v) { return (v & 0xffff) + (v >> 16); };
  for (size_t words = n / 2; words > 0;) {
    size_t run = std::min<size_t>(words, 360);
    words -= run;
    for (; run > 0; --run, p += 2) a += uint32_t(p[0]) << 8 | uint32_t(p[1]), b += a;
    a = fold(a), b = fold(b);
  }
  if (n % 2) a = fold(a + (uint32_t(p[0]) << 8)), b = fold(b + a);
  return fold(b) << 16 | fold(a);
}

struct Inflater {
  libdeflate_decompressor* d = libdeflate_alloc_decompressor();
  ~Inflater() { libdeflate_free_decompressor(d); }
};

/// One chunk as it is stored, and which filters were left out.
struct Stored {
  Sizes at;  // first index along each dimension
  std::vector<std::byte> bytes;
  uint32_t mask = 0;
};

// Undoes the filters, last to first. The result has exactly `want` bytes.
std::vector<std::byte> unpack(Stored&& s, const Storage& storage, size_t want, const std::string& where) {
  auto fail = [&](const char* what) { fail_data(fmt::format("a chunk {}", what), where, "the file is damaged"); };
  std::vector<std::byte> data = std::move(s.bytes);
  for (size_t f = storage.filters.size(); f-- > 0;) {
    if (s.mask >> std::min<size_t>(f, 31) & 1) continue;
    size_t before = want;  // checksums that were added earlier are still there
    for (size_t g = 0; g < f; ++g)
      if (storage.filters[g].id == H5Z_FILTER_FLETCHER32 && !(s.mask >> g & 1)) before += 4;
    if (storage.filters[f].id == H5Z_FILTER_FLETCHER32) {
      if (data.size() < 4) fail("is too short for its checksum");
      const uint32_t said = load<uint32_t>(data.data() + data.size() - 4);
      data.resize(data.size() - 4);
      const uint32_t sum = fletcher32(data.data(), data.size());
      const uint32_t swapped = (sum & 0x00ff00ff) << 8 | (sum >> 8 & 0x00ff00ff);  // as early libraries wrote it
      if (said != sum && said != swapped) fail("does not match its checksum");
    } else if (storage.filters[f].id == H5Z_FILTER_DEFLATE) {
      thread_local Inflater inflater;
      std::vector<std::byte> out(before);
      if (libdeflate_zlib_decompress(inflater.d, data.data(), data.size(), out.data(), out.size(), nullptr) != LIBDEFLATE_SUCCESS)
        fail("cannot be decompressed");
      data = std::move(out);
    } else {  // shuffle: all first bytes, all second bytes, ...; what does not fill an element follows
      const size_t size = storage.filters[f].element_size, n = size > 0 ? data.size() / size : 0;
      if (size <= 1 || n <= 1) continue;
      std::vector<std::byte> out(data.size());
      for (size_t b = 0; b < size; ++b)
        for (size_t i = 0; i < n; ++i) out[i * size + b] = data[b * n + i];
      std::copy(data.begin() + ptrdiff_t(n * size), data.end(), out.begin() + ptrdiff_t(n * size));
      data = std::move(out);
    }
  }
  if (data.size() != want) fail("has the wrong size");
  return data;
}

class ChunkReader {
 public:
  ChunkReader(hid_t set, const Storage& s, const Sizes& start, const Sizes& count, const Sizes& stride, std::byte* out,
              const std::string& where)
      : set_(set), s_(s), start_(start), count_(count), stride_(stride), out_(out), where_(where) {
    for (const uint64_t c : s.chunk) chunk_bytes_ *= c;  // checked against the file before
    chunk_bytes_ *= s.element_size;
  }

  void run() {
    const size_t rank = s_.dims.size();
    Sizes first(rank), last(rank);  // chunks that the selection touches
    for (size_t a = 0; a < rank; ++a) {
      if (count_[a] == 0) return;
      first[a] = start_[a] / s_.chunk[a];
      last[a] = (start_[a] + (count_[a] - 1) * stride_[a]) / s_.chunk[a];
    }
    if (s_.filters.empty()) check_sizes();
    Sizes at = first;
    for (;;) {
      fetch(at);
      if (waiting_.size() >= 64 || waiting_bytes_ > (64 << 20)) flush();
      size_t a = rank;
      for (; a > 0; --a) {
        if (++at[a - 1] <= last[a - 1]) break;
        at[a - 1] = first[a - 1];
      }
      if (a == 0) break;
    }
    flush();
  }

 private:
  // The library copies as many bytes of an unfiltered chunk as its index states. Looking at every entry takes time with the square of
  // their number, so that of many only the sum is checked.
  void check_sizes() const {
    const hid_t all = H5Dget_space(set_);
    struct Closer {
      hid_t id;
      ~Closer() { H5Sclose(id); }
    } closer{all};
    hsize_t n = 0;
    uint64_t want = 0;
    if (H5Dget_num_chunks(set_, all, &n) < 0 || !multiply(n, chunk_bytes_, want) || H5Dget_storage_size(set_) != want)
      fail("does not have the size of the other chunks");
    std::vector<hsize_t> at(s_.dims.size());
    for (hsize_t i = 0; i < n && n <= 2048; ++i) {
      unsigned mask = 0;
      haddr_t place = 0;
      hsize_t bytes = 0;
      if (H5Dget_chunk_info(set_, all, i, at.data(), &mask, &place, &bytes) < 0 || bytes != chunk_bytes_)
        fail("does not have the size of the other chunks");
    }
  }
  void fetch(const Sizes& chunk) {
    std::vector<hsize_t> at(chunk.size());
    Stored s;
    s.at.resize(chunk.size());
    for (size_t a = 0; a < at.size(); ++a) at[a] = s.at[a] = chunk[a] * s_.chunk[a];
    hsize_t bytes = 0;
    if (H5Dget_chunk_storage_size(set_, at.data(), &bytes) < 0) {  // damaged, or never written
      unsigned mask = 0;
      haddr_t place = 0;
      if (H5Dget_chunk_info_by_coord(set_, at.data(), &mask, &place, &bytes) < 0 || place != HADDR_UNDEF) fail("cannot be found");
      H5Eclear2(H5E_DEFAULT);
      bytes = 0;
    }
    if (bytes == 0 && fill_.empty()) fill_ = s_.fill();
    if (bytes > s_.file_size) fail("is larger than the file");
    s.bytes.resize(bytes);
    if (bytes > 0 && H5Dread_chunk(set_, H5P_DEFAULT, at.data(), &s.mask, s.bytes.data()) < 0) fail("cannot be read");
    waiting_bytes_ += bytes + chunk_bytes_;
    waiting_.push_back(std::move(s));
  }
  [[noreturn]] void fail(const char* what) const {
    H5Eclear2(H5E_DEFAULT);
    fail_data(fmt::format("a chunk {}", what), where_, "the file is truncated or damaged");
  }
  void flush() {
    parallel_for(waiting_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) place(std::move(waiting_[i]));
    });
    waiting_.clear();
    waiting_bytes_ = 0;
  }
  void place(Stored&& s) {
    std::vector<Span> spans;
    for (size_t a = 0; a < s.at.size(); ++a)
      spans.push_back(span_of(start_[a], count_[a], stride_[a], s.at[a], std::min(s_.chunk[a], s_.dims[a] - s.at[a])));
    std::vector<std::byte> data;
    if (s.bytes.empty()) {  // never written
      data.resize(chunk_bytes_);
      for (size_t i = 0; i + s_.element_size <= data.size(); i += s_.element_size)
        std::memcpy(data.data() + i, fill_.data(), s_.element_size);
    } else {
      data = unpack(std::move(s), s_, chunk_bytes_, where_);
    }
    scatter(data.data(), s_.chunk, spans, count_, stride_, s_.element_size, out_);
  }

  hid_t set_;
  const Storage& s_;
  const Sizes &start_, &count_, &stride_;
  std::byte* out_;
  const std::string& where_;
  uint64_t chunk_bytes_ = 1;
  std::string fill_;
  std::vector<Stored> waiting_;
  uint64_t waiting_bytes_ = 0;
};

}  // namespace

void read_storage(hid_t set, const Storage& s, const MappedFile& file, const Sizes& start, const Sizes& count, const Sizes& stride,
                  std::byte* out, const std::string& where) {
  uint64_t total = 1, all = s.element_size, end = 0;
  for (const uint64_t n : count) total *= n;
  if (total == 0) return;
  if (s.at) {
    for (const uint64_t n : s.dims)
      if (!multiply(all, n, all)) all = UINT64_MAX;
    if (!add(*s.at, all, end) || end > file.size())
      fail_data(fmt::format("has {} bytes from byte {} on, beyond the end of the file", all, *s.at), where, "the file is truncated");
    std::vector<Span> spans;
    for (size_t a = 0; a < s.dims.size(); ++a) spans.push_back(span_of(start[a], count[a], stride[a], 0, s.dims[a]));
    scatter(file.data() + *s.at, s.dims, spans, count, stride, s.element_size, out);
  } else {
    ChunkReader(set, s, start, count, stride, out, where).run();
  }
  if (s.big_endian) swap_bytes(out, total, s.element_size);
}

}  // namespace sg::h5
