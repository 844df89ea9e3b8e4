// SPDX-License-Identifier: Apache-2.0
// Gaussian cube: two lines of title, atoms, and numbers on a grid (its third axis fastest) whose axes may be skewed. Lengths are in
// Bohr, in Angstrom where the counts of the grid are negative. A negative number of atoms means that orbitals follow, several numbers per
// point. Gives two parts, "grid" and "atoms".
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/text/text_scan.h"
#include "io/volume/brick.h"
#include "io/volume/direction.h"
#include "io/volume/lattice_part.h"

namespace sg {

namespace {

struct Lines {
  const MappedFile& file;
  size_t at = 0, number = 0;

  std::string_view next() {
    if (at >= file.size()) fail_data(fmt::format("ends after line {}, inside its header", number), file.path());
    const char* p = file.text().data() + at;
    const char* e = line_end(p, file.text().data() + file.size());
    at = std::min(file.size(), size_t(e - file.text().data()) + 1);
    ++number;
    return trim({p, std::min<size_t>(size_t(e - p), 4096)});
  }
  std::vector<double> numbers(size_t least, const char* what) {
    std::vector<double> r;
    for (std::string_view w : words(next())) {
      const auto v = parse_double(w);
      if (!v || !std::isfinite(*v)) fail_data(fmt::format("line {}: '{}' is not a number", number, w.substr(0, 40)), file.path());
      r.push_back(*v);
    }
    if (r.size() < least) fail_data(fmt::format("line {}: {} numbers are needed: {}", number, least, what), file.path());
    return r;
  }
  int64_t whole(double v) const {
    if (v != std::floor(v) || std::abs(v) > 1e9) fail_data(fmt::format("line {}: '{}' is not a valid count", number, v), file.path());
    return int64_t(v);
  }
};

DatasetPtr atoms_of(Lines& in, size_t count, const std::string& unit) {
  if (count > (in.file.size() - in.at) / 10)
    fail_data(fmt::format("{} atoms do not fit into {} bytes", count, in.file.size()), in.file.path());
  std::vector<double> xyz;
  std::vector<int32_t> z;
  std::vector<double> charge;
  for (size_t i = 0; i < count; ++i) {
    const auto v = in.numbers(5, "atomic number, charge, x, y, z");
    z.push_back(int32_t(in.whole(v[0])));
    charge.push_back(v[1]);
    xyz.insert(xyz.end(), v.begin() + 2, v.begin() + 5);
  }
  DatasetParts p;
  p.mesh = PointCloud{{Array::from_vector(std::move(xyz), 3), {}}};
  p.fields.add({"atomic number", Association::point, Array::from_vector(std::move(z)), "", Role::scalars});
  p.fields.add({"charge", Association::point, Array::from_vector(std::move(charge)), "", Role::none});
  p.notes.emplace_back("length unit", unit);
  return make_dataset(std::move(p));
}

// The file's order is z fastest, ours x.
Array x_first(const Array& stored, const std::array<size_t, 3>& n, const LatticePart& part) {
  const auto v = stored.view<float>();
  const size_t c = size_t(v.components);
  float* out = nullptr;
  Array a = Array::make<float>(part.points(), v.components, &out);
  parallel_for(part.count[1] * part.count[2], std::max<size_t>(1, (1 << 14) / part.count[0]), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = part.lo[1] + row % part.count[1] * part.stride[1], k = part.lo[2] + row / part.count[1] * part.stride[2];
      float* to = out + row * part.count[0] * c;
      for (size_t i = 0; i < part.count[0]; ++i) {
        const size_t x = part.lo[0] + i * part.stride[0];
        for (size_t m = 0; m < c; ++m) *to++ = v.data[(k + n[2] * (j + n[1] * x)) * c + m];
      }
    }
  });
  return a;
}

}  // namespace

Data read_cube(const std::string& path, const ReadOptions& options, Context&) {
  const MappedFile file(path);
  Lines in{file};
  const std::string title(in.next()), name(in.next());
  const auto first = in.numbers(4, "number of atoms, origin");
  const int64_t atom_count = in.whole(first[0]);
  size_t components = first.size() > 4 ? size_t(std::max<int64_t>(in.whole(first[4]), 1)) : 1;
  UniformGrid grid;
  grid.origin = {first[1], first[2], first[3]};
  Vec3 axes[3];
  bool angstrom = false;
  for (size_t a = 0; a < 3; ++a) {
    const auto v = in.numbers(4, "points along an axis, step x, y, z");
    const int64_t n = in.whole(v[0]);
    if (n == 0) fail_data(fmt::format("line {}: there are no points along this axis", in.number), path);
    angstrom = angstrom || n < 0;
    grid.dims[a] = size_t(std::abs(n));
    axes[a] = {v[1], v[2], v[3]};
    grid.spacing[int(a)] = length(axes[a]);
  }
  grid.direction = direction_of(axes, 3, path);
  const std::string unit = angstrom ? "angstrom" : "bohr";
  const DatasetPtr atoms = atoms_of(in, size_t(std::abs(atom_count)), unit);
  std::string orbitals;
  if (atom_count < 0) {
    // How many orbitals, and their numbers, over as many lines as it takes.
    auto v = in.numbers(1, "number of orbitals");
    const int64_t n = in.whole(v[0]);
    if (n < 1 || n > 100000) fail_data(fmt::format("line {}: {} orbitals", in.number, n), path);
    while (v.size() < size_t(n) + 1) {
      const auto more = in.numbers(1, "numbers of orbitals");
      v.insert(v.end(), more.begin(), more.end());
    }
    components = size_t(n);
    for (size_t i = 1; i <= components; ++i) orbitals += fmt::format("{}{}", i > 1 ? " " : "", v[i]);
  }
  const size_t points = checked_product({grid.dims[0], grid.dims[1], grid.dims[2]}, path);
  const std::string_view text = file.text().substr(in.at);
  uint64_t numbers = 0;
  if (components > 100000 || !multiply(points, components, numbers) || text.size() / 2 + 1 < numbers)
    fail_data(fmt::format("{} bytes of text cannot hold {} x {} numbers", text.size(), points, components), path);

  const std::array<size_t, 3> dims = grid.dims;
  const LatticePart part = cut_grid(grid, options.region);
  DatasetParts out;
  out.mesh = grid;
  if (!title.empty()) out.notes.emplace_back("title", title);
  out.notes.emplace_back("length unit", unit);
  if (!orbitals.empty()) out.notes.emplace_back("orbitals", orbitals);
  if (!options.header_only) {
    const Array stored = parse_numbers(text, ElementType::f32, points, int(components), path, in.number);
    out.fields.add({name.empty() ? "values" : name, Association::point, x_first(stored, dims, part), "", Role::scalars});
  }
  Collection c;
  c.parts.push_back({"grid", make_dataset(std::move(out))});
  if (atom_count != 0) c.parts.push_back({"atoms", atoms});
  return std::make_shared<const Collection>(std::move(c));
}

}  // namespace sg
