// SPDX-License-Identifier: Apache-2.0
// The classic netCDF header, walked once: the library takes zeros for what a cut file lacks, and believes every count.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "io/plugins/netcdf/nc_file.h"

namespace sg::nc {

namespace {

// Layout (netCDF classic format specification): magic, numrecs, dim_list, att_list, var_list; counts are 4 bytes, 8 in CDF-5; big endian.
class Header {
 public:
  explicit Header(const MappedFile& file)
      : file_(file), wide_(file.data()[3] == std::byte{5}), long_offsets_(file.data()[3] != std::byte{1}) {}

  void check() {
    at_ = 4;
    const uint64_t records = count();
    list(10, "dimensions", [&] {
      name();
      lengths_.push_back(count());
    });
    attributes();
    list(11, "variables", [&] { variable(); });
    check_extent(records);
  }

 private:
  static constexpr uint64_t longest_name = 256;  // NC_MAX_NAME

  struct Extent {
    std::string name;
    uint64_t begin, bytes;
    bool record;
  };

  [[noreturn]] void fail(const std::string& problem) const {
    fail_data(problem, fmt::format("{}: byte {}", file_.path(), at_), "the file is truncated or damaged");
  }
  void need(uint64_t bytes) const {
    if (bytes > file_.size() - at_) fail("the netCDF header ends too early");
  }
  template <class T>
  T take() {
    need(sizeof(T));
    const T v = load<T>(file_.data() + at_, true);
    at_ += sizeof(T);
    return v;
  }
  uint64_t count() { return wide_ ? take<uint64_t>() : take<uint32_t>(); }
  std::string name() {
    const uint64_t n = count();
    if (n > longest_name) fail(fmt::format("a name has {} bytes; {} are allowed", n, longest_name));  // the library copies without a look
    need(n);
    std::string s(file_.text().substr(at_, n));
    skip(n);
    return s;
  }
  void skip(uint64_t bytes) {
    need(bytes);
    at_ += std::min<size_t>((bytes + 3) / 4 * 4, file_.size() - at_);
  }
  template <class F>
  void list(uint32_t tag, const char* what, F&& entry) {
    const uint32_t found = take<uint32_t>();
    const uint64_t n = count();
    if (found != tag && !(found == 0 && n == 0)) fail(fmt::format("expected the list of {} here", what));
    if (n > (file_.size() - at_) / 8) fail(fmt::format("{} {} are more than the file can hold", n, what));
    for (uint64_t i = 0; i < n; ++i) entry();
  }
  static uint64_t size_of(uint32_t type) {
    constexpr uint64_t bytes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < 12 ? bytes[type] : 0;
  }
  void attributes() {
    list(12, "attributes", [&] {
      name();
      const uint64_t each = size_of(take<uint32_t>()), n = count();
      uint64_t bytes = 0;
      if (each == 0 || !multiply(each, n, bytes)) fail("an attribute has an unknown type");
      skip(bytes);
    });
  }
  void variable() {
    Extent e{name(), 0, 1, false};
    const uint64_t rank = count();
    if (rank > (file_.size() - at_) / 4) fail(fmt::format("variable {} has {} dimensions", e.name, rank));
    bool counted = true;
    for (uint64_t k = 0; k < rank; ++k) {
      const uint64_t d = count();
      if (d >= lengths_.size()) fail(fmt::format("variable {} has the dimension {} of {}", e.name, d, lengths_.size()));
      if (lengths_[d] == 0 && k == 0) e.record = true;
      else counted = counted && multiply(e.bytes, lengths_[d], e.bytes);
    }
    attributes();
    const uint64_t each = size_of(take<uint32_t>());
    if (each == 0) fail(fmt::format("variable {} has an unknown type", e.name));
    count();  // vsize: what follows from the dimensions is believed instead
    e.begin = long_offsets_ ? take<uint64_t>() : take<uint32_t>();
    if (!counted || !multiply(e.bytes, each, e.bytes)) fail(fmt::format("variable {} has too many numbers to count", e.name));
    extents_.push_back(std::move(e));
  }
  void check_extent(uint64_t records) const {
    uint64_t record_bytes = 0;
    size_t record_variables = 0;
    for (const Extent& e : extents_)
      if (e.record) {
        ++record_variables;
        if (!add(record_bytes, (e.bytes + 3) / 4 * 4, record_bytes)) fail("a record has too many bytes to count");
      }
    for (const Extent& e : extents_) {
      uint64_t end = 0, before = 0;
      if (e.record && records == 0) continue;
      if (e.record && record_variables == 1) record_bytes = e.bytes;  // a lone record variable is not padded
      if (e.record && !multiply(records - 1, record_bytes, before)) fail(fmt::format("{} records are too many to count", records));
      if (!add(e.begin, before, end) || !add(end, e.bytes, end) || end > file_.size())
        fail_data(fmt::format("variable {} ends at byte {}, but the file at byte {}", e.name, end, file_.size()), file_.path(),
                  "the file is truncated or damaged");
    }
  }

  const MappedFile& file_;
  bool wide_, long_offsets_;
  size_t at_ = 0;
  std::vector<uint64_t> lengths_;
  std::vector<Extent> extents_;
};

}  // namespace

void check_classic(const std::string& path) {
  const MappedFile file(path);
  if (!file.text().starts_with("CDF") || file.size() < 4) return;
  const auto version = int(file.data()[3]);
  if (version != 1 && version != 2 && version != 5) fail_data(fmt::format("is netCDF of the unknown version {}", version), path);
  Header(file).check();
}

}  // namespace sg::nc
