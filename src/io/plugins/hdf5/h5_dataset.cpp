// SPDX-License-Identifier: Apache-2.0
// Datasets: shape, what the file can back, where the numbers lie.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/error.h"
#include "base/text/text.h"
#include "io/plausible.h"
#include "io/plugins/hdf5/guarded.h"
#include "io/plugins/hdf5/h5.h"

namespace sg::h5 {

Dataset::Dataset(const File& file, const std::string& path) : file_(file), path_(path) {
  if (!file.is_dataset(path)) file.fail("is not a dataset", path, "the file is truncated or not complete");
  set_ = Handle(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT));
  if (!set_.good()) file.fail("cannot be opened", path, "the file is damaged");
  type_in_file_ = Handle(H5Dget_type(set_));
  space_ = Handle(H5Dget_space(set_));
  if (!type_in_file_.good() || !space_.good()) file.fail("has no type or no shape", path, "the file is damaged");
  const int rank = H5Sget_simple_extent_ndims(space_);
  if (H5Sget_simple_extent_type(space_) == H5S_NULL) {
    dims_ = {0};
  } else if (rank > 0) {
    std::vector<hsize_t> d(static_cast<size_t>(rank));
    H5Sget_simple_extent_dims(space_, d.data(), nullptr);
    dims_.assign(d.begin(), d.end());
  }
  for (size_t i = 0; i < dims_.size(); ++i)
    if (!multiply(count_, dims_[i], count_) || (i > 0 && !multiply(row_size_, dims_[i], row_size_)))
      file.fail("has more numbers than can be counted", path);
  numeric_ = plain_type(type_in_file_, type_, big_endian_);
  find_layout();
}

// What the file can back: bytes stored, times what deflate can reach at most where there are filters. Chunks that were never written
// are legal but backed by nothing: a mebibyte of them is allowed for.
void Dataset::find_layout() {
  const Handle made(H5Dget_create_plist(set_));
  const Handle file(H5Iget_file_id(set_));
  hsize_t size = 0;
  if (!made.good() || !file.good() || H5Fget_filesize(file, &size) < 0) file_.fail("has no layout", path_, "the file is damaged");
  const H5D_layout_t layout = H5Pget_layout(made);
  if (layout == H5D_VIRTUAL) file_.fail("is a virtual dataset, which is not supported", path_, "copy it with h5repack first");
  if (layout == H5D_CONTIGUOUS && H5Pget_external_count(made) > 0)
    file_.fail("keeps its numbers in other files, which is not supported", path_, "copy it with h5repack first");
  const int filters = H5Pget_nfilters(made);
  const uint64_t stored = std::min<uint64_t>(H5Dget_storage_size(set_), size);
  if (!multiply(stored, filters > 0 ? 1032 : 1, backed_) || !add(backed_, 1 << 20, backed_)) backed_ = UINT64_MAX;
  uint64_t bytes = H5Tget_size(type_in_file_);
  if (layout == H5D_CHUNKED) {
    std::vector<hsize_t> chunk(dims_.size());
    if (H5Pget_chunk(made, int(chunk.size()), chunk.data()) != int(dims_.size())) file_.fail("has chunks of different dimensions", path_);
    for (const hsize_t c : chunk)
      if (c == 0 || !multiply(bytes, c, bytes)) bytes = UINT64_MAX;
    if (bytes > backed_ && count_ > 0)
      file_.fail(fmt::format("has chunks of {} bytes, but only {} bytes are stored", bytes, stored), path_, "the file is damaged");
  } else if (!multiply(bytes, count_, bytes) || (stored > 0 && stored < bytes)) {
    file_.fail(fmt::format("needs {} bytes, but {} are stored", bytes, stored), path_, "the file is damaged");
  }
  file_size_ = size;
  if (!numeric_ || count_ == 0) return;
  H5O_info_t here, top;
  if (H5Oget_info2(set_, &here, H5O_INFO_BASIC) < 0 || H5Oget_info_by_name2(file_.id(), "/", &top, H5O_INFO_BASIC, H5P_DEFAULT) < 0)
    file_.fail("has no header", path_, "the file is damaged");
  if (here.fileno != top.fileno) {
    std::string name(size_t(std::max<ssize_t>(H5Fget_name(file, nullptr, 0), 0)) + 1, '\0');
    H5Fget_name(file, name.data(), name.size());
    name.pop_back();
    other_path_ = name;
  }
  find_storage(made, layout);
}

