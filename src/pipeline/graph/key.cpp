// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/key.h"

#include <fmt/core.h>
#include <sys/stat.h>
#include <xxhash.h>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/file_series.h"

namespace sg {

std::string key_text(const Key& key) { return fmt::format("{:016x}{:016x}", key.hi, key.lo); }

KeyBuilder& KeyBuilder::add(uint64_t number) {
  bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);  // little-endian everywhere we run
  return *this;
}

KeyBuilder& KeyBuilder::add(std::string_view part) {
  add(uint64_t(part.size()));
  bytes_ += part;
  return *this;
}

KeyBuilder& KeyBuilder::add(const Key& key) { return add(key.hi).add(key.lo); }

Key KeyBuilder::key() const { return hash_bytes(bytes_.data(), bytes_.size()); }

Key hash_bytes(const void* data, size_t size) {
  const XXH128_hash_t h = XXH3_128bits(data, size);
  return {h.high64, h.low64};
}

FileState file_state(const std::string& path) {
  FileState s;
  s.path = path;
  struct stat st {};
  if (::stat(path.c_str(), &st) != 0) return s;
  s.exists = true;
  s.size = uint64_t(st.st_size);
  s.modified = int64_t(st.st_mtim.tv_sec) * 1'000'000'000 + st.st_mtim.tv_nsec;
  return s;
}

namespace {

constexpr std::string_view kinds_with_parts = "mhd nhdr hdr pvti pvtr pvts pvtu pvtp vtm vtmb pvd xdmf xmf visit series";
constexpr size_t searched_bytes = size_t(4) << 20;

bool names_parts(const std::string& path) {
  const std::string ext = extension_of(path);
  for (std::string_view kind : words(kinds_with_parts))
    if (ext == kind) return true;
  return false;
}

bool separates(char c) {
  return static_cast<unsigned char>(c) <= ' ' || c == '"' || c == '\'' || c == '=' || c == '<' || c == '>' || c == ',' || c == ';';
}

}  // namespace

// Without knowing the formats: every word with a dot that names a file next to the header.
std::vector<FileState> file_and_parts(const std::string& path) {
  std::vector<FileState> files{file_state(path)};
  if (!files[0].exists || files[0].size == 0 || !names_parts(path)) return files;
  const MappedFile file(path);
  const std::string_view text = file.text().substr(0, searched_bytes);
  size_t begin = 0;
  for (size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && !separates(text[i])) continue;
    const std::string_view word = text.substr(begin, i - begin);
    begin = i + 1;
    if (word.size() < 3 || word.size() > 1024 || word.find('.') == word.npos || parse_double(word) || word.find('\0') != word.npos)
      continue;
    FileState part = file_state(path_beside(path, word));
    if (part.exists && is_plain_file(part.path)) files.push_back(std::move(part));
  }
  return files;
}

namespace {

// Of a series only its files: looking into the headers of a thousand of them would take longer than reading one.
std::vector<FileState> files_behind(const std::string& path) {
  if (!names_series(path)) return file_and_parts(path);
  std::vector<FileState> files;
  try {
    for (const std::string& f : series_files(path)) files.push_back(file_state(f));
  } catch (const Error&) {  // no such files: a missing file has a key as well
  }
  return files;
}

}  // namespace

Key file_key(const std::string& path, bool strict) {
  KeyBuilder key;
  key.add(path);
  for (const FileState& f : files_behind(path)) {
    key.add(f.path).add(uint64_t(f.exists)).add(f.size).add(uint64_t(f.modified));
    if (!strict || !f.exists) continue;
    const MappedFile file(f.path);
    key.add(hash_bytes(file.data(), file.size()));
  }
  return key.key();
}

}  // namespace sg
