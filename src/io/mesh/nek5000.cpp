// SPDX-License-Identifier: Apache-2.0
// nek5000: a small text file (.nek5000) that names binary files, one per step (or one per step and writer): spectral elements of
// nx x ny (x nz) values at the Gauss-Lobatto points. The points stay where they are, so that values are those of the file; each element
// becomes (nx-1)(ny-1)(nz-1) linear cells with its number in "element". Elements share no points: fields may jump between them. Steps
// without positions take those of the first step. Source: the Nek5000 documentation, "Field files", and the files.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/text/mesh_text.h"

namespace sg {

namespace {

struct NekHeader {
  int word = 4;
  std::array<size_t, 3> n{1, 1, 1};
  size_t elements = 0;  ///< in this file
  double time = 0;
  size_t files = 1;
  std::string content;  ///< "XUPTS03"
  bool big_endian = false;
  size_t begin = 0;  ///< of the element numbers
  size_t nodes() const { return n[0] * n[1] * n[2]; }
  size_t dimension() const { return n[2] > 1 ? 3 : 2; }
};

NekHeader parse_nek_header(std::string_view bytes, const std::string& where) {
  if (!bytes.starts_with("#std") || bytes.size() < 136)
    fail_data("does not begin with the header '#std'", where, "a field file has 132 bytes of text, then numbers");
  NekHeader h;
  const auto w = words(bytes.substr(4, 128));
  auto number = [&](size_t k, const char* what, int64_t lo, int64_t hi) {
    const auto v = k < w.size() ? parse_int(w[k]) : std::nullopt;
    if (!v || *v < lo || *v > hi)
      fail_data(fmt::format("the header's {} is '{}'", what, k < w.size() ? w[k] : ""), where, fmt::format("{} to {}", lo, hi));
    return *v;
  };
  h.word = int(number(0, "size of numbers", 4, 8));
  if (h.word != 4 && h.word != 8) fail_data(fmt::format("has numbers of {} bytes", h.word), where, "4 or 8");
  for (size_t a = 0; a < 3; ++a) h.n[a] = size_t(number(1 + a, "number of points", 1, 64));
  if (h.n[0] < 2 || h.n[1] < 2)
    fail_data(fmt::format("has elements of {} x {} points", h.n[0], h.n[1]), where, "2 or more along each axis are needed");
  h.elements = size_t(number(4, "number of elements", 0, int64_t(1) << 40));
  const auto time = w.size() > 6 ? parse_double(w[6]) : std::nullopt;
  if (!time) fail_data("the header has no time", where);
  h.time = *time;
  h.files = size_t(number(9, "number of files", 1, 1 << 20));
  if (w.size() > 10) h.content = std::string(w[10]);
  const float test = load<float>(bytes.data() + 132, false), turned = load<float>(bytes.data() + 132, true);
  if (std::fabs(test - 6.54321f) > 1e-3f) {
    if (std::fabs(turned - 6.54321f) > 1e-3f) fail_data("byte 132: the number 6.54321 is missing", where);
    h.big_endian = true;
  }
  h.begin = 136;
  return h;
}

struct NekCase {
  std::string format;  ///< "eddy%01d.f%05d"
  int64_t first = 0, steps = 0;
};

NekCase parse_case(const std::string& path, std::string_view text) {
  NekCase c;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string key = to_lower(std::string(trim(line.substr(0, colon))));
    const std::string_view value = trim(line.substr(colon + 1));
    if (key == "filetemplate") c.format = std::string(value);
    if (key == "firsttimestep") c.first = parse_int(value).value_or(-1);
    if (key == "numtimesteps") c.steps = parse_int(value).value_or(-1);
  }
  if (c.format.empty()) fail_data("has no 'filetemplate:'", path);
  if (c.steps < 1 || c.steps > 10000000 || c.first < 0 || c.first > int64_t(1) << 40)
    fail_data(fmt::format("has {} steps from {}", c.steps, c.first), path, "firsttimestep: and numtimesteps: must be whole numbers");
  return c;
}

// The template with its numbers put in: the last %d is the step, those before it the writer.
std::string file_of(const std::string& path, const std::string& format, size_t writer, int64_t step) {
  std::vector<size_t> places;
  for (size_t i = 0; i + 1 < format.size(); ++i)
    if (format[i] == '%') places.push_back(i);
  std::string name;
  for (size_t i = 0, k = 0; i < format.size(); ++i) {
    if (format[i] != '%') {
      name += format[i];
      continue;
    }
    ++k;
    size_t digits = 0, j = i + 1;
    while (j < format.size() && format[j] >= '0' && format[j] <= '9')
      digits = std::min<size_t>(digits * 10 + size_t(format[j++] - '0'), 20);
    if (j == format.size() || format[j] != 'd')
      fail_data(fmt::format("the file template '{}' is not supported", format), path, "name%01d.f%05d");
    name += fmt::format("{:0{}}", k == places.size() ? step : int64_t(writer), std::max<size_t>(digits, 1));
    i = j;
  }
  return named_file(path, name);
}

struct NekStep {
  NekHeader header;
  std::vector<int64_t> element;  ///< numbers
  std::vector<double> xyz;       ///< 3 per node; empty = this step has none
  std::vector<std::pair<std::string, Field>> fields;
  size_t nodes = 0;
};

// Blocks of one file: per element and component nx*ny*nz numbers.
class NekBlocks {
 public:
  NekBlocks(const MappedFile& file, const NekHeader& h) : file_(file), h_(h), at_(h.begin) {}
  std::vector<int64_t> elements() {
    need(uint64_t(h_.elements) * 4, "the element numbers");
    std::vector<int64_t> r;
    for (size_t e = 0; e < h_.elements; ++e, at_ += 4) r.push_back(load<int32_t>(file_.data() + at_, h_.big_endian));
    return r;
  }
  void skip(size_t components) {
    size_block(components);
    at_ += bytes_;
  }
  /// Adds tuples of `stored` numbers (those beyond `components` are 0) behind `out`.
  template <class T>
  void read(size_t components, size_t stored, std::vector<T>& out) {
    size_block(components);
    const size_t n = h_.nodes(), begin = out.size();
    out.resize(begin + h_.elements * n * stored, T(0));
    for (size_t e = 0; e < h_.elements; ++e)
      for (size_t c = 0; c < components; ++c)
        for (size_t i = 0; i < n; ++i, at_ += size_t(h_.word))
          out[begin + (e * n + i) * stored + c] =
              h_.word == 4 ? T(load<float>(file_.data() + at_, h_.big_endian)) : T(load<double>(file_.data() + at_, h_.big_endian));
  }

