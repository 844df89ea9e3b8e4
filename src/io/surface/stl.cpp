// SPDX-License-Identifier: Apache-2.0
// STL, binary and ASCII. Points are merged exactly; facet normals and attribute bytes are not kept (normals follow from the
// points). A file is binary when its length matches its triangle count exactly, even when it begins with "solid".
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/surface/surface_parts.h"
#include "io/text/text_scan.h"
#include "io/write_losses.h"

namespace sg {

namespace {

constexpr size_t header_bytes = 84, triangle_bytes = 50;

DatasetPtr surface_of(const std::byte* corners, size_t triangles, size_t stride, const std::string& path,
                      std::vector<std::pair<std::string, std::string>> notes, Context& context) {
  MergedPoints merged = merge_corners(corners, 3 * triangles, stride, path, context);
  SurfaceMesh mesh;
  mesh.points.xyz = std::move(merged.xyz);
  mesh.polygons.connectivity = std::move(merged.ids);
  mesh.polygons.fixed = 3;
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  parts.notes = std::move(notes);
  return make_dataset(std::move(parts));
}

// "solid" followed by text that has a facet (or ends at once) within the first lines.
bool looks_ascii(std::string_view text) {
  text = text.substr(0, 4096);
  const std::string head = to_lower(text);
  size_t at = 0;
  while (at < head.size() && is_space(head[at])) ++at;
  if (head.compare(at, 5, "solid") != 0) return false;
  return head.find("facet") != std::string::npos || head.find("endsolid") != std::string::npos;
}

// What one chunk of an ASCII file holds: corners, and how many of them came before each end of a loop, modulo 3.
struct AsciiChunk {
  std::vector<float> xyz;
  int loop_phase = -1;
};

bool word_is(const char* p, const char* e, std::string_view lower) {
  if (size_t(e - p) != lower.size()) return false;
  for (size_t i = 0; i < lower.size(); ++i)
    if ((p[i] | 0x20) != lower[i]) return false;
  return true;
}

void parse_chunk(std::string_view text, size_t begin, size_t end_at, const std::string& path, AsciiChunk& out) {
  const char *p = text.data() + begin, *end = text.data() + end_at;
  auto fail = [&](const char* at, const std::string& what) {
    fail_data(fmt::format("line {}: {}", line_number(text, size_t(at - text.data())), what), path);
  };
  out.xyz.reserve((end_at - begin) / 22);
  while (p < end) {
    const char* line = line_end(p, end);
    const char* word = skip_blanks(p, line);
    const char* word_end = skip_word(word, line);
    if (word_is(word, word_end, "vertex")) {
      const char* q = word_end;
      for (int k = 0; k < 3; ++k) {
        q = skip_blanks(q, line);
        float v = 0;
        if (!scan_number(q, line, v) || (q < line && !is_blank(*q))) fail(word, "'vertex' does not have three numbers");
        out.xyz.push_back(v);
      }
    } else if (word_is(word, word_end, "endloop")) {
      const int phase = int(out.xyz.size() / 3 % 3);
      if (out.loop_phase >= 0 && out.loop_phase != phase) fail(word, "a facet needs three vertices");
      out.loop_phase = phase;
    } else if (word_end > word) {
      // The name in "solid NAME" may be anything; other lines begin with one of these words.
      static constexpr std::string_view words_of_stl[] = {"facet", "outer", "endfacet", "solid", "endsolid", "color"};
      bool known = false;
      for (size_t i = 0; i < std::size(words_of_stl) && !known; ++i) known = word_is(word, word_end, words_of_stl[i]);
      if (!known)
        fail(word, fmt::format("'{}' is not an STL keyword", std::string_view(word, std::min<size_t>(40, size_t(word_end - word)))));
    }
    p = line < end ? line + 1 : end;
  }
}

DatasetPtr read_ascii(const MappedFile& file, Context& context) {
  const std::string_view text = file.text();
  const auto borders = text_chunks(text, 1 << 18);
  std::vector<AsciiChunk> chunks(borders.size() - 1);
  parallel_for(
      chunks.size(), 1, [&](size_t c, size_t) { parse_chunk(text, borders[c], borders[c + 1], file.path(), chunks[c]); }, &context);
  std::vector<size_t> first(chunks.size());
  for (size_t c = 0; c < chunks.size(); ++c) first[c] = chunks[c].xyz.size();
  const size_t numbers = exclusive_scan(first);
  for (size_t c = 0; c < chunks.size(); ++c)
    if (chunks[c].loop_phase >= 0 && (first[c] / 3 + size_t(chunks[c].loop_phase)) % 3 != 0)
      fail_data(fmt::format("a facet near line {} does not have three vertices", line_number(text, borders[c])), file.path());
  if (numbers % 9) fail_data(fmt::format("{} vertices do not make whole triangles; the file may be truncated", numbers / 3), file.path());
  const size_t tail = text.size() > 4096 ? text.size() - 4096 : 0;
  if (to_lower(text.substr(tail)).find("endsolid") == std::string::npos)
    fail_data("the last line is not 'endsolid'; the file is truncated", file.path());
  std::byte* xyz = nullptr;
  const Buffer memory = Buffer::allocate(numbers * 4, &xyz);
  parallel_for(chunks.size(), 1, [&](size_t c, size_t) {
    if (!chunks[c].xyz.empty()) std::memcpy(xyz + first[c] * 4, chunks[c].xyz.data(), chunks[c].xyz.size() * 4);
  });
  std::vector<std::pair<std::string, std::string>> notes;
  const std::string_view name = trim(text.substr(text.find_first_not_of(" \t\r\n"), text.find('\n') - text.find_first_not_of(" \t\r\n")));
  if (name.size() > 6) notes.emplace_back("title", std::string(trim(name.substr(5))));
  return surface_of(xyz, numbers / 9, 36, file.path(), std::move(notes), context);
}

}  // namespace

Data read_stl(const std::string& path, const ReadOptions&, Context& context) {
  const MappedFile file(path);
  const size_t size = file.size();
  const uint64_t count = size >= header_bytes ? load<uint32_t>(file.data() + 80) : 0;
  const bool exact = size >= header_bytes && size == header_bytes + triangle_bytes * count;
  if (!exact && looks_ascii(file.text())) return read_ascii(file, context);
  if (size < header_bytes)
    fail_data(fmt::format("too short for STL: {} bytes", size), path,
              "a binary file has a header of 84 bytes, an ASCII one begins with 'solid'");
  if (size < header_bytes + triangle_bytes * count)
    fail_data(fmt::format("{} triangles need {} bytes, but there are {}", count, header_bytes + triangle_bytes * count, size), path,
              "the file is truncated or not STL");
  if (!exact)
    context.warn(fmt::format("{}: {} bytes after the {} triangles are ignored", path, size - header_bytes - triangle_bytes * count, count));
  std::vector<std::pair<std::string, std::string>> notes;
  const std::string_view title = trim(file.text().substr(0, std::min<size_t>(80, file.text().find('\0'))));
  if (!title.empty() && std::all_of(title.begin(), title.end(), [](char c) { return c >= ' ' && c < 127; }))
    notes.emplace_back("title", std::string(title));
  return surface_of(file.data() + header_bytes + 12, count, triangle_bytes, path, std::move(notes), context);
}

void write_stl(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const DatasetPtr d = single_dataset(data, "writing STL");
  const SurfaceMesh& mesh = surface_to_write(*d, "STL", path);
  const std::vector<int64_t> ids = surface_triangles(mesh);
  const size_t n = ids.size() / 3;
  if (n > UINT32_MAX) fail_usage(fmt::format("{} triangles are more than an STL file can hold", n), path);
  if (!mesh.lines.connectivity.empty() || !mesh.vertices.connectivity.empty())
    context.warn(path + ": lines and vertices are not written; STL holds triangles only");
  WriteLosses losses(path, "STL");
  for (const Field& f : d->fields()) losses.leaves_out(f);
  if (!survives_f32(mesh.points)) losses.rounds("positions", ElementType::f64, ElementType::f32);
  losses.tell(context);
  AtomicFile file(path);
  auto triangle = [&](size_t t, float v[12]) {
    Vec3 p[3];
    for (size_t k = 0; k < 3; ++k) p[k] = mesh.points.at(size_t(ids[3 * t + k]));
    const Vec3 normal = normalize(cross(p[1] - p[0], p[2] - p[0]));
    for (int a = 0; a < 3; ++a) {
      v[a] = float(normal[a]);
      for (int k = 0; k < 3; ++k) v[3 + 3 * k + a] = float(p[k][a]);
    }
  };
  if (!options.binary) {
    std::string text = "solid sightglass\n";
    for (size_t t = 0; t < n; ++t) {
      float v[12];
      triangle(t, v);
      text += fmt::format("facet normal {} {} {}\n outer loop\n", v[0], v[1], v[2]);
      for (int k = 1; k < 4; ++k) text += fmt::format("  vertex {} {} {}\n", v[3 * k], v[3 * k + 1], v[3 * k + 2]);
      text += " endloop\nendfacet\n";
      if (text.size() > (1 << 20)) file.write(text), text.clear();
    }
    file.write(text + "endsolid sightglass\n");
    return file.commit();
  }
  std::string head = "binary STL written by sightglass";
  head.resize(80, ' ');
  file.write(head);
  const auto count = uint32_t(n);
  file.write(&count, 4);
  constexpr size_t block = 1 << 16;
  std::vector<std::byte> bytes;
  for (size_t begin = 0; begin < n; begin += block) {
    const size_t end = std::min(n, begin + block);
    bytes.assign((end - begin) * triangle_bytes, std::byte(0));
    parallel_for(
        end - begin, 4096,
        [&](size_t a, size_t b) {
          for (size_t t = a; t < b; ++t) {
            float v[12];
            triangle(begin + t, v);
            std::memcpy(bytes.data() + t * triangle_bytes, v, 48);
          }
        },
        &context);
    file.write(bytes.data(), bytes.size());
  }
  file.commit();
}

}  // namespace sg
