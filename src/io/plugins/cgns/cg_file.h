// SPDX-License-Identifier: Apache-2.0
// CgFile: the tree of a CGNS file (HDF5 or ADF) node by node. The tree is read below the library's own model of CGNS, which refuses
// files of newer versions and counts in 32 bits as Debian builds it (cgsize_t is int).
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "data/array.h"

namespace sg::cg {

/// One node: name, label ("Zone_t"), data type ("R8", "MT" = none), dimensions (fastest first).
struct Node {
  double id = 0;
  std::string name, label, type;
  std::vector<size_t> dims;
  std::string path;  ///< for messages: "/Base/Zone 1"

  size_t count() const;  ///< 0 without data
};

/// An open file; read only. Not thread-safe.
class CgFile {
 public:
  /// Throws Error(data) naming the file.
  explicit CgFile(const std::string& path);
  ~CgFile();
  CgFile(const CgFile&) = delete;
  CgFile& operator=(const CgFile&) = delete;

  const std::string& path() const { return path_; }
  const Node& root() const { return root_; }
  std::vector<Node> children(const Node& node) const;
  std::vector<Node> children(const Node& node, std::string_view label) const;
  /// The first child of that name, of that label; empty path when there is none.
  static const Node* named(const std::vector<Node>& nodes, std::string_view name);
  static const Node* labelled(const std::vector<Node>& nodes, std::string_view label);

  /// The type of the node's numbers. Throws Error(data) when it holds none.
  ElementType number_type(const Node& node) const;
  /// All numbers, packed, in the node's own type. Throws Error(data) when it holds none or more than the file can back.
  Array numbers(const Node& node) const;
  /// The same as 64-bit integers.
  std::vector<int64_t> integers(const Node& node) const;
  /// Text, trimmed; "" when it holds none.
  std::string text(const Node& node) const;
  /// Rows of 32 (or dims[0]) characters, each trimmed.
  std::vector<std::string> names(const Node& node) const;

  [[noreturn]] void fail(const std::string& problem, const Node& node, std::string hint = {}) const;

 private:
  Node node_of(double id, const std::string& parent) const;
  std::vector<char> bytes(const Node& node) const;
  void check_size(const Node& node, size_t element) const;
  std::string path_;
  size_t file_size_ = 0;
  bool hdf5_ = false;
  void check_link(const Node& node, double id) const;
  mutable bool links_ = false;  // data may be in other files
  int file_ = -1;
  Node root_;
};

}  // namespace sg::cg