void Dataset::find_storage(hid_t made, H5D_layout_t layout) {
  Storage s;
  s.big_endian = big_endian_;
  s.element_size = element_size(type_);
  s.dims = dims_.empty() ? std::vector<uint64_t>{1} : dims_;
  s.file_size = file_size_;
  if (layout == H5D_CONTIGUOUS) {
    const haddr_t at = H5Dget_offset(set_);
    if (at == HADDR_UNDEF && count_ > 0) file_.fail("was never written", path_, "the file is not complete");
    s.at = at;
    if (other_path_.empty() && !s.big_endian && at % s.element_size == 0) at_ = at;
  } else if (layout == H5D_CHUNKED) {
    std::vector<hsize_t> chunk(dims_.size());
    H5Pget_chunk(made, int(chunk.size()), chunk.data());
    s.chunk.assign(chunk.begin(), chunk.end());
    for (int i = 0; i < H5Pget_nfilters(made); ++i) {
      unsigned flags = 0, config = 0, values[8] = {};
      size_t n = 8;
      const H5Z_filter_t id = H5Pget_filter2(made, unsigned(i), &flags, &n, values, 0, nullptr, &config);
      if (id != H5Z_FILTER_DEFLATE && id != H5Z_FILTER_SHUFFLE && id != H5Z_FILTER_FLETCHER32) {
        if (id < 0 || H5Zfilter_avail(id) <= 0)
          file_.fail(fmt::format("is compressed with the filter {}, which is not installed", int(id)), path_,
                     "repack it: h5repack -f GZIP=4 IN OUT");
        return;
      }
      s.filters.push_back({id, id == H5Z_FILTER_SHUFFLE && n > 0 ? values[0] : 1});
    }
    s.fill = [this, swap = s.big_endian, size = s.element_size] {
      const auto fill = guarded([&] {
        const Handle list(H5Dget_create_plist(set_));
        std::string value(size, '\0');
        if (H5Pget_fill_value(list, native_type(type_), value.data()) < 0) value.assign(size, '\0');
        return value;
      });
      if (!fill || fill->size() != size) file_.fail("has a fill value that cannot be read", path_, "the file is damaged");
      std::string value = *fill;
      if (swap) std::reverse(value.begin(), value.end());  // all is swapped at the end
      return value;
    };
  } else {
    compact_ = true;
    return;
  }
  H5Eclear2(H5E_DEFAULT);
  storage_ = std::move(s);
}

const MappedFile& Dataset::home() const {
  if (other_path_.empty()) return file_.mapped();
  if (!other_) other_.emplace(other_path_);
  return *other_;
}

void Dataset::check_backed(uint64_t bytes) const {
  if (!numeric_) file_.fail("holds no numbers of a supported type", path_, "supported: integers and floats of 1, 2, 4 or 8 bytes");
  if (bytes > backed_)
    file_.fail(fmt::format("has {} bytes, more than its stored data can give", bytes), path_, "the file is truncated or damaged");
  check_plausible(bytes, std::max(file_.size(), file_size_), file_.path());
}

std::optional<Array> Dataset::mapped(uint64_t first, uint64_t n, int components) const {
  if (!at_ || n == 0) return {};
  const size_t size = element_size(type_);
  const MappedFile& file = file_.mapped();
  uint64_t begin = 0, bytes = 0, end = 0;
  if (!multiply(first, size, begin) || !multiply(n, size, bytes) || !add(*at_, begin, begin) || !add(begin, bytes, end) ||
      end > file.size())
    file_.fail(fmt::format("has {} numbers at byte {}, beyond the end of the file", n, *at_), path_, "the file is truncated");
  return Array(Buffer{file.owner(), file.data() + begin, bytes}, type_, n / uint64_t(components), components);
}

namespace {

int component_count(uint64_t n) { return int(std::max<uint64_t>(n, 1)); }

}  // namespace

// What has filters that only the library knows, or lies in the header: at most 64 KiB, read in a child.
void Dataset::read_by_library(hid_t here, hid_t there, std::byte* out, size_t bytes) const {
  bool good = false;
  if (compact_) {
    const auto text = guarded([&] {
      std::string t(bytes, '\0');
      if (H5Dread(set_, native_type(type_), here, there, H5P_DEFAULT, t.data()) < 0) t.clear();
      return t;
    });
    good = text && text->size() == bytes;
    if (good) std::memcpy(out, text->data(), bytes);
  } else {
    good = H5Dread(set_, native_type(type_), here, there, H5P_DEFAULT, out) >= 0;
  }
  if (!good) file_.fail("cannot be read", path_, "the file is truncated or damaged");
}

Array Dataset::read(int components) const {
  if (count_ % uint64_t(components)) file_.fail(fmt::format("has {} numbers, not tuples of {}", count_, components), path_);
  uint64_t bytes = 0;
  if (!multiply(count_, element_size(type_), bytes)) bytes = UINT64_MAX;
  check_backed(bytes);
  if (auto there = mapped(0, count_, components)) return *there;
  if (!dims_.empty()) return read_block(std::vector<uint64_t>(dims_.size(), 0), dims_, std::vector<uint64_t>(dims_.size(), 1), components);
  std::byte* out = nullptr;
  Array a = Array::make_raw(type_, 1, 1, &out);
  if (storage_) read_storage(set_, *storage_, home(), {0}, {1}, {1}, out, where());
  else read_by_library(H5S_ALL, H5S_ALL, out, a.bytes());
  return a;
}