 private:
  void size_block(size_t components) {
    uint64_t n = 0;
    if (!multiply(h_.elements, h_.nodes() * components * size_t(h_.word), n)) n = UINT64_MAX;
    need(n, "the values");
    bytes_ = size_t(n);
  }
  void need(uint64_t n, const char* what) const {
    if (file_.size() - at_ < n)
      fail_data(fmt::format("byte {}: the file ends in {}", at_, what), file_.path(), fmt::format("{} bytes more", n));
  }
  const MappedFile& file_;
  const NekHeader& h_;
  size_t at_, bytes_ = 0;
};

struct NekBlock {
  std::string name;
  size_t components, stored;
};

std::vector<NekBlock> blocks_of(const NekHeader& h, const std::string& where) {
  std::vector<NekBlock> r;
  for (size_t i = 0; i < h.content.size(); ++i) switch (h.content[i]) {
      case 'X': r.push_back({"", h.dimension(), 3}); break;
      case 'U': r.push_back({"velocity", h.dimension(), 3}); break;
      case 'P': r.push_back({"pressure", 1, 1}); break;
      case 'T': r.push_back({"temperature", 1, 1}); break;
      case 'S': {
        const auto n = parse_int(std::string_view(h.content).substr(i + 1, 2));
        if (!n || *n < 0 || *n > 99) fail_data(fmt::format("the content code '{}' has scalars without a count", h.content), where);
        for (int64_t k = 1; k <= *n; ++k) r.push_back({fmt::format("s{:02}", k), 1, 1});
        i += 2;
        break;
      }
      default: fail_data(fmt::format("the content code '{}' has the unknown letter '{}'", h.content, h.content[i]), where, "X U P T S");
    }
  return r;
}

// One file of a step, behind those read before.
void read_file(const std::string& path, const ReadOptions& options, bool positions_only, NekStep& step) {
  const MappedFile file(path);
  const NekHeader h = parse_nek_header(file.text(), path);
  if (step.nodes > 0 && (h.n != step.header.n || h.content != step.header.content || h.word != step.header.word))
    fail_data("differs from the other files of its step", path);
  step.header = h;
  NekBlocks in(file, h);
  const auto ids = in.elements();
  step.element.insert(step.element.end(), ids.begin(), ids.end());
  step.nodes += h.elements * h.nodes();
  for (const NekBlock& b : blocks_of(h, path)) {
    const bool wanted = options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), b.name) != options.fields.end();
    if (b.name.empty()) {
      in.read(b.components, b.stored, step.xyz);
    } else if (!wanted || positions_only) {
      in.skip(b.components);
    } else {
      auto it = std::find_if(step.fields.begin(), step.fields.end(), [&](const auto& f) { return f.first == b.name; });
      if (it == step.fields.end()) {
        step.fields.push_back({b.name, Field{b.name, Association::point, {}, "", b.stored == 3 ? Role::vectors : Role::none}});
        it = step.fields.end() - 1;
      }
      // Files of one step are joined: few and small against the whole.
      std::vector<double> values;
      const Array& before = it->second.array;
      for (size_t i = 0; i < before.count(); ++i)
        for (size_t c = 0; c < b.stored; ++c) values.push_back(before.get(i, int(c)));
      in.read(b.components, b.stored, values);
      it->second.array = h.word == 8 ? Array::from_vector(std::move(values), int(b.stored))
                                     : Array::from_vector(std::vector<float>(values.begin(), values.end()), int(b.stored));
    }
  }
}

