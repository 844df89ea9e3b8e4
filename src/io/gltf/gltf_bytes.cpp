// SPDX-License-Identifier: Apache-2.0
#include "io/gltf/gltf_bytes.h"

#include <fmt/core.h>

#include "base/bytes.h"
#include "base/file/file_fence.h"
#include "io/formats.h"

namespace sg {

namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

int sextet(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

int hex(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

std::string without_percents(std::string_view s) {
  std::string r;
  for (size_t i = 0; i < s.size(); ++i) {
    if (s[i] == '%' && i + 2 < s.size() && hex(s[i + 1]) >= 0 && hex(s[i + 2]) >= 0) {
      r += char(hex(s[i + 1]) * 16 + hex(s[i + 2]));
      i += 2;
    } else {
      r += s[i];
    }
  }
  return r;
}

}  // namespace

GltfChunks gltf_chunks(const MappedFile& file) {
  const std::string_view text = file.text();
  if (!text.starts_with("glTF")) return {text, {}};
  if (text.size() < 20) fail_data(fmt::format("the file ends at byte {}, in the header", text.size()), file.path());
  const auto version = load<uint32_t>(text.data() + 4), length = load<uint32_t>(text.data() + 8);
  if (version != 2) fail_data(fmt::format("is binary glTF of version {}", version), file.path(), "version 2 is supported");
  if (length > text.size())
    fail_data(fmt::format("the file has {} bytes, but its header says {}", text.size(), length), file.path(), "it is truncated");
  GltfChunks r;
  for (size_t p = 12, n = 0; p + 8 <= length; ++n) {
    const auto bytes = load<uint32_t>(text.data() + p), type = load<uint32_t>(text.data() + p + 4);
    if (bytes > length - p - 8) fail_data(fmt::format("byte {}: a chunk of {} bytes goes beyond the file", p, bytes), file.path());
    const std::string_view chunk = text.substr(p + 8, bytes);
    if (n == 0 && type != 0x4e4f534au) fail_data("byte 16: the first chunk is not JSON", file.path());
    if (n == 0) r.json = chunk;
    else if (type == 0x004e4942u && !r.binary.data()) r.binary = chunk;
    p += 8 + bytes;
  }
  return r;
}

GltfBuffer gltf_uri(const std::string& uri, const std::string& path, const std::string& where) {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(',');
    if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64"))
      fail_data(fmt::format("{}: its data: URI is not base64", where), path);
    auto bytes = std::make_shared<std::string>();
    uint32_t bits = 0;
    int have = 0;
    for (char c : without_percents(std::string_view(uri).substr(comma + 1))) {
      if (c == '=' || c == '\n' || c == '\r') continue;
      const int v = sextet(c);
      if (v < 0) fail_data(fmt::format("{}: its data: URI holds a character that is not base64", where), path);
      bits = bits << 6 | uint32_t(v);
      if (have += 6; have >= 8) *bytes += char(bits >> (have -= 8) & 255);
    }
    const std::string_view view = *bytes;
    return {bytes, view};
  }
  const std::string name = without_percents(uri);
  if (name.empty() || name.find(':') != std::string::npos)
    fail_data(fmt::format("{}: '{}' is not supported", where, uri), path, "buffers must be in files beside it, or in the file itself");
  const MappedFile file(named_file(path, name));
  return {file.owner(), file.text()};
}

std::string to_base64(std::string_view bytes) {
  std::string r;
  r.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t v = 0;
    for (size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0);
    for (int k = 0; k < 4; ++k) r += i + size_t(k) > bytes.size() ? '=' : alphabet[v >> (18 - 6 * k) & 63];
  }
  return r;
}

}  // namespace sg