Array Dataset::read_rows(uint64_t begin, uint64_t n) const {
  uint64_t end = 0;
  if (!add(begin, n, end) || end > rows())
    file_.fail(fmt::format("has {} rows, but rows {} to {} are requested", rows(), begin, end), path_, "the file is not complete");
  if (row_size_ > 1 << 20) file_.fail(fmt::format("has rows of {} numbers", row_size_), path_);
  if (dims_.empty()) return read();
  if (auto there = mapped(begin * row_size_, n * row_size_, component_count(row_size_))) return *there;
  std::vector<uint64_t> start(dims_.size(), 0), count = dims_;
  start[0] = begin, count[0] = n;
  return read_block(start, count, std::vector<uint64_t>(dims_.size(), 1), component_count(row_size_));
}

Array Dataset::read_block(const std::vector<uint64_t>& start, const std::vector<uint64_t>& count, const std::vector<uint64_t>& stride,
                          int components) const {
  if (start.size() != dims_.size() || count.size() != dims_.size() || stride.size() != dims_.size())
    file_.fail(fmt::format("has {} dimensions, not {}", dims_.size(), start.size()), path_);
  uint64_t n = 1, bytes = 0;
  for (size_t a = 0; a < dims_.size(); ++a) {
    n *= count[a];  // at most the dataset's own count, checked here
    if (count[a] == 0) continue;
    uint64_t last = 0;
    if (stride[a] == 0 || !multiply(count[a] - 1, stride[a], last) || !add(last, start[a], last) || last >= dims_[a])
      file_.fail(fmt::format("has {} indices along dimension {}: there is no index {}", dims_[a], a, last), path_);
  }
  if (!multiply(n, element_size(type_), bytes)) bytes = UINT64_MAX;
  check_backed(bytes);
  if (n % uint64_t(components)) file_.fail(fmt::format("has {} numbers there, not tuples of {}", n, components), path_);
  std::byte* out = nullptr;
  Array a = Array::make_raw(type_, n / uint64_t(components), components, &out);
  if (n == 0) return a;
  if (dims_.empty()) return read();
  if (storage_) {
    read_storage(set_, *storage_, home(), start, count, stride, out, where());
    return a;
  }
  const std::vector<hsize_t> from(start.begin(), start.end()), step(stride.begin(), stride.end()), many(count.begin(), count.end());
  const Handle there(H5Scopy(space_));
  const hsize_t total = n;
  const Handle here(H5Screate_simple(1, &total, nullptr));
  if (H5Sselect_hyperslab(there, H5S_SELECT_SET, from.data(), step.data(), many.data(), nullptr) < 0)
    file_.fail("cannot be selected from", path_);
  read_by_library(here, there, out, a.bytes());
  return a;
}

std::vector<std::string> Dataset::strings() const {
  std::vector<std::string> r;
  if (H5Tget_class(type_in_file_) != H5T_STRING || H5Tis_variable_str(type_in_file_) > 0) return r;
  const size_t size = H5Tget_size(type_in_file_);
  uint64_t bytes = 0;
  if (!multiply(count_, size, bytes) || bytes > std::min<uint64_t>(backed_, 1 << 19)) return r;
  const auto text = guarded([&] {
    std::string t(bytes, '\0');
    if (bytes > 0 && H5Dread(set_, type_in_file_, H5S_ALL, H5S_ALL, H5P_DEFAULT, t.data()) < 0) t.clear();
    return t;
  });
  if (!text || text->size() != bytes) file_.fail("cannot be read", path_, "the file is truncated or damaged");
  for (uint64_t i = 0; i < count_; ++i) {
    const std::string_view one(text->data() + i * size, size);
    r.emplace_back(trim(one.substr(0, one.find('\0'))));
  }
  return r;
}

std::vector<uint64_t> read_counts(const File& file, const std::string& dataset, uint64_t begin, uint64_t n) {
  const Array a = Dataset(file, dataset).read_rows(begin, n).converted(ElementType::i64);
  const auto v = a.view<int64_t>();
  std::vector<uint64_t> r(a.count());
  for (size_t i = 0; i < r.size(); ++i) {
    if (v(i) < 0 || v(i) > (int64_t(1) << 60)) file.fail(fmt::format("holds the count {}", v(i)), dataset, "the file is damaged");
    r[i] = uint64_t(v(i));
  }
  return r;
}

}  // namespace sg::h5