NekStep read_step(const std::string& path, const NekCase& c, int64_t number, const ReadOptions& options, bool positions_only) {
  NekStep step;
  read_file(file_of(path, c.format, 0, number), options, positions_only, step);
  const size_t files = step.header.files;
  for (size_t w = 1; w < files; ++w) read_file(file_of(path, c.format, w, number), options, positions_only, step);
  return step;
}

DatasetPtr dataset_of(NekStep& step, const std::string& where) {
  if (step.xyz.size() != 3 * step.nodes) fail_data("has values and positions of different elements", where);
  for (double x : step.xyz)
    if (!std::isfinite(x)) fail_data("a position is not finite", where);
  const auto& n = step.header.n;
  const size_t nodes = step.header.nodes(), layers = std::max<size_t>(n[2] - 1, 1);
  const size_t corners = n[2] > 1 ? 8 : 4;
  std::vector<int32_t> ids, element;
  if (step.nodes > size_t(INT32_MAX)) fail_data("has more than 2^31 points", where);
  for (size_t e = 0; e < step.element.size(); ++e)
    for (size_t k = 0; k < layers; ++k)
      for (size_t j = 0; j + 1 < n[1]; ++j)
        for (size_t i = 0; i + 1 < n[0]; ++i) {
          for (size_t c = 0; c < corners; ++c) {
            const size_t dx = c % 4 == 1 || c % 4 == 2, dy = c % 4 > 1, dz = c > 3;
            ids.push_back(int32_t(e * nodes + i + dx + n[0] * (j + dy + n[1] * (k + dz))));
          }
          element.push_back(int32_t(step.element[e]));
        }
  UnstructuredMesh mesh;
  mesh.single_type = n[2] > 1 ? CellType::hexahedron : CellType::quad;
  if (!ids.empty()) mesh.cells.fixed = int(corners);
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.points.xyz = step.header.word == 8 ? Array::from_vector(std::move(step.xyz), 3)
                                          : Array::from_vector(std::vector<float>(step.xyz.begin(), step.xyz.end()), 3);
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  parts.time = step.header.time;
  for (auto& [name, f] : step.fields) parts.fields.add(std::move(f));
  parts.fields.add(cell_ids("element", std::move(element)));
  return make_dataset(std::move(parts));
}

bool is_field_file(std::string_view text) { return text.starts_with("#std"); }

}  // namespace

bool sniff_nek5000(std::span<const std::byte> head) {
  const std::string_view s(reinterpret_cast<const char*>(head.data()), head.size());
  if (is_field_file(s)) return s.size() >= 136 && words(s.substr(4, 128)).size() >= 10;
  return s.find('\0') == std::string_view::npos && s.find("filetemplate:") != std::string_view::npos &&
         s.find("numtimesteps:") != std::string_view::npos;
}

std::vector<double> times_of_nek5000(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  if (is_field_file(file.text())) return {};
  const NekCase c = parse_case(path, file.text());
  std::vector<double> times;
  for (int64_t s = 0; s < c.steps; ++s) {
    const std::string step = file_of(path, c.format, 0, c.first + s);
    const MappedFile one(step);
    times.push_back(parse_nek_header(one.text(), step).time);
  }
  return times;
}

Data read_nek5000(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  if (is_field_file(file.text())) {
    NekStep step;
    read_file(path, options, false, step);
    if (step.xyz.empty()) fail_data("has no positions", path, "open the .nek5000 file, since another step has them");
    return dataset_of(step, path);
  }
  const NekCase c = parse_case(path, file.text());
  size_t chosen = 0;
  if (options.step >= 0 || options.time) chosen = chosen_step(times_of_nek5000(path, options, context), options, path);
  NekStep step = read_step(path, c, c.first + int64_t(chosen), options, false);
  if (step.xyz.empty()) step.xyz = read_step(path, c, c.first, options, true).xyz;
  return dataset_of(step, path);
}

}  // namespace sg
