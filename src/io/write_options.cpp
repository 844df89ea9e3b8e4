// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "io/options.h"

namespace sg {

namespace {

ParamDecl& describe_compression(Schema& s, WriteOptions& p, std::vector<std::string> choices) {
  return s("compression", p.compression, "Compression of arrays.").choices(std::move(choices));
}

}  // namespace

void describe_text_or_binary(Schema& s, WriteOptions& p) { s("binary", p.binary, "Write numbers in binary rather than as text."); }

void describe_nrrd(Schema& s, WriteOptions& p) { describe_compression(s, p, {"none", "gzip"}); }

void describe_zlib(Schema& s, WriteOptions& p) { describe_compression(s, p, {"none", "zlib"}); }

void describe_vtk_xml(Schema& s, WriteOptions& p) {
  s("encoding", p.encoding, "How array data is stored in the file.");
  describe_compression(s, p, {"none", "zlib", "lz4", "lzma"});
}

void describe_vtk_pieces(Schema& s, WriteOptions& p) {
  describe_vtk_xml(s, p);
  s("pieces", p.pieces, "Number of files into which each mesh is split.").range(1, 100000);
}

void describe_zarr(Schema& s, WriteOptions& p) {
  describe_compression(s, p, {"lz4", "zstd", "zlib"});
  s("chunk", p.chunk, "Samples along each axis of a chunk; an even number.").range(8, 512);
}

WriteOptions write_options(const Format& format, const std::vector<std::string>& words) {
  WriteOptions options;
  Schema schema;
  if (format.describe_write) format.describe_write(schema, options);
  if (schema.decls().empty() && !words.empty())
    fail_usage(fmt::format("unknown parameter '{}'", words[0].substr(0, words[0].find('='))), fmt::format("{} writer", format.name),
               "this writer has no parameters");
  set_params(schema, words, fmt::format("{} writer", format.name));
  return options;
}

}  // namespace sg
