// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/packets/cache_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sg::volume {

namespace {

constexpr size_t page = 4096, ways = 8;  // the fewest that processors with wide vectors have
constexpr float most_rows = 64;          // rays farther apart than that have no rows in common

size_t divided_up(size_t n, size_t by) { return (n + by - 1) / by; }

}  // namespace

size_t rows_on_one_line(size_t rows, size_t layers, size_t row_bytes, size_t layer_bytes) {
  return divided_up(rows, page / std::gcd(row_bytes, page)) * divided_up(layers, page / std::gcd(layer_bytes, page));
}

bool crowded(const Voxels& voxels, const RayPacket& rays, int width, int lanes) {
  const auto n = size_t(std::max_element(rays.length, rays.length + lanes) - rays.length);
  const double middle = 0.5 * (rays.enter[n] + rays.leave[n]);
  const auto place = [&](int axis, int lane) { return rays.entry[axis][lane] + rays.along[axis][lane] * float(middle - rays.enter[lane]); };
  // Both diagonals of the packet, and the two rows of a cell.
  const auto count = [&](int axis) {
    const float spread =
        std::max(std::abs(place(axis, lanes - 1) - place(axis, 0)), std::abs(place(axis, lanes - width) - place(axis, width - 1)));
    return size_t(std::min(most_rows, std::ceil(spread))) + 2;
  };
  const size_t row_bytes = voxels.array.bytes() / std::max<size_t>(voxels.array.count(), 1) * voxels.dims[0];
  return rows_on_one_line(count(1), count(2), row_bytes, row_bytes * voxels.dims[1]) > ways;
}

}  // namespace sg::volume
