// SPDX-License-Identifier: Apache-2.0
// The library registers these grids, so it holds all of their members; compiled here again they take most of a minute. Only where that is
// known to link: another version may hold fewer members, another compiler may inline fewer.
#pragma once
#include <openvdb/openvdb.h>

#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER == 10 && defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && !defined(__clang__) && \
    __GNUC__ == 12

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

// The levels of openvdb::tree::Tree4<T, 5, 4, 3>::Type, from the leaves up.
#define SG_HELD_GRID(T)                                                                                                 \
  extern template class tree::LeafNode<T, 3>;                                                                           \
  extern template class tree::InternalNode<tree::LeafNode<T, 3>, 4>;                                                    \
  extern template class tree::InternalNode<tree::InternalNode<tree::LeafNode<T, 3>, 4>, 5>;                             \
  extern template class tree::RootNode<tree::InternalNode<tree::InternalNode<tree::LeafNode<T, 3>, 4>, 5>>;             \
  extern template class tree::Tree<tree::RootNode<tree::InternalNode<tree::InternalNode<tree::LeafNode<T, 3>, 4>, 5>>>; \
  extern template class Grid<tree::Tree<tree::RootNode<tree::InternalNode<tree::InternalNode<tree::LeafNode<T, 3>, 4>, 5>>>>;

SG_HELD_GRID(float)
SG_HELD_GRID(double)
SG_HELD_GRID(int32_t)
SG_HELD_GRID(int64_t)
SG_HELD_GRID(Vec3s)
SG_HELD_GRID(Vec3d)
#undef SG_HELD_GRID

}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb

#endif
