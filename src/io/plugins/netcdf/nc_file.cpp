// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/netcdf/nc_file.h"

#include <fmt/core.h>

#include <algorithm>

#ifdef SG_QUIET_HDF5
#include <hdf5.h>
#endif
#include <netcdf.h>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/text/text.h"

namespace sg::nc {

namespace {

// HDF5 compresses constant data about a thousandfold; more than that no file backs.
constexpr uint64_t most_packing = 1100;
constexpr uint64_t small_array = 1 << 20;
constexpr int most_objects = 1 << 20;

std::optional<ElementType> element_of(int type) {
  switch (type) {
    case NC_BYTE: return ElementType::i8;
    case NC_UBYTE: return ElementType::u8;
    case NC_SHORT: return ElementType::i16;
    case NC_USHORT: return ElementType::u16;
    case NC_INT: return ElementType::i32;
    case NC_UINT: return ElementType::u32;
    case NC_INT64: return ElementType::i64;
    case NC_UINT64: return ElementType::u64;
    case NC_FLOAT: return ElementType::f32;
    case NC_DOUBLE: return ElementType::f64;
    default: return {};
  }
}

int get_part(int file, int v, const size_t* start, const size_t* count, ElementType type, std::byte* out) {
  void* p = out;
  switch (type) {
    case ElementType::u8: return nc_get_vara_uchar(file, v, start, count, static_cast<unsigned char*>(p));
    case ElementType::i8: return nc_get_vara_schar(file, v, start, count, static_cast<signed char*>(p));
    case ElementType::u16: return nc_get_vara_ushort(file, v, start, count, static_cast<unsigned short*>(p));
    case ElementType::i16: return nc_get_vara_short(file, v, start, count, static_cast<short*>(p));
    case ElementType::u32: return nc_get_vara_uint(file, v, start, count, static_cast<unsigned*>(p));
    case ElementType::i32: return nc_get_vara_int(file, v, start, count, static_cast<int*>(p));
    case ElementType::u64: return nc_get_vara_ulonglong(file, v, start, count, static_cast<unsigned long long*>(p));
    case ElementType::i64: return nc_get_vara_longlong(file, v, start, count, static_cast<long long*>(p));
    case ElementType::f32: return nc_get_vara_float(file, v, start, count, static_cast<float*>(p));
    case ElementType::f64: return nc_get_vara_double(file, v, start, count, static_cast<double*>(p));
  }
  return NC_EBADTYPE;
}

std::string until_zero(std::string_view s) { return std::string(trim(s.substr(0, std::min(s.size(), s.find('\0'))))); }

}  // namespace

bool Variable::is_text() const { return type == NC_CHAR; }
bool Variable::is_number() const { return element_of(type).has_value(); }
ElementType Variable::element() const { return *element_of(type); }

size_t Variable::count() const {
  uint64_t n = 1;
  for (const size_t s : shape)
    if (!multiply(n, s, n)) return SIZE_MAX;
  return n;
}

NcFile::NcFile(const std::string& path) : path_(path) {
#ifdef SG_QUIET_HDF5
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // belongs to the thread; the library reports only the first one
#endif
  check_classic(path);
  {
    const MappedFile file(path);
    file_size_ = file.size();
    packed_ = !file.text().starts_with("CDF");
  }
  // A name with "://" would be fetched from the network.
  if (path.find("://") != std::string::npos) fail("is a web address", {}, "give the path of a file");
  if (const int e = nc_open(path.c_str(), NC_NOWRITE, &id_); e != NC_NOERR) fail(fmt::format("cannot be opened: {}", nc_strerror(e)));
  try {
    inquire();
  } catch (...) {
    nc_close(id_);
    throw;
  }
}

NcFile::~NcFile() { nc_close(id_); }

void NcFile::fail(const std::string& problem, std::string_view variable, std::string hint) const {
  fail_data(problem, variable.empty() ? path_ : fmt::format("{}: variable {}", path_, variable), std::move(hint));
}

void NcFile::inquire() {
  const auto check = [&](int e) {
    if (e != NC_NOERR) fail(fmt::format("its header cannot be read: {}", nc_strerror(e)));
  };
  int dims = 0, variables = 0;
  check(nc_inq_ndims(id_, &dims));
  check(nc_inq_nvars(id_, &variables));
  if (dims < 0 || dims > most_objects || variables < 0 || variables > most_objects) fail("has too many dimensions or variables");
  // The numbers of the dimensions of a netCDF-4 file need not be 0, 1, 2, ...
  std::vector<int> ids(size_t(dims) + 1), unlimited;
  check(nc_inq_dimids(id_, &dims, ids.data(), 0));
  ids.resize(size_t(dims));
  int n = 0;
  check(nc_inq_unlimdims(id_, &n, nullptr));
  unlimited.resize(size_t(std::max(n, 0)) + 1, -1);
  check(nc_inq_unlimdims(id_, &n, unlimited.data()));
  char name[NC_MAX_NAME + 1] = {};
  for (const int d : ids) {
    size_t length = 0;
    check(nc_inq_dim(id_, d, name, &length));
    dims_.push_back(
        {name, length, std::find(unlimited.begin(), unlimited.begin() + std::max(n, 0), d) != unlimited.begin() + std::max(n, 0)});
  }
  for (int v = 0; v < variables; ++v) {
    Variable one;
    one.id = v;
    int rank = 0;
    check(nc_inq_varndims(id_, v, &rank));
    if (rank < 0 || rank > NC_MAX_VAR_DIMS) fail(fmt::format("a variable has {} dimensions", rank));
    std::vector<int> of(size_t(rank) + 1);
    check(nc_inq_var(id_, v, name, &one.type, nullptr, of.data(), nullptr));
    one.name = name;
    for (int k = 0; k < rank; ++k) {
      const auto at = std::find(ids.begin(), ids.end(), of[size_t(k)]);
      if (at == ids.end()) fail("has a dimension that is not in its group", one.name);
      one.dims.push_back(int(at - ids.begin()));
      one.shape.push_back(dims_[size_t(one.dims.back())].length);
    }
    variables_.push_back(std::move(one));
  }
}

const Variable* NcFile::find(std::string_view name) const {
  for (const Variable& v : variables_)
    if (v.name == name) return &v;
  return nullptr;
}

const Variable& NcFile::require(std::string_view name) const {
  if (const Variable* v = find(name)) return *v;
  fail(fmt::format("has no variable '{}'", name));
}

std::optional<size_t> NcFile::dim(std::string_view name) const {
  for (const Dimension& d : dims_)
    if (d.name == name) return d.length;
  return {};
}

bool NcFile::has_group(const char* name) const {
  int group = 0;
  return packed_ && nc_inq_grp_ncid(id_, name, &group) == NC_NOERR;
}

std::string NcFile::text(const Variable* v, const char* name) const {
  const int id = v ? v->id : NC_GLOBAL;
  int type = 0;
  size_t n = 0;
  if (std::string_view(name) == "units" && nc_inq_att(id_, id, name, &type, &n) != NC_NOERR)
    for (const char* other : {"Unit", "Units", "unit"})  // not according to CF, but written by some programs
      if (nc_inq_att(id_, id, other, &type, &n) == NC_NOERR) name = other;
  if (nc_inq_att(id_, id, name, &type, &n) != NC_NOERR || n == 0 || n > file_size_ * most_packing) return {};
  if (type == NC_CHAR) {
    std::string s(n, '\0');
    if (nc_get_att_text(id_, id, name, s.data()) != NC_NOERR) return {};
    return until_zero(s);
  }
  if (type == NC_STRING) {
    std::vector<char*> parts(n, nullptr);
    if (nc_get_att_string(id_, id, name, parts.data()) != NC_NOERR) return {};
    std::string s = parts[0] ? parts[0] : "";
    nc_free_string(n, parts.data());
    return std::string(trim(s));
  }
  return {};
}

std::vector<std::string> NcFile::words(const Variable* v, const char* name) const {
  const std::string all = text(v, name);
  const std::vector<std::string_view> parts = sg::words(all);
  return {parts.begin(), parts.end()};
}

std::vector<double> NcFile::numbers(const Variable* v, const char* name) const {
  const int id = v ? v->id : NC_GLOBAL;
  int type = 0;
  size_t n = 0;
  if (nc_inq_att(id_, id, name, &type, &n) != NC_NOERR || n == 0 || n > small_array || !element_of(type)) return {};
  std::vector<double> r(n);
  if (nc_get_att_double(id_, id, name, r.data()) != NC_NOERR) return {};
  return r;
}

std::optional<double> NcFile::number(const Variable* v, const char* name) const {
  const std::vector<double> n = numbers(v, name);
  return n.empty() ? std::optional<double>() : n[0];
}

uint64_t NcFile::most_bytes() const { return std::max<uint64_t>(small_array, packed_ ? file_size_ * most_packing : file_size_); }

void NcFile::check_backed(const Variable& v) const {
  uint64_t bytes = 0;
  if (v.is_number() && (!multiply(v.count(), element_size(v.element()), bytes) || bytes > most_bytes()))
    fail(fmt::format("{} numbers are more than a file of {} bytes can hold", v.count(), file_size_), v.name);
}

Array NcFile::read(const Variable& v, const std::vector<size_t>& start, const std::vector<size_t>& count, ElementType type) const {
  if (!v.is_number()) fail("holds no numbers", v.name);
  uint64_t n = 1, bytes = 0;
  for (size_t k = 0; k < v.shape.size(); ++k) {
    if (count[k] > v.shape[k] || start[k] > v.shape[k] - count[k])
      fail(fmt::format("numbers {}..{} of dimension {} are requested, which has {}", start[k], start[k] + count[k], k, v.shape[k]), v.name);
    if (!multiply(n, count[k], n)) fail("has more numbers than can be counted", v.name);
  }
  if (!multiply(n, element_size(v.element()), bytes) || bytes > most_bytes())
    fail(fmt::format("{} numbers are more than a file of {} bytes can hold", n, file_size_), v.name);
  std::byte* out = nullptr;
  Array a = Array::make_raw(type, n, 1, &out);
  if (n == 0) return a;
  const size_t zero = 0;
  const int e = get_part(id_, v.id, start.empty() ? &zero : start.data(), count.empty() ? &zero : count.data(), type, out);
  if (e == NC_ERANGE) fail(fmt::format("has a number that is not a valid {}", element_name(type)), v.name);
  if (e != NC_NOERR) fail(fmt::format("cannot be read: {}", nc_strerror(e)), v.name);
  return a;
}

std::vector<double> NcFile::doubles(const Variable& v) const {
  const Array a = read(v, ElementType::f64);
  const double* p = a.view<double>().data;
  return {p, p + a.count()};
}

std::vector<std::string> NcFile::strings(const Variable& v) const {
  if (!v.is_text()) fail("contains no text", v.name);
  if (v.shape.empty()) return {};
  const size_t n = v.count(), width = v.shape.back();
  if (n > most_bytes()) fail("is larger than the file", v.name);
  std::string all(n, '\0');
  if (n > 0)
    if (const int e = nc_get_var_text(id_, v.id, all.data()); e != NC_NOERR)
      fail(fmt::format("cannot be read: {}", nc_strerror(e)), v.name);
  std::vector<std::string> rows;
  for (size_t at = 0; width > 0 && at < n; at += width) rows.push_back(until_zero(std::string_view(all).substr(at, width)));
  return rows;
}

}  // namespace sg::nc
