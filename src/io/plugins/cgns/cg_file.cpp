// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/cgns/cg_file.h"

#include <cgns_io.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"

namespace sg::cg {

namespace {

constexpr uint64_t small_array = 1 << 20;
constexpr uint64_t most_packing = 1100;  // HDF5 may be compressed; deflate makes at most about a thousand of one

std::string message() {
  char text[1024] = {};
  cgio_error_message(text);
  return std::string(trim(text));
}

size_t element_bytes(std::string_view type) {
  if (type == "C1" || type == "B1" || type == "U1" || type == "I1") return 1;
  if (type == "I4" || type == "U4" || type == "R4") return 4;
  if (type == "I8" || type == "U8" || type == "R8") return 8;
  return 0;
}

}  // namespace

size_t Node::count() const {
  uint64_t n = 1;
  if (dims.empty()) return 0;
  for (const size_t d : dims)
    if (!multiply(n, d, n)) return SIZE_MAX;
  return n;
}

CgFile::CgFile(const std::string& path) : path_(path) {
  {
    const MappedFile file(path);
    file_size_ = file.size();
    hdf5_ = file.text().starts_with("\x89HDF");
  }
  int type = CGIO_FILE_NONE;
  if (cgio_check_file(path.c_str(), &type) != CGIO_ERR_NONE)
    fail_data(fmt::format("is not a CGNS file: {}", message()), path, "it may be truncated or damaged");
  if (cgio_open_file(path.c_str(), CGIO_MODE_READ, type, &file_) != CGIO_ERR_NONE)
    fail_data(fmt::format("cannot be opened: {}", message()), path, "it may be truncated or damaged");
  double id = 0;
  if (cgio_get_root_id(file_, &id) != CGIO_ERR_NONE) {
    const std::string why = message();
    cgio_close_file(file_);
    fail_data(fmt::format("has no node tree: {}", why), path);
  }
  root_.id = id;
}

CgFile::~CgFile() { cgio_close_file(file_); }

void CgFile::fail(const std::string& problem, const Node& node, std::string hint) const {
  fail_data(problem, fmt::format("{}: {}", path_, node.path.empty() ? "/" : node.path), std::move(hint));
}

Node CgFile::node_of(double id, const std::string& parent) const {
  Node n;
  n.id = id;
  n.path = parent;
  // Longer than the library promises: a damaged ADF file has types of 32 characters.
  char name[128] = {}, label[128] = {}, type[128] = {};
  if (cgio_get_name(file_, id, name) != CGIO_ERR_NONE) fail(fmt::format("cannot read the name of a node: {}", message()), n);
  n.name = name;
  n.path = parent + "/" + n.name;
  if (cgio_get_label(file_, id, label) != CGIO_ERR_NONE || cgio_get_data_type(file_, id, type) != CGIO_ERR_NONE)
    fail(fmt::format("cannot be read: {}", message()), n);
  n.label = label;
  n.type = type;
  if (n.type == "MT" || n.type == "LK") return n;
  int rank = 0;
  cgsize_t dims[CGIO_MAX_DIMENSIONS + 1] = {};
  if (cgio_get_dimensions(file_, id, &rank, dims) != CGIO_ERR_NONE) fail(fmt::format("its size cannot be read: {}", message()), n);
  for (int k = 0; k < std::min(rank, CGIO_MAX_DIMENSIONS); ++k) {
    if (dims[k] < 0) fail(fmt::format("has a size of {}", dims[k]), n, "sizes of 2^31 and more are not supported");
    n.dims.push_back(size_t(dims[k]));
  }
  return n;
}

// Before the library follows it: the file has to lie where files may name others, and to be one.
void CgFile::check_link(const Node& node, double id) const {
  int file_length = 0, name_length = 0;
  if (cgio_link_size(file_, id, &file_length, &name_length) != CGIO_ERR_NONE || file_length > 4096 || name_length > 4096)
    fail(fmt::format("has a link that cannot be read: {}", message()), node);
  std::string file(8192, '\0'), name(8192, '\0');
  if (cgio_get_link(file_, id, file.data(), name.data()) != CGIO_ERR_NONE)
    fail(fmt::format("has a link that cannot be read: {}", message()), node);
  file.resize(std::strlen(file.c_str()));
  if (file.empty()) return;  // within this file
  const std::string beside = named_file(path_, file);
  for (const std::string& path : {beside, file})
    if (file_exists(path) && !is_plain_file(path)) fail(fmt::format("links to '{}', which is not a file", file), node);
}

std::vector<Node> CgFile::children(const Node& node) const {
  int n = 0;
  if (cgio_number_children(file_, node.id, &n) != CGIO_ERR_NONE) fail(fmt::format("its parts cannot be counted: {}", message()), node);
  if (n <= 0) return {};
  if (size_t(n) > file_size_) fail(fmt::format("has {} parts, more than the file can hold", n), node);
  std::vector<double> ids(size_t(n), 0.0);
  int got = 0;
  if (cgio_children_ids(file_, node.id, 1, n, &got, ids.data()) != CGIO_ERR_NONE)
    fail(fmt::format("its parts cannot be read: {}", message()), node);
  std::vector<Node> nodes;
  for (int i = 0; i < std::min(got, n); ++i) {
    int length = 0;
    if (cgio_is_link(file_, ids[size_t(i)], &length) == CGIO_ERR_NONE && length > 0) links_ = true, check_link(node, ids[size_t(i)]);
    nodes.push_back(node_of(ids[size_t(i)], node.path));
  }
  return nodes;
}

std::vector<Node> CgFile::children(const Node& node, std::string_view label) const {
  std::vector<Node> all = children(node);
  std::erase_if(all, [&](const Node& n) { return n.label != label; });
  return all;
}

const Node* CgFile::named(const std::vector<Node>& nodes, std::string_view name) {
  for (const Node& n : nodes)
    if (n.name == name) return &n;
  return nullptr;
}

const Node* CgFile::labelled(const std::vector<Node>& nodes, std::string_view label) {
  for (const Node& n : nodes)
    if (n.label == label) return &n;
  return nullptr;
}

void CgFile::check_size(const Node& node, size_t element) const {
  uint64_t bytes = 0;
  const uint64_t backed = links_ ? uint64_t(1) << 40 : std::max<uint64_t>(small_array, hdf5_ ? file_size_ * most_packing : file_size_);
  if (!multiply(node.count(), element, bytes) || bytes > backed)
    fail(fmt::format("{} numbers are more than a file of {} bytes can hold", node.count(), file_size_), node);
}

ElementType CgFile::number_type(const Node& node) const {
  const ElementType type = node.type == "I4"                        ? ElementType::i32
                           : node.type == "I8"                      ? ElementType::i64
                           : node.type == "U4"                      ? ElementType::u32
                           : node.type == "U8"                      ? ElementType::u64
                           : node.type == "R4"                      ? ElementType::f32
                           : node.type == "R8"                      ? ElementType::f64
                           : node.type == "B1" || node.type == "U1" ? ElementType::u8
                           : node.type == "I1"                      ? ElementType::i8
                                                                    : ElementType::u16;
  if (type == ElementType::u16) fail(fmt::format("holds no numbers (data type '{}')", node.type), node);
  return type;
}

Array CgFile::numbers(const Node& node) const {
  const ElementType type = number_type(node);
  check_size(node, element_size(type));
  std::byte* out = nullptr;
  Array a = Array::make_raw(type, node.count(), 1, &out);
  if (a.count() > 0 && cgio_read_all_data(file_, node.id, out) != CGIO_ERR_NONE) fail(fmt::format("cannot be read: {}", message()), node);
  return a;
}

std::vector<int64_t> CgFile::integers(const Node& node) const {
  const Array stored = numbers(node);
  if (is_float(stored.type())) fail("holds no integers", node);
  const Array a = stored.converted(ElementType::i64);
  const int64_t* p = a.view<int64_t>().data;
  return {p, p + a.count()};
}

std::vector<char> CgFile::bytes(const Node& node) const {
  if (element_bytes(node.type) != 1) return {};
  check_size(node, 1);
  std::vector<char> text(node.count() + 1, '\0');
  if (node.count() > 0 && cgio_read_all_data(file_, node.id, text.data()) != CGIO_ERR_NONE)
    fail(fmt::format("cannot be read: {}", message()), node);
  text.pop_back();
  return text;
}

std::string CgFile::text(const Node& node) const {
  const std::vector<char> b = bytes(node);
  return std::string(trim(std::string_view(b.data(), size_t(std::find(b.begin(), b.end(), '\0') - b.begin()))));
}

std::vector<std::string> CgFile::names(const Node& node) const {
  const std::vector<char> b = bytes(node);
  std::vector<std::string> rows;
  const size_t width = node.dims.empty() ? 0 : node.dims[0];
  for (size_t at = 0; width > 0 && at + width <= b.size(); at += width) {
    const char* row = b.data() + at;
    rows.emplace_back(trim(std::string_view(row, size_t(std::find(row, row + width, '\0') - row))));
  }
  return rows;
}

}  // namespace sg::cg
